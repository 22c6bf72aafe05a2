// Vertices of the input that lie where an earlier one does.
#pragma once

#include <cstdint>

namespace meshhier {

/// A vertex at the place of an earlier one.
struct CopyVertex {
  std::uint32_t id = 0;     ///< VertexId
  std::uint32_t first = 0;  ///< the first vertex at its place, < id
  std::uint32_t slot = 0;   ///< its number there: 1 of the second vertex, 2 of the third, ...
  friend constexpr bool operator==(const CopyVertex&, const CopyVertex&) = default;
};
static_assert(sizeof(CopyVertex) == 12);

}  // namespace meshhier
