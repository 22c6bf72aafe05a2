// Texels that nothing covers.
#pragma once

#include "images/image.h"

#include <cstdint>
#include <span>

namespace meshhier::texture {

/// Gives texels without `is_known`, one entry a texel, the values of about the nearest one that is
/// known (chamfer distance: Borgefors 1986). Nothing changes if none is. O(texels).
void fill_unknown(images::Image& image, std::span<const std::uint8_t> is_known);

}  // namespace meshhier::texture
