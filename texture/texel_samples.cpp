#include "texture/texel_samples.h"

#include "texture/chart_refining.h"
#include "texture/texel_light.h"

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
  chart_of_.resize(tile.triangles.size());
  for (std::uint32_t c = 0; c < charts_.ends.size(); ++c) {
    for (const std::uint32_t t : triangles_of(c))
      chart_of_[t] = c;
  }
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
    RasterTriangle(corners_[t])
        .for_each(layout_.width, layout_.height,
                  [&](std::uint32_t x, std::uint32_t y, double on_b, double on_c) {
                    TexelSample& texel = samples_[index(x, y)];
                    if (texel.triangle == kNoFace)
                      texel = {static_cast<float>(on_b), static_cast<float>(on_c), t, 0};
                  });
  });
}

/// The texel around the middle of a triangle that covers none.
void TexelSamples::mark_middle(std::uint32_t t) {
  constexpr float kThird = 1.0f / 3;
  TexelSample& texel = samples_[texel_at(middle_of(corners_[t]), layout_.width, layout_.height)];
  if (texel.triangle == kNoFace)
    texel = {kThird, kThird, t, 0};
}

/// Gives the texels that are seen from within a chart, though they are outside, their samples: on
/// the nearest triangle, extended beyond its edge.
void TexelSamples::cover_borders() {
  for_each_triangle([&](const ChartPlane& plane, std::uint32_t t) {
    for (std::size_t k = 0; k < 3 && !plane.is_point; ++k) {
      const std::uint32_t other = faces_.across[t][k];
      if (other == kNoFace || chart_of_[other] != chart_of_[t])
        cover_beyond(plane, t, k);
    }
  });
}

void TexelSamples::cover_beyond(const ChartPlane& plane, std::uint32_t t, std::size_t k) {
  const TexelSegment edge(corners_[t][k], corners_[t][(k + 1) % 3]);
  const auto is_outside = [&](std::uint32_t x, std::uint32_t y) {
    return !samples_[index(x, y)].is_inside();
  };
  edge.for_each_near(range_of(plane), is_outside,
                     [&](std::uint32_t x, std::uint32_t y, const TexelSegment::Foot& foot) {
                       TexelSample& texel = samples_[index(x, y)];
                       if (texel.triangle == kNoFace || foot.distance < texel.distance)
                         texel = beyond(plane, t, k, foot);
                     });
}

/// The sample off an edge's foot: the way from there in the triangle's plane is so many texels long
/// in the picture.
TexelSample TexelSamples::beyond(const ChartPlane& plane, std::uint32_t t, std::size_t edge,
                                 const TexelSegment::Foot& foot) const {
  const double scale = 1 / layout_.density;
  const Vec3d flat = plane.x * (foot.off_x * scale) + plane.y * (foot.off_y * scale);
  constexpr double kSteepest = 0.3;
  const double seen = std::max(dot(faces_.normals[t], plane.normal), kSteepest);
  const Vec3d way = flat + plane.normal * (-dot(faces_.normals[t], flat) / seen);
  std::array<double, 3> weights{};
  weights[edge] = 1 - foot.part;
  weights[(edge + 1) % 3] = foot.part;
  const auto [on_b, on_c] = shares_of(t, way);
  return {static_cast<float>(weights[1] + on_b), static_cast<float>(weights[2] + on_c), t,
          static_cast<float>(foot.distance)};
}

/// A way in a triangle's plane by its edges from corner a; none in a sliver, which has no plane.
TexelSamples::Shares TexelSamples::shares_of(std::uint32_t t, const Vec3d& way) const {
  constexpr double kSliver = 1e-12;
  const Vec3d to_b = position(t, 1) - position(t, 0), to_c = position(t, 2) - position(t, 0);
  const double bb = dot(to_b, to_b), bc = dot(to_b, to_c), cc = dot(to_c, to_c);
  const double area = bb * cc - bc * bc;
  if (!(area > kSliver * bb * cc))
    return {};
  const double b = dot(way, to_b), c = dot(way, to_c);
  return {(cc * b - bc * c) / area, (bb * c - bc * b) / area};
}

TexelSample TexelSamples::beside(std::uint32_t triangle, const Vec3d& point) const {
  const auto [on_b, on_c] = shares_of(triangle, point - position(triangle, 0));
  return {static_cast<float>(on_b), static_cast<float>(on_c), triangle, 1};
}

}  // namespace meshhier::texture
