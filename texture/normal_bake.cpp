#include "texture/normal_bake.h"

#include "base/angle.h"
#include "base/bounds.h"
#include "base/four_floats.h"
#include "texture/distinct_triangles.h"
#include "texture/finer_normals.h"
#include "texture/nearest_triangle.h"
#include "texture/sample_blocks.h"
#include "texture/texel_samples.h"
#include "texture/vertex_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

namespace meshhier::texture {
namespace {

double degrees_between(const Vec3d& a, const Vec3d& b) {
  constexpr double kDegrees = 57.29577951308232;
  return kDegrees * angle_of(dot(a, b), length(cross(a, b)));
}

// ---- the map -------------------------------------------------------------------------------

/// glTF: 0 to 255 are -1 to 1.
std::uint8_t value_of(double part) {
  return static_cast<std::uint8_t>(
      std::clamp(std::floor((part * 0.5 + 0.5) * 255 + 0.5), 0., 255.));
}
/// Along the normal.
constexpr std::array<std::uint8_t, 3> kFlat{128, 128, 255};
double part_of(std::uint8_t value) {
  return value / 127.5 - 1;
}

/// Makes the map of one tile, whose triangles are distinct.
class MapMaker {
 public:
  MapMaker(const NormalSurface& tile, FinerNormals& finer, const TexelSamples& samples)
      : tile_(tile), samples_(samples), finer_(finer), texel_(1 / samples_.layout().density) {}

  BakedNormalMap operator()() {
    BakedNormalMap baked;
    baked.corners = samples_.texcoords();
    for (CornerTexcoords& corners : baked.corners) {
      for (Vec2f& corner : corners)
        corner = {on_grid(corner.u), on_grid(corner.v)};
    }
    baked.tangents = find_frames();
    baked.texels = find_directions();
    baked.map = drawn(baked.texels);
    baked.texel = static_cast<float>(texel_);
    baked.vertices = count_vertices();
    compare(baked);
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
    for (std::size_t c = 0; c < samples_.layout().planes.size(); ++c) {
      for (const std::uint32_t t : samples_.triangles_of(c)) {
        for (const TileVertex corner : tile_.triangles[t]) {
          count += last_chart[raw(corner)] != c ? 1 : 0;
          last_chart[raw(corner)] = c;
        }
      }
    }
    return count;
  }

  std::vector<CornerTangents> find_frames() {
    std::vector<CornerTangents> tangents(tile_.triangles.size());
    frames_.resize(tile_.triangles.size());
    for (std::size_t c = 0; c < samples_.layout().planes.size(); ++c) {
      for (const std::uint32_t t : samples_.triangles_of(c)) {
        for (std::size_t k = 0; k < 3; ++k) {
          tangents[t][k] = tangent_of(samples_.layout().planes[c], tile_.normals[t][k]);
          frames_[t][k] = frame_of(tile_.normals[t][k], tangents[t][k]);
        }
      }
    }
    return tangents;
  }

  NormalTexels find_directions() {
    const ChartLayout& layout = samples_.layout();
    std::vector<NormalTexel> texels(samples_count());
    for (const ChartPlane& plane : layout.planes) {
      for_each_sample(samples_, plane, finer_.nearest(),
                      [&](std::uint32_t x, std::uint32_t y, const TexelSample& sample) {
                        NormalTexel& texel = texels[index(x, y)];
                        if ((texel[0] | texel[1] | texel[2]) == 0)
                          texel = normal_texel(direction(plane, sample, sample.point));
                      });
    }
    return {layout.width, layout.height, texels};
  }

  Vec3d direction(const ChartPlane& plane, const TexelSample& sample, const Vec3d& point) {
    return finer_.direction(point, samples_.facing(plane, sample), kFacingReach * texel_);
  }

