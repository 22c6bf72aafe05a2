#include "images/uastc_reuse.h"

#include "images/uastc_line.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace meshhier::images {

RecentWeights::Found RecentWeights::most_alike(const Sixteen& along) const {
  Found best{nullptr, 0};
  for (std::size_t i = 0; i < std::min(count_, kSets); ++i) {
    const float alike = std::abs(sum_of(along * sets_[i].way));
    if (alike > best.alike)
      best = {&sets_[i], alike};
  }
  return best;
}

void RecentWeights::add(const UastcBlock& block) {
  assert(block.mode == kReusedMode);
  Sixteen weights;
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    weights.rows[i / 4][i % 4] = block.weights[i];
  const Sixteen parts = parts_of(weights, uastc_mode(kReusedMode).weight_bits);
  const Sixteen way = parts - Sixteen::all(sum_of(parts) / kBlockTexels);
  const float square = sum_of(way * way);
  if (!(square > 0))
    return;
  Set& set = sets_[count_++ % kSets];
  std::copy_n(block.weights.begin(), kBlockTexels, set.weights.begin());
  set.parts = parts;
  set.way = way * Sixteen::all(1 / std::sqrt(square));
}

}  // namespace meshhier::images
