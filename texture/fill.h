// Texels that nothing covers.
#pragma once

#include "images/image.h"

#include <cstdint>
#include <span>

namespace meshhier::texture {

/// Gives texels without `is_known`, one entry a texel, the values of about the nearest one that is
/// known (chamfer distance: Borgefors 1986). Nothing changes if none is. O(texels).
void fill_unknown(images::Image& image, std::span<const std::uint8_t> is_known);

/// Does about the same for less, in blocks of 8 x 8 texels: in those of which some are known,
/// others have the values of the nearest ones there; all others have one colour, about that of the
/// nearest block, which encoders have nothing to do with. Requires sides that are multiples of 8.
/// O(texels).
void fill_blocks(images::Image& image, std::span<const std::uint8_t> is_known);

}  // namespace meshhier::texture
