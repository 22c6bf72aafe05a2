#include "partition/spatial_order.h"

#include "base/bounds.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace meshhier::partition {
namespace {

constexpr std::uint32_t kCells = 1024;  // along an axis: three times ten bits are a key

/// Two zero bits before each of ten.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

struct CellKey {
  std::uint32_t key, index;
};

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3f> positions) {
  const Bounds bounds = bounds_of(positions);
  const Vec3d extent = to_double(bounds.max) - to_double(bounds.min);
  const double size = std::max({extent.x, extent.y, extent.z});
  const double scale = size > 0 ? kCells / size : 0;
  const auto cell = [&](float x, float least) {
    const double place = (double{x} - double{least}) * scale;
    return spread(place > 0 ? static_cast<std::uint32_t>(std::min(place, kCells - 1.0)) : 0);
  };
  constexpr int kDigit = 10, kDigits = 3;
  constexpr std::uint32_t kDigitMask = (1U << kDigit) - 1;
  std::array<std::array<std::uint32_t, kDigitMask + 2>, kDigits> starts{};
  std::vector<CellKey> keyed(positions.size());
  for (std::uint32_t i = 0; i < keyed.size(); ++i) {
    const Vec3f p = positions[i];
    keyed[i] = {
        cell(p.x, bounds.min.x) | cell(p.y, bounds.min.y) << 1 | cell(p.z, bounds.min.z) << 2, i};
    const std::uint32_t key = keyed[i].key;
    ++starts[0][(key & kDigitMask) + 1];
    ++starts[1][(key >> kDigit & kDigitMask) + 1];
    ++starts[2][(key >> 2 * kDigit) + 1];
  }
  std::vector<CellKey> sorted(keyed.size());
  for (int digit = 0; digit < kDigits; ++digit) {
    auto& next = starts[static_cast<std::size_t>(digit)];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const CellKey& k : keyed)
      sorted[next[k.key >> digit * kDigit & kDigitMask]++] = k;
    keyed.swap(sorted);
  }
  std::vector<std::uint32_t> order(keyed.size());
  std::transform(keyed.begin(), keyed.end(), order.begin(),
                 [](const CellKey& k) { return k.index; });
  return order;
}

}  // namespace meshhier::partition
