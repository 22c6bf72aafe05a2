#include "texture/normal_bake.h"

#include "base/angle.h"
#include "base/lane_vector.h"
#include "texture/chart_map.h"
#include "texture/charted_tile.h"
#include "texture/corner_frames.h"
#include "texture/distinct_triangles.h"
#include "texture/finer_normals.h"
#include "texture/finer_points.h"
#include "texture/texel_samples.h"
#include "texture/vertex_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace meshhier::texture {
namespace {

double degrees_between(FourFloats a, FourFloats b) {
  constexpr double kDegrees = 57.29577951308232;
  const Vec3d to = to_double(vector_of(a)), from = to_double(vector_of(b));
  return kDegrees * angle_of(dot(to, from), length(cross(to, from)));
}

// ---- the map -------------------------------------------------------------------------------

/// Along the normal.
constexpr std::array<std::uint8_t, 3> kFlat{128, 128, 255};
/// glTF: 0 to 255 are -1 to 1.
float part_of(std::uint8_t value) {
  return static_cast<float>(value) / 127.5f - 1;
}

/// Makes the map of one tile, whose triangles are distinct.
class MapMaker {
 public:
  MapMaker(const NormalSurface& tile, const TexelSamples& samples, const CornerFrames& frames,
           std::span<const NormalSurface> surfaces, const FinerSurfaces& finer,
           std::span<const FinerPoint> points)
      : tile_(tile),
        samples_(samples),
        layout_(samples.layout()),
        frames_(frames),
        normals_(surfaces, finer),
        finer_(finer),
        points_(points) {}

  BakedNormalMap operator()(double least_degrees) {
    BakedNormalMap baked;
    baked.corners = samples_.texcoords();
    for (CornerTexcoords& corners : baked.corners) {
      for (Vec2f& corner : corners)
        corner = {on_grid(corner.u), on_grid(corner.v)};
    }
    baked.tangents = frames_.tangents();
    baked.texel = static_cast<float>(1 / layout_.density);
    baked.vertices = count_vertices();
    find_directions();
    baked.texels = {layout_.width, layout_.height, directions_};
    find_amid();
    baked.own_degrees = degrees_off([](const Amid& at) { return at.frame.normal; });
    if (baked.own_degrees < least_degrees) {
      // The numbers of a map, 8 bits each, would add so much.
      constexpr double kOfNumbers = 0.3;
      const double found = degrees_between_texels(baked.texels);
      baked.map_degrees = std::sqrt(found * found + kOfNumbers * kOfNumbers);
      return baked;
    }
    baked.map = drawn();
    baked.map_degrees = degrees_off([&](const Amid& at) { return shown_by(baked.map, at); });
    return baked;
  }

 private:
  static float on_grid(float part) {
    constexpr float kMost = 65535;
    return std::floor(part * kMost + 0.5f) / kMost;
  }

  std::uint32_t count_vertices() const {
    std::vector<std::size_t> last_chart(tile_.positions.size(), ~std::size_t{0});
    std::uint32_t count = 0;
    for (std::size_t c = 0; c < layout_.planes.size(); ++c) {
      for (const std::uint32_t t : samples_.triangles_of(c)) {
        for (const TileVertex corner : tile_.triangles[t]) {
          count += last_chart[raw(corner)] != c ? 1 : 0;
          last_chart[raw(corner)] = c;
        }
      }
    }
    return count;
  }

  /// Finds what is passed on. Points share places: the first one counts.
  void find_directions() {
    directions_.resize(points_.size());
    for (const ChartPlane& plane : layout_.planes) {
      for_each_texel(TexelSamples::range_of(plane), [&](std::uint32_t x, std::uint32_t y) {
        const TexelSample& sample = samples_.at(x, y);
        const std::size_t i = samples_.index(x, y);
        if (sample.triangle != kNoFace && !shows(directions_[i]))
          directions_[i] = normal_texel(direction(plane, sample, points_[i]));
      });
    }
  }

  images::Image drawn() const {
    images::Image map(layout_.width, layout_.height, 3);
    for (std::size_t i = 0; i < map.texels.size(); i += 3)
      std::ranges::copy(kFlat, map.texels.begin() + static_cast<std::ptrdiff_t>(i));
    ChartMap charts(samples_, frames_, directions_);
    for (const ChartPlane& plane : layout_.planes)
      charts.draw(plane, map);
    return map;
  }

  /// The finer surfaces' direction at one of their points; the tile's own where they have none.
  FourFloats direction(const ChartPlane& plane, const TexelSample& sample, const FinerPoint& at) {
    const FourFloats there = normals_.direction(at);
    return dot_of(there, there) > 0 ? there : lanes_of(samples_.facing(plane, sample));
  }

  VertexFrame frame_at(const TexelSample& sample) const {
    const std::uint32_t t = sample.triangle;
    return interpolated(frames_.at(t, 0), frames_.at(t, 1), frames_.at(t, 2), weights_of(sample));
  }

  /// The middle of four texels, all of them within a chart.
  struct Amid {
    std::uint32_t x, y;  ///< the first one
    FourFloats original;
    VertexFrame frame;
  };