  /// The triangle's nearest point to one in its plane.
  CornerWeights weights_at(std::uint32_t t, const Vec3d& point) const {
    const auto corner = [&](std::size_t k) {
      return to_double(tile_.positions[raw(tile_.triangles[t][k])]);
    };
    const Vec3d a = corner(0), to_b = corner(1) - a, to_c = corner(2) - a, to_point = point - a;
    const double bb = dot(to_b, to_b), bc = dot(to_b, to_c), cc = dot(to_c, to_c);
    const double pb = dot(to_point, to_b), pc = dot(to_point, to_c);
    const double whole = bb * cc - bc * bc;
    if (!(whole > 0))
      return {1, 0, 0};
    CornerWeights weights{0, (pb * cc - pc * bc) / whole, (pc * bb - pb * bc) / whole};
    weights[0] = 1 - weights[1] - weights[2];
    double sum = 0;
    for (double& weight : weights)
      sum += weight = std::max(weight, 0.0);
    for (double& weight : weights)
      weight /= sum;
    return weights;
  }

  VertexFrame frame_at(const TexelSample& sample, const Vec3d& point) const {
    return interpolated(frames_[sample.triangle], weights_at(sample.triangle, point));
  }

  /// Makes a direction of length 1; one that looks away from the tile's own normal is turned to its
  /// side.
  static Vec3d in_front(Vec3d coefficients) {
    constexpr double kLeast = 0.05;
    coefficients = direction_of(coefficients);
    if (coefficients.z >= kLeast)
      return coefficients;
    coefficients.z = kLeast;
    return direction_of(coefficients);
  }

  images::Image drawn(const NormalTexels& directions) {
    find_coefficients(directions);
    const ChartLayout& layout = samples_.layout();
    images::Image map(layout.width, layout.height, 3);
    for (std::size_t i = 0; i < map.texels.size(); i += 3)
      std::ranges::copy(kFlat, map.texels.begin() + static_cast<std::ptrdiff_t>(i));
    for (const ChartPlane& plane : layout.planes) {
      for (std::uint32_t y = plane.top; y < plane.bottom; ++y) {
        for (std::uint32_t x = plane.left; x < plane.right; ++x) {
          if (is_known(x, y))
            store(in_front(sharpened(plane, x, y)), map.at(x, y));
        }
      }
    }
    return map;
  }

  void find_coefficients(const NormalTexels& directions) {
    coefficients_.assign(samples_count(), FourFloats{});
    const ChartLayout& layout = samples_.layout();
    for (std::uint32_t y = 0; y < layout.height; ++y) {
      for (std::uint32_t x = 0; x < layout.width; ++x) {
        const TexelSample& sample = samples_.at(x, y);
        if (sample.triangle == kNoFace)
          continue;
        const NormalTexel to = directions.at(x, y);
        const Vec3d direction{double(to[0]), double(to[1]), double(to[2])};
        const Vec3f found =
            to_float(in_front(frame_at(sample, sample.point).coefficients_of(direction)));
        coefficients_[index(x, y)] = FourFloats{found.x, found.y, found.z, 1};
      }
    }
  }

  std::size_t samples_count() const {
    return std::size_t{samples_.layout().width} * samples_.layout().height;
  }
  std::size_t index(std::uint32_t x, std::uint32_t y) const {
    return std::size_t{y} * samples_.layout().width + x;
  }
  bool is_known(std::uint32_t x, std::uint32_t y) const {
    return coefficients_[index(x, y)][3] != 0;
  }
  static void store(const Vec3d& coefficients, std::uint8_t* texel) {
    texel[0] = value_of(coefficients.x);
    texel[1] = value_of(coefficients.y);
    texel[2] = value_of(coefficients.z);
  }

  /// Viewers mix four texels, which blurs: away from the mean of its surroundings by half of what
  /// it differs from that, a texel comes nearer to the surface.
  Vec3d sharpened(const ChartPlane& plane, std::uint32_t x, std::uint32_t y) const {
    constexpr float kMore = 0.5;
    constexpr float kMiddle = 6;  // of it in a mean along an axis, to one of each neighbour
    FourFloats sum{};             // of what is known, and how much that is
    for (std::uint32_t j = std::max(y, plane.top + 1) - 1; j < std::min(y + 2, plane.bottom); ++j) {
      for (std::uint32_t i = std::max(x, plane.left + 1) - 1; i < std::min(x + 2, plane.right); ++i)
        sum += coefficients_[index(i, j)] * ((i == x ? kMiddle : 1) * (j == y ? kMiddle : 1));
    }
    const FourFloats own = coefficients_[index(x, y)];
    const FourFloats more = own + (own - sum / sum[3]) * kMore;
    return {double{more[0]}, double{more[1]}, double{more[2]}};
  }

