#include "texture/bake.h"

#include "texture/chart_growing.h"
#include "texture/chart_layout.h"
#include "texture/chart_refining.h"
#include "texture/faces.h"
#include "texture/fill.h"
#include "texture/nearest_triangle.h"
#include "texture/texel_light.h"
#include "texture/texel_raster.h"
#include "texture/texel_sampler.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace meshhier::texture {
namespace {

/// How far a surface that faces alike may be, in texels, so that it is taken before a nearer one
/// that does not.
constexpr double kReach = 32;

/// The point of the surface that a texel shows.
struct Sample {
  Vec3d point;
  std::uint32_t triangle = kNoFace;
  float distance = 0;  ///< from the triangle, texels squared
};

/// The charts of a tile in a picture, and the points that its texels show.
class Sampling {
 public:
  Sampling(const TexturedSurface& tile, const BakeSize& size)
      : tile_(tile),
        faces_(faces_of(tile.positions, tile.triangles)),
        corners_(tile.triangles.size()) {
    place(size);
    cover();
    for_each_triangle([&](const ChartPlane& plane, std::uint32_t t) { mark_middle(plane, t); });
    cover_borders();
  }

  const ChartLayout& layout() const { return layout_; }
  const std::vector<Sample>& samples() const { return samples_; }

  Vec3d facing(const ChartPlane& plane, std::uint32_t triangle) const {
    return faces_.areas[triangle] > 0 ? faces_.normals[triangle] : plane.normal;
  }
  std::vector<CornerTexcoords> texcoords() const {
    std::vector<CornerTexcoords> texcoords(corners_.size());
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k)
        texcoords[t][k] = {static_cast<float>(corners_[t][k].x / layout_.width),
                           static_cast<float>(corners_[t][k].y / layout_.height)};
    }
    return texcoords;
  }

 private:
  template <class Visit>
  void for_each_triangle(const Visit& visit) {
    for (std::uint32_t c = 0; c < charts_.ends.size(); ++c) {
      for (std::uint32_t i = charts_.begin_of(c); i < charts_.ends[c]; ++i)
        visit(layout_.planes[c], charts_.triangles[i]);
    }
  }
  Vec3d position(std::uint32_t triangle, std::size_t corner) const {
    return to_double(tile_.positions[raw(tile_.triangles[triangle][corner % 3])]);
  }
  Sample& sample(std::uint32_t x, std::uint32_t y) {
    return samples_[std::size_t{y} * layout_.width + x];
  }

  void place(const BakeSize& size) {
    PlaneCharts refined_charts =
        refined(tile_.positions, tile_.triangles, faces_, grow_charts(faces_), size.side);
    charts_ = std::move(refined_charts.charts);
    layout_ = lay_out(std::move(refined_charts.planes), size);
    for_each_triangle([&](const ChartPlane& plane, std::uint32_t t) {
      for (std::size_t k = 0; k < 3; ++k)
        corners_[t][k] = layout_.texel_of(plane, position(t, k));
    });
  }

  /// Gives the texels within triangles their samples.
  void cover() {
    samples_.assign(std::size_t{layout_.width} * layout_.height, {});
    for_each_triangle([&](const ChartPlane&, std::uint32_t t) {
      const Vec3d a = position(t, 0), b = position(t, 1) - a, c = position(t, 2) - a;
      RasterTriangle(corners_[t])
          .for_each(layout_.width, layout_.height,
                    [&](std::uint32_t x, std::uint32_t y, double on_b, double on_c) {
                      Sample& texel = sample(x, y);
                      if (texel.triangle == kNoFace)
                        texel = {a + b * on_b + c * on_c, t, 0};
                    });
    });
  }

  /// The texel around the middle of a triangle that covers none.
  void mark_middle(const ChartPlane&, std::uint32_t t) {
    Sample& texel = samples_[texel_at(middle_of(corners_[t]), layout_.width, layout_.height)];
    if (texel.triangle == kNoFace)
      texel = {(position(t, 0) + position(t, 1) + position(t, 2)) * (1.0 / 3), t, 0};
  }

  /// Gives the texels that are seen from within a chart, though they are outside, their samples: on
  /// the nearest triangle, extended beyond its edge.
  void cover_borders() {
    std::vector<std::uint32_t> chart_of(corners_.size());
    for (std::uint32_t c = 0, i = 0; c < charts_.ends.size(); ++c) {
      for (; i < charts_.ends[c]; ++i)
        chart_of[charts_.triangles[i]] = c;
    }
    for_each_triangle([&](const ChartPlane& plane, std::uint32_t t) {
      for (std::size_t k = 0; k < 3 && !plane.is_point; ++k) {
        const std::uint32_t other = faces_.across[t][k];
        if (other == kNoFace || chart_of[other] != chart_of[t])
          cover_beyond(plane, t, k);
      }
    });
  }

  void cover_beyond(const ChartPlane& plane, std::uint32_t t, std::size_t k) {
    const TexelSegment edge(corners_[t][k], corners_[t][(k + 1) % 3]);
    const Vec3d start = position(t, k), along = position(t, k + 1) - start;
    edge.for_each_near({plane.left, plane.top, plane.right, plane.bottom},
                       [&](std::uint32_t x, std::uint32_t y, const TexelSegment::Foot& foot) {
                         Sample& texel = sample(x, y);
                         if (texel.triangle == kNoFace || foot.distance < texel.distance)
                           texel = {
                               start + along * foot.part + beyond(plane, t, foot.off_x, foot.off_y),
                               t, static_cast<float>(foot.distance)};
                       });
  }

  /// The way in a triangle's plane that is so many texels long in the picture.
  Vec3d beyond(const ChartPlane& plane, std::uint32_t t, double x, double y) const {
    const double scale = 1 / layout_.density;
    const Vec3d flat = plane.x * (x * scale) + plane.y * (y * scale);
    constexpr double kSteepest = 0.3;
    const double seen = std::max(dot(faces_.normals[t], plane.normal), kSteepest);
    return flat + plane.normal * (-dot(faces_.normals[t], flat) / seen);
  }

  const TexturedSurface& tile_;
  Faces faces_;
  SurfaceCharts charts_;
  ChartLayout layout_;
  std::vector<std::array<TexelPoint, 3>> corners_;  ///< of triangles, texels
  std::vector<Sample> samples_;                     ///< of texels
};

