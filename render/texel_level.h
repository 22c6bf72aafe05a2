// The level of a texture's pyramid that fits a facet.
#pragma once

#include "hierarchy/texture.h"
#include "render/mip_texture.h"

#include <array>
#include <cmath>

namespace meshhier::render {

/// Twice the area of the triangle (a, b, c).
inline double area_between(double ab_x, double ab_y, double ac_x, double ac_y) {
  return std::abs(ab_x * ac_y - ab_y * ac_x);
}

/// Returns the level at which a texel is as large as a sample. `places`: on the grid of samples. As
/// lines of sight are parallel, it is the same all over a facet.
inline double level_of(const MipTexture& texture, const std::array<Vec2f, 3>& texcoords,
                       const std::array<Vec3d, 3>& places) {
  const auto& [a, b, c] = places;
  const auto& [s, t, r] = texcoords;
  const double texels =
      double{1} * texture.width() * texture.height() *
      area_between(double{t.u} - s.u, double{t.v} - s.v, double{r.u} - s.u, double{r.v} - s.v);
  return level_for(texels / area_between(b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y));
}

}  // namespace meshhier::render
