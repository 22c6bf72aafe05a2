// Texels from means of what they show.
#pragma once

#include "texture/texel_light.h"
#include "texture/texel_segment.h"

#include <cstdint>
#include <vector>

namespace meshhier::texture {

/// Mean lights of the surface around the middle of each texel, weighted by a tent that ends at the
/// middles of the texels beside it.
struct TexelMeans {
  std::uint32_t width = 0;  ///< of the picture
  std::vector<TexelLight> lights;
  std::vector<std::uint8_t> is_known;

  TexelMeans(std::uint32_t w, std::uint32_t h)
      : width(w), lights(std::size_t{w} * h), is_known(lights.size()) {}
};

/// Makes of the means in a range those texels that come nearest to the surface (least squares) once
/// they are filtered as viewers do: the means themselves would be blurred a second time. Beside
/// texels that are not known, and at the range's border, the surface counts as going on without a
/// change. O(texels).
void fit_texels(TexelMeans& means, const TexelRange& range);

}  // namespace meshhier::texture
