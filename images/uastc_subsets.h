// Patterns of two subsets that part texels about as two clusters do.
//
//       a b | a a      1. clusters: across the line of most variance, then once by the nearer mean
//       b b | a a      2. the patterns that differ from them in the fewest texels
//       ----+
//       b b   a a
//
// Fenney (2003) parts texels so for PVRTC; astcenc ranks ASTC's patterns so.
#pragma once

#include "images/uastc_line.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace meshhier::images {

/// A pattern of a mode, and its texels of subset 1, a bit each.
struct MaskedPattern {
  std::uint8_t mode, number;
  std::uint16_t mask;
};

inline constexpr std::size_t kMostPatternTries = 8;
/// The modes of two subsets of opaque texels with two bits of weights. The first one's patterns are
/// those of mode 2 too.
inline constexpr std::uint8_t kSubsetMode = 4, kOtherSubsetMode = 7;

/// Writes the `patterns.size()` most alike ones, the nearest first. Requires at most
/// kMostPatternTries.
void nearest_patterns(const Channels<3>& texels, const Line<3>& principal,
                      std::span<MaskedPattern> patterns);

/// Returns the texels of a mask.
TexelShare share_of(std::uint32_t mask);

}  // namespace meshhier::images
