// Which texels of a picture triangles show.
#pragma once

#include "texture/corners.h"
#include "texture/texel_bits.h"
#include "texture/texel_raster.h"

#include <array>
#include <cstdint>
#include <span>

namespace meshhier::texture {

/// In a picture of that size.
std::array<TexelPoint, 3> in_texels(const CornerTexcoords& corners, std::uint32_t width,
                                    std::uint32_t height);

/// Returns the texels whose middles are in a triangle. A triangle that has no such middle has the
/// texel where its own middle is. O(rows of all triangles + 1/64 of the texels that they cover,
/// each as often as it is covered) time, a bit a texel.
TexelBits shown_texels(std::uint32_t width, std::uint32_t height,
                       std::span<const CornerTexcoords> corners);

}  // namespace meshhier::texture
