#include "mesh_io/zeroed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshhier::mesh_io {
namespace {

/// Returns how many were made 0: none or one.
std::uint64_t zero_if_not_finite(std::span<float> numbers) {
  if (std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); }))
    return 0;
  std::ranges::fill(numbers, 0.0F);
  return 1;
}

}  // namespace

ZeroedCounts zero_what_is_not_finite(const AttributeLayout& layout, std::span<float> rows) {
  ZeroedCounts counts;
  const auto channels = static_cast<std::size_t>(layout.channels());
  for (; channels > 0 && rows.size() >= channels; rows = rows.subspan(channels)) {
    const auto part = [&](int offset, std::size_t count) {
      return rows.subspan(static_cast<std::size_t>(offset), count);
    };
    if (layout.normals)
      counts.normals += zero_if_not_finite(part(layout.normal_offset(), 3));
    if (layout.texcoords)
      counts.texcoords += zero_if_not_finite(part(layout.texcoord_offset(), 2));
  }
  return counts;
}

}  // namespace meshhier::mesh_io