  /// Amid four texels of the map, one in so many along each side.
  void compare(BakedNormalMap& baked) {
    constexpr std::uint32_t kStep = 8;
    std::size_t count = 0;
    for (const ChartPlane& plane : samples_.layout().planes) {
      for (std::uint32_t y = plane.top + kBakeGutter; y + 1 < plane.bottom; y += kStep) {
        for (std::uint32_t x = plane.left + kBakeGutter; x + 1 < plane.right; x += kStep)
          count += compare(plane, x, y, baked) ? 1 : 0;
      }
    }
    if (count > 0) {
      baked.own_degrees /= static_cast<double>(count);
      baked.map_degrees /= static_cast<double>(count);
    }
  }

  bool compare(const ChartPlane& plane, std::uint32_t x, std::uint32_t y, BakedNormalMap& baked) {
    Vec3d point, shown;
    for (const auto& [i, j] : {std::pair(x, y), {x + 1, y}, {x, y + 1}, {x + 1, y + 1}}) {
      if (!samples_.at(i, j).is_inside())
        return false;
      point = point + samples_.at(i, j).point * 0.25;
      const std::uint8_t* texel = baked.map.at(i, j);
      shown = shown + Vec3d{part_of(texel[0]), part_of(texel[1]), part_of(texel[2])};
    }
    const TexelSample& sample = samples_.at(x, y);
    const VertexFrame frame = frame_at(sample, point);
    const Vec3d original = direction(plane, sample, point);
    baked.own_degrees += degrees_between(frame.normal, original);
    baked.map_degrees += degrees_between(direction_of(frame.mixed(shown)), original);
    return true;
  }

  const NormalSurface& tile_;
  const TexelSamples& samples_;
  FinerNormals& finer_;
  double texel_;
  std::vector<std::array<VertexFrame, 3>> frames_;  ///< of triangles
  /// One per texel, in its frame, and 1; all 0 where nothing is known.
  std::vector<FourFloats> coefficients_;
};

}  // namespace

struct NormalBaker::Work {
  Work(const NormalSurface& tile, std::span<const NormalSurface> finer, std::uint32_t longest)
      : distinct(tile.triangles), side(longest), directions(finer, tile.positions) {
    for (const std::uint32_t t : distinct.firsts())
      normals.push_back(tile.normals[t]);
    surface = {tile.positions, distinct.triangles(), normals, {}, nullptr};
    bare = {tile.positions, distinct.triangles(), {}, nullptr};
  }

  const DistinctTriangles distinct;
  const std::uint32_t side;
  FinerNormals directions;
  std::vector<CornerNormals> normals;
  NormalSurface surface;
  TexturedSurface bare;  ///< without its normals
  std::unique_ptr<const TexelSamples> samples;
};

NormalBaker::NormalBaker(const NormalSurface& tile, std::span<const NormalSurface> finer,
                         std::uint32_t side)
    : work_(std::make_unique<Work>(tile, finer, side)) {}
NormalBaker::~NormalBaker() = default;

BakedNormalMap NormalBaker::bake(float least_texel) {
  const BakeSize size{work_->side, least_texel};
  work_->samples = work_->samples ? std::make_unique<const TexelSamples>(*work_->samples, size)
                                  : std::make_unique<const TexelSamples>(work_->bare, size);
  BakedNormalMap baked = MapMaker(work_->surface, work_->directions, *work_->samples)();
  baked.corners = work_->distinct.expanded(baked.corners);
  baked.tangents = work_->distinct.expanded(baked.tangents);
  return baked;
}

}  // namespace meshhier::texture
