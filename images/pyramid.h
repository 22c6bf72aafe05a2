// A picture's pyramid: each level has half of the width and height of the one below, rounded up.
//
//       level 0, 5 wide      a b c d e
//                            |_| |_| |_  the odd last column stands for two
//       level 1, 3 wide       A   B   E
//
// A mean of texels is one of light, not of their sRGB numbers: else fine patterns get darker with
// each level. It is weighted by alpha, so that the colour behind what is transparent does not shine
// through.
#pragma once

#include <cstdint>

namespace meshhier::images {

struct TexelSize {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const TexelSize&, const TexelSize&) = default;
};

/// Returns the number of levels down to the one of 1 x 1 texels. Requires sides of 1 or more.
std::uint32_t level_count(TexelSize picture);
TexelSize level_size(TexelSize picture, std::uint32_t level);

/// Makes a row of the next level: the means of each two texels in two rows, in linear light and
/// weighted by alpha, exact but for one rounding at the end. `above` and `below` have `width`
/// texels and may be the same row; an odd last column stands for two. `means`: (width + 1) / 2
/// texels.
void halve_rows(const std::uint8_t* above, const std::uint8_t* below, std::uint32_t width,
                std::uint32_t channels, std::uint8_t* means);

/// The same for directions, whose channels are 127.5 times (a coordinate + 1): means that are
/// brought to unit length. Requires 3 channels.
void halve_directions(const std::uint8_t* above, const std::uint8_t* below, std::uint32_t width,
                      std::uint32_t channels, std::uint8_t* means);

}  // namespace meshhier::images
