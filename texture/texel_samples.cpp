#include "texture/texel_samples.h"

#include "texture/chart_refining.h"
#include "texture/texel_light.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <utility>

namespace meshhier::texture {

TexelSamples::TexelSamples(const TexturedSurface& tile, const BakeSize& size)
    : tile_(tile),
      faces_(faces_of(tile.positions, tile.triangles)),
      corners_(tile.triangles.size()) {
  PlaneCharts refined_charts =
      refined(tile_.positions, tile_.triangles, faces_, grow_charts(faces_), size.side);
  charts_ = std::move(refined_charts.charts);
  planes_ = std::move(refined_charts.planes);
  fill(size);
}

TexelSamples::TexelSamples(const TexelSamples& charts, const BakeSize& size)
    : tile_(charts.tile_),
      faces_(charts.faces_),
      charts_(charts.charts_),
      planes_(charts.planes_),
      corners_(charts.corners_.size()) {
  fill(size);
}

void TexelSamples::fill(const BakeSize& size) {
  layout_ = lay_out(planes_, size);
  for_each_triangle([&](const ChartPlane& plane, std::uint32_t t) {
    for (std::size_t k = 0; k < 3; ++k)
      corners_[t][k] = layout_.texel_of(plane, position(t, k));
  });
  cover();
  for_each_triangle([&](const ChartPlane&, std::uint32_t t) { mark_middle(t); });
  cover_borders();
}

std::vector<CornerTexcoords> TexelSamples::texcoords() const {
  std::vector<CornerTexcoords> texcoords(corners_.size());
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      texcoords[t][k] = {static_cast<float>(corners_[t][k].x / layout_.width),
                         static_cast<float>(corners_[t][k].y / layout_.height)};
  }
  return texcoords;
}

/// Gives the texels within triangles their samples.
void TexelSamples::cover() {
  samples_.assign(std::size_t{layout_.width} * layout_.height, {});
  for_each_triangle([&](const ChartPlane&, std::uint32_t t) {
    const Vec3d a = position(t, 0), b = position(t, 1) - a, c = position(t, 2) - a;
    RasterTriangle(corners_[t])
        .for_each(layout_.width, layout_.height,
                  [&](std::uint32_t x, std::uint32_t y, double on_b, double on_c) {
                    TexelSample& texel = samples_[index(x, y)];
                    if (texel.triangle == kNoFace)
                      texel = {a + b * on_b + c * on_c, t, 0};
                  });
  });
}

/// The texel around the middle of a triangle that covers none.
void TexelSamples::mark_middle(std::uint32_t t) {
  TexelSample& texel = samples_[texel_at(middle_of(corners_[t]), layout_.width, layout_.height)];
  if (texel.triangle == kNoFace)
    texel = {(position(t, 0) + position(t, 1) + position(t, 2)) * (1.0 / 3), t, 0};
}

/// Gives the texels that are seen from within a chart, though they are outside, their samples: on
/// the nearest triangle, extended beyond its edge.
void TexelSamples::cover_borders() {
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

void TexelSamples::cover_beyond(const ChartPlane& plane, std::uint32_t t, std::size_t k) {
  const TexelSegment edge(corners_[t][k], corners_[t][(k + 1) % 3]);
  const Vec3d start = position(t, k), along = position(t, k + 1) - start;
  const auto is_outside = [&](std::uint32_t x, std::uint32_t y) {
    return !samples_[index(x, y)].is_inside();
  };
  edge.for_each_near({plane.left, plane.top, plane.right, plane.bottom}, is_outside,
                     [&](std::uint32_t x, std::uint32_t y, const TexelSegment::Foot& foot) {
                       TexelSample& texel = samples_[index(x, y)];
                       if (texel.triangle == kNoFace || foot.distance < texel.distance)
                         texel = {
                             start + along * foot.part + beyond(plane, t, foot.off_x, foot.off_y),
                             t, static_cast<float>(foot.distance)};
                     });
}

/// The way in a triangle's plane that is so many texels long in the picture.
Vec3d TexelSamples::beyond(const ChartPlane& plane, std::uint32_t t, double x, double y) const {
  const double scale = 1 / layout_.density;
  const Vec3d flat = plane.x * (x * scale) + plane.y * (y * scale);
  constexpr double kSteepest = 0.3;
  const double seen = std::max(dot(faces_.normals[t], plane.normal), kSteepest);
  return flat + plane.normal * (-dot(faces_.normals[t], flat) / seen);
}

}  // namespace meshhier::texture
