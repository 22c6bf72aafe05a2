#include "partition/select.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <vector>

namespace meshhier::partition {
namespace {

constexpr int kHistogramBits =
    16;  // 65536 counters of 8 bytes: the least memory granted holds them twice

/// Keys in [low, high], of which `below` keys of the source are smaller.
struct Range {
  SplitKey low = SplitKey::lowest();
  SplitKey high = SplitKey::highest();
  std::uint64_t below = 0;
  std::uint64_t count = 0;

  bool holds(const SplitKey& key) const { return low <= key && key <= high; }
};

/// One histogram pass: narrows the range to the bin that holds the k-th key.
Range narrow(const KeySource& keys, const Range& range, std::uint64_t k) {
  const bool by_id = range.low.projection == range.high.projection;
  const std::uint64_t origin = by_id ? range.low.id : range.low.projection;
  const std::uint64_t extent = (by_id ? range.high.id : range.high.projection) - origin;
  const int shift = std::max(0, static_cast<int>(std::bit_width(extent)) - kHistogramBits);
  std::vector<std::uint64_t> bins((extent >> shift) + 1);
  keys([&](std::span<const SplitKey> block) {
    for (const SplitKey& key : block) {
      if (range.holds(key))
        ++bins[((by_id ? key.id : key.projection) - origin) >> shift];
    }
  });
  Range next = range;
  std::size_t bin = 0;
  while (k >= next.below + bins[bin])
    next.below += bins[bin++];
  next.count = bins[bin];
  const std::uint64_t first = origin + (std::uint64_t{bin} << shift);
  const std::uint64_t last = std::min(origin + extent, first + ((std::uint64_t{1} << shift) - 1));
  if (by_id) {
    next.low.id = static_cast<std::uint32_t>(first);
    next.high.id = static_cast<std::uint32_t>(last);
  } else {
    if (bin > 0)
      next.low = {first, 0};
    if (last < range.high.projection)
      next.high = {last, SplitKey::highest().id};
  }
  return next;
}

}  // namespace

SplitKey select(const KeySource& keys, std::uint64_t count, std::uint64_t k,
                std::uint64_t memory_bytes) {
  assert(k < count);
  const std::uint64_t fitting = std::max<std::uint64_t>(memory_bytes, 1 << 20) / sizeof(SplitKey);
  Range range;
  range.count = count;
  while (range.count > fitting)
    range = narrow(keys, range, k);
  std::vector<SplitKey> held;
  held.reserve(range.count);
  keys([&](std::span<const SplitKey> block) {
    for (const SplitKey& key : block) {
      if (range.holds(key))
        held.push_back(key);
    }
  });
  const auto at = held.begin() + static_cast<std::ptrdiff_t>(k - range.below);
  std::nth_element(held.begin(), at, held.end());
  return *at;
}

}  // namespace meshhier::partition
