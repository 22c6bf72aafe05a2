// The charts of a tile in a picture, and the points of the surface that its texels show.
#pragma once

#include "base/vec.h"
#include "texture/bake.h"
#include "texture/chart_growing.h"
#include "texture/chart_layout.h"
#include "texture/corners.h"
#include "texture/faces.h"
#include "texture/texel_raster.h"
#include "texture/texel_segment.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// A point of a triangle as shares of its corners.
using CornerWeights = std::array<float, 3>;

/// The point of the surface that a texel shows: a + on_b * (b - a) + on_c * (c - a).
struct TexelSample {
  float on_b = 0, on_c = 0;
  std::uint32_t triangle = kNoFace;
  /// From the triangle, texels squared; the point is in its plane. Of TexelSamples::beside(), 1.
  float distance = 0;

  bool is_inside() const { return triangle != kNoFace && distance == 0; }
};

/// Returns the shares of a sample's point, or of one of its triangle that is near, about.
inline CornerWeights weights_of(const TexelSample& sample) {
  CornerWeights weights{1 - sample.on_b - sample.on_c, sample.on_b, sample.on_c};
  if (sample.is_inside())
    return weights;
  float sum = 0;
  for (float& weight : weights)
    sum += weight = weight > 0 ? weight : 0;
  for (float& weight : weights)
    weight /= sum;
  return weights;
}

class TexelSamples {
 public:
  /// `tile` must outlive it: positions and triangles of it are used, no triangle is there twice.
  TexelSamples(const TexturedSurface& tile, const BakeSize& size);
  TexelSamples(const TexelSamples&) = delete;
  TexelSamples& operator=(const TexelSamples&) = delete;

  /// Samples the same charts with other texels; `size` has the same side.
  void lay_out_again(const BakeSize& size) { fill(size); }

  const ChartLayout& layout() const { return layout_; }
  /// Returns the number of a texel, row by row.
  std::size_t index(std::uint32_t x, std::uint32_t y) const {
    return std::size_t{y} * layout_.width + x;
  }
  const TexelSample& at(std::uint32_t x, std::uint32_t y) const { return samples_[index(x, y)]; }

  /// Where a triangle's samples are.
  struct Plane {
    Vec3d a, to_b, to_c;
    Vec3d point(const TexelSample& sample) const {
      return a + to_b * double{sample.on_b} + to_c * double{sample.on_c};
    }
  };
  Plane plane_of(std::uint32_t triangle) const {
    const Vec3d a = position(triangle, 0);
    return {a, position(triangle, 1) - a, position(triangle, 2) - a};
  }
  /// Returns the point of a sample.
  Vec3d point(const TexelSample& sample) const { return plane_of(sample.triangle).point(sample); }
  /// Returns the sample of a point in a triangle's plane, perhaps beside the triangle.
  TexelSample beside(std::uint32_t triangle, const Vec3d& point) const;
  /// Returns where the surface looks to at a sample of a chart.
  Vec3d facing(const ChartPlane& plane, const TexelSample& sample) const {
    return faces_.areas[sample.triangle] > 0 ? faces_.normals[sample.triangle] : plane.normal;
  }
  /// One a triangle.
  std::vector<CornerTexcoords> texcoords() const;
  const TexturedSurface& tile() const { return tile_; }
  const Faces& faces() const { return faces_; }
  static TexelRange range_of(const ChartPlane& plane) {
    return {plane.left, plane.top, plane.right, plane.bottom};
  }
  /// The chart that a triangle is in.
  std::uint32_t chart_of(std::uint32_t triangle) const { return chart_of_[triangle]; }
  /// The triangles of a chart of the layout.
  std::span<const std::uint32_t> triangles_of(std::size_t chart) const {
    return std::span(charts_.triangles)
        .subspan(charts_.begin_of(chart), charts_.ends[chart] - charts_.begin_of(chart));
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

  struct Shares {
    double on_b = 0, on_c = 0;
  };

  void fill(const BakeSize& size);
  void cover();
  void mark_middle(std::uint32_t t);
  void cover_borders();
  void cover_beyond(const ChartPlane& plane, std::uint32_t t, std::size_t k);
  TexelSample beyond(const ChartPlane& plane, std::uint32_t t, std::size_t edge,
                     const TexelSegment::Foot& foot) const;
  Shares shares_of(std::uint32_t t, const Vec3d& way) const;

  const TexturedSurface& tile_;
  Faces faces_;
  SurfaceCharts charts_;
  std::vector<std::uint32_t> chart_of_;  ///< of triangles
  std::vector<ChartPlane> planes_;       ///< of the charts, before they are laid out
  ChartLayout layout_;
  std::vector<std::array<TexelPoint, 3>> corners_;  ///< of triangles, texels
  std::vector<TexelSample> samples_;                ///< of texels
};

}  // namespace meshhier::texture
