// A picture's pyramid: each level has half of the width and height of the one below, rounded up.
#pragma once

#include <cstdint>

namespace meshhier::images {

struct TexelSize {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const TexelSize&, const TexelSize&) = default;
};

/// Levels down to the one of 1 x 1 texels; sides are 1 or more.
std::uint32_t level_count(TexelSize picture);
TexelSize level_size(TexelSize picture, std::uint32_t level);

/// A row of the next level: of each two texels in two rows the mean, in linear light and weighted
/// by alpha, exact but for one rounding at the end. `above` and `below` have `width` texels, may be
/// the same row; an odd last column stands for two. `means`: (width + 1) / 2 texels.
void halve_rows(const std::uint8_t* above, const std::uint8_t* below, std::uint32_t width,
                std::uint32_t channels, std::uint8_t* means);

}  // namespace meshhier::images
