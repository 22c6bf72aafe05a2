#include "images/uastc_subsets.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <vector>

namespace meshhier::images {
namespace {

std::uint16_t mask_of(const Pattern& pattern) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    mask |= std::uint32_t{pattern[i]} << i;
  return static_cast<std::uint16_t>(mask);
}

const std::vector<MaskedPattern>& masked_patterns() {
  static const std::vector<MaskedPattern> all = [] {
    std::vector<MaskedPattern> made;
    for (const std::uint8_t mode : {kSubsetMode, kOtherSubsetMode}) {
      std::uint8_t number = 0;
      for (const Pattern& pattern : patterns_of(uastc_mode(mode).patterns))
        made.push_back({mode, number++, mask_of(pattern)});
    }
    return made;
  }();
  return all;
}

/// Returns the texels that are above a limit, a bit each.
std::uint32_t above(const Sixteen& values, float limit) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    mask |= (values[i] > limit ? 1U : 0U) << i;
  return mask;
}

std::uint32_t clusters_of(const Channels<3>& texels, const Line<3>& principal) {
  Sixteen along;
  for (std::size_t c = 0; c < 3; ++c)
    along += texels[c] * Sixteen::all(principal.high[c] - principal.low[c]);
  const TexelShare high = share_of(above(along, sum_of(along) / kBlockTexels));
  if (high.count == 0)
    return 0;
  Sixteen nearer;
  float middle = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float sum = sum_of(texels[c] * high.part);
    const float a = sum / high.count, b = (sum_of(texels[c]) - sum) / (kBlockTexels - high.count);
    nearer += texels[c] * Sixteen::all(a - b);
    middle += (a * a - b * b) / 2;
  }
  return above(nearer, middle);
}

}  // namespace

TexelShare share_of(std::uint32_t mask) {
  TexelShare share{{}, static_cast<float>(std::popcount(mask))};
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    share.part.rows[i / 4][i % 4] = (mask >> i & 1) != 0 ? 1.0F : 0.0F;
  return share;
}

void nearest_patterns(const Channels<3>& texels, const Line<3>& principal,
                      std::span<MaskedPattern> patterns) {
  assert(patterns.size() <= kMostPatternTries);
  const std::uint32_t clusters = clusters_of(texels, principal);
  std::array<int, kMostPatternTries> distances;
  std::size_t count = 0;
  for (const MaskedPattern& pattern : masked_patterns()) {
    const int differing = std::popcount(pattern.mask ^ clusters);
    const int distance = std::min(differing, static_cast<int>(kBlockTexels) - differing);
    // The list is short: one that is near moves the others on.
    std::size_t at = count;
    for (; at > 0 && distance < distances[at - 1]; --at) {
      if (at < patterns.size())
        distances[at] = distances[at - 1], patterns[at] = patterns[at - 1];
    }
    if (at < patterns.size())
      distances[at] = distance, patterns[at] = pattern,
      count = std::min(count + 1, patterns.size());
  }
}

}  // namespace meshhier::images