  /// Finds where the map is compared with the original: one in so many texels along each side.
  void find_amid() {
    constexpr std::uint32_t kStep = 8;
    for (const ChartPlane& plane : layout_.planes) {
      for (std::uint32_t y = plane.top + kBakeGutter; y + 1 < plane.bottom; y += kStep) {
        for (std::uint32_t x = plane.left + kBakeGutter; x + 1 < plane.right; x += kStep)
          add_amid(plane, x, y);
      }
    }
  }

  void add_amid(const ChartPlane& plane, std::uint32_t x, std::uint32_t y) {
    const auto found = finer_.amid_texels(samples_, TexelSamples::range_of(plane), points_, x, y);
    if (!found)
      return;
    const TexelSample& sample = samples_.at(x, y);
    amid_.push_back({x, y, direction(plane, sample, found->finer),
                     frame_at(samples_.beside(sample.triangle, found->point))});
  }

  /// Returns the mean angle between the original and what `shown` says that is seen there.
  template <class Shown>
  double degrees_off(const Shown& shown) const {
    double sum = 0;
    for (const Amid& at : amid_)
      sum += degrees_between(shown(at), at.original);
    return amid_.empty() ? 0 : sum / static_cast<double>(amid_.size());
  }

  double degrees_between_texels(const NormalTexels& texels) const {
    return degrees_off([&](const Amid& at) {
      return texels.direction_at({at.x + 1.0, at.y + 1.0});
    });
  }

  static FourFloats shown_by(const images::Image& map, const Amid& at) {
    FourFloats sum{};
    for (const auto& [i, j] : four_texels(at.x, at.y)) {
      const std::uint8_t* texel = map.at(i, j);
      sum += FourFloats{part_of(texel[0]), part_of(texel[1]), part_of(texel[2]), 0};
    }
    return at.frame.mixed(sum);
  }

  const NormalSurface& tile_;
  const TexelSamples& samples_;
  const ChartLayout& layout_;
  const CornerFrames& frames_;
  FinerNormals normals_;
  const FinerSurfaces& finer_;
  const std::span<const FinerPoint> points_;
  std::vector<NormalTexel> directions_;  ///< of texels
  std::vector<Amid> amid_;
};

/// Returns the entries of those triangles that are there once.
std::vector<CornerNormals> normals_of(const DistinctTriangles& distinct,
                                      std::span<const CornerNormals> all) {
  std::vector<CornerNormals> normals;
  for (const std::uint32_t t : distinct.firsts())
    normals.push_back(all[t]);
  return normals;
}

CornerFrames frames_of(const NormalSurface& tile, const TexelSamples& samples) {
  CornerFrames frames(tile.positions.size(), tile.triangles, tile.normals);
  for (std::size_t c = 0; c < samples.layout().planes.size(); ++c)
    frames.add_chart(samples.layout().planes[c], samples.triangles_of(c));
  return frames;
}

BakedNormalMap expanded(BakedNormalMap baked, const DistinctTriangles& distinct) {
  baked.corners = distinct.expanded(baked.corners);
  baked.tangents = distinct.expanded(baked.tangents);
  return baked;
}

}  // namespace

struct NormalBaker::Work {
  Work(const NormalSurface& tile, std::span<const NormalSurface> finer, std::uint32_t longest)
      : distinct(tile.triangles),
        side(longest),
        surfaces(finer),
        normals(normals_of(distinct, tile.normals)) {
    surface = {tile.positions, distinct.triangles(), normals, {}, nullptr};
    bare = {tile.positions, distinct.triangles(), {}, nullptr};
  }

  /// Lays the charts out with other texels.
  void lay_out(const BakeSize& size) {
    if (samples) {
      samples->lay_out_again(size);
      return;
    }
    samples.emplace(bare, size);
    shapes.emplace(shapes_of(surfaces), *samples);
    frames.emplace(frames_of(surface, *samples));
  }

  const DistinctTriangles distinct;
  const std::uint32_t side;
  const std::span<const NormalSurface> surfaces;
  const std::vector<CornerNormals> normals;
  NormalSurface surface;
  TexturedSurface bare;  ///< without its normals
  std::optional<TexelSamples> samples;
  std::optional<FinerSurfaces> shapes;
  std::optional<CornerFrames> frames;
};

NormalBaker::NormalBaker(const NormalSurface& tile, std::span<const NormalSurface> finer,
                         std::uint32_t side)
    : work_(std::make_unique<Work>(tile, finer, side)) {}
NormalBaker::~NormalBaker() = default;

BakedNormalMap NormalBaker::bake(float least_texel, double least_degrees) {
  Work& work = *work_;
  work.lay_out({work.side, least_texel});
  const std::vector<FinerPoint> points = work.shapes->points(*work.samples);
  MapMaker maker(work.surface, *work.samples, *work.frames, work.surfaces, *work.shapes, points);
  return expanded(maker(least_degrees), work.distinct);
}

BakedNormalMap bake_normal_map(const ChartedTile& tile, std::span<const CornerNormals> normals,
                               std::span<const NormalSurface> finer) {
  const std::vector<CornerNormals> distinct = normals_of(tile.distinct, normals);
  const NormalSurface surface{
      tile.surface.positions, tile.surface.triangles, distinct, {}, nullptr};
  const CornerFrames frames = frames_of(surface, tile.samples);
  MapMaker maker(surface, tile.samples, frames, finer, tile.finer, tile.points);
  return expanded(maker(0), tile.distinct);
}

}  // namespace meshhier::texture