/// The triangles of several surfaces, numbered through.
NearestTriangle joined(std::span<const TexturedSurface> surfaces, std::span<const Vec3f> tile) {
  std::vector<NearestTriangle::Corners> triangles;
  for (const TexturedSurface& surface : surfaces) {
    for (const TileTriangle& t : surface.triangles)
      triangles.push_back({surface.positions[raw(t[0])], surface.positions[raw(t[1])],
                           surface.positions[raw(t[2])]});
  }
  Vec3d low = to_double(tile[0]), high = low;
  for (const Vec3f& p : tile) {
    low = {std::min<double>(low.x, p.x), std::min<double>(low.y, p.y),
           std::min<double>(low.z, p.z)};
    high = {std::max<double>(high.x, p.x), std::max<double>(high.y, p.y),
            std::max<double>(high.z, p.z)};
  }
  const double size = length(high - low);
  return {triangles, (low + high) * 0.5, size > 0 ? size : 1};
}

std::uint32_t channels_of(std::span<const TexturedSurface> surfaces) {
  std::uint32_t channels = 3;
  for (const TexturedSurface& surface : surfaces) {
    if (surface.image != nullptr)
      channels = std::max(channels, surface.image->channels);
  }
  return channels;
}

/// Triangles, each once.
class DistinctTriangles {
 public:
  explicit DistinctTriangles(std::span<const TileTriangle> all) : number_(all.size()) {
    std::vector<std::uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return all[a] != all[b] ? all[a] < all[b] : a < b;
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool again = i > 0 && all[order[i]] == all[order[i - 1]];
      number_[order[i]] = again ? number_[order[i - 1]] : order[i];
    }
    for (std::uint32_t t = 0; t < all.size(); ++t) {
      if (number_[t] == t) {
        number_[t] = static_cast<std::uint32_t>(triangles_.size());
        triangles_.push_back(all[t]);
      } else {
        number_[t] = number_[number_[t]];  // of the first, which came before
      }
    }
  }
  std::span<const TileTriangle> triangles() const { return triangles_; }
  /// Of all triangles, from one entry for each distinct one.
  std::vector<CornerTexcoords> expanded(const std::vector<CornerTexcoords>& of_distinct) const {
    std::vector<CornerTexcoords> all;
    all.reserve(number_.size());
    for (const std::uint32_t number : number_)
      all.push_back(of_distinct[number]);
    return all;
  }

 private:
  std::vector<std::uint32_t> number_;  ///< in triangles_, of each triangle
  std::vector<TileTriangle> triangles_;
};

/// The colours of the samples.
images::Image colour(const Sampling& sampling, std::span<const TexturedSurface> finer,
                     std::span<const Vec3f> tile) {
  const ChartLayout& layout = sampling.layout();
  const double texel = 1 / layout.density;
  NearestTriangle nearest = joined(finer, tile);
  const TexelSampler sampler(finer, texel);
  images::Image image(layout.width, layout.height, channels_of(finer));
  std::vector<std::uint8_t> is_known(sampling.samples().size());
  for (const ChartPlane& plane : layout.planes) {
    for (std::uint32_t y = plane.top; y < plane.bottom; ++y) {
      for (std::uint32_t i = plane.left; i < plane.right; ++i) {
        // To and fro: each texel is beside the last one.
        const std::uint32_t x = (y - plane.top) % 2 == 0 ? i : plane.left + plane.right - 1 - i;
        const std::size_t number = std::size_t{y} * layout.width + x;
        const Sample& sample = sampling.samples()[number];
        if (sample.triangle == kNoFace || is_known[number] != 0)
          continue;
        const NearestTriangle::Found found =
            nearest(sample.point, sampling.facing(plane, sample.triangle), kReach * texel);
        if (found.triangle == NearestTriangle::kNone)
          continue;
        store_texel(sampler(found.triangle, found.on_b, found.on_c), image.at(x, y),
                    image.channels);
        is_known[number] = 1;
      }
    }
  }
  fill_unknown(image, is_known);
  return image;
}

}  // namespace

BakedTexture bake(const TexturedSurface& tile, std::span<const TexturedSurface> finer,
                  const BakeSize& size) {
  if (tile.triangles.empty())
    return {};
  const DistinctTriangles distinct(tile.triangles);
  TexturedSurface surface = tile;
  surface.triangles = distinct.triangles();
  const Sampling sampling(surface, size);
  BakedTexture baked;
  baked.image = colour(sampling, finer, tile.positions);
  baked.corners = distinct.expanded(sampling.texcoords());
  baked.texel = static_cast<float>(1 / sampling.layout().density);
  baked.charts = static_cast<std::uint32_t>(sampling.layout().planes.size());
  return baked;
}

float texel_size(const TexturedSurface& surface, std::uint32_t width, std::uint32_t height) {
  double area = 0, texels = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return to_double(surface.positions[raw(surface.triangles[t][k])]);
    };
    area += length(cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
    texels += area_of(surface.corners[t]) * width * height;
  }
  return area > 0 && texels > 0 ? static_cast<float>(std::sqrt(area / texels)) : 0;
}

}  // namespace meshhier::texture
