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
  const AttributePart normals = layout.part(AttributeKind::normals);
  const AttributePart texcoords = layout.part(AttributeKind::texcoords);
  for (; channels > 0 && rows.size() >= channels; rows = rows.subspan(channels)) {
    counts.normals += zero_if_not_finite(normals.of(rows));
    counts.texcoords += zero_if_not_finite(texcoords.of(rows));
  }
  return counts;
}

}  // namespace meshhier::mesh_io
