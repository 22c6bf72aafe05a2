#include "mesh_io/zeroed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshhier::mesh_io {
std::uint64_t zero_if_not_finite(std::span<float> attribute) {
  if (std::ranges::all_of(attribute, [](float number) { return std::isfinite(number); }))
    return 0;
  std::ranges::fill(attribute, 0.0F);
  return 1;
}

ZeroedCounts zero_what_is_not_finite(const AttributeParts& parts, std::span<float> rows) {
  ZeroedCounts counts;
  const std::size_t channels = parts.back().end();
  const AttributePart& normals = part_of(parts, AttributeKind::normals);
  const AttributePart& texcoords = part_of(parts, AttributeKind::texcoords);
  for (; channels > 0 && rows.size() >= channels; rows = rows.subspan(channels)) {
    counts.normals += zero_if_not_finite(normals.of(rows));
    counts.texcoords += zero_if_not_finite(texcoords.of(rows));
  }
  return counts;
}

}  // namespace meshhier::mesh_io
