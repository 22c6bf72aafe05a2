// Counts of what became of polygons.
#pragma once

#include <cstdint>

namespace meshhier::mesh_io {

/// Polygons of which the fan (0, i, i + 1) is not known to cover the shape.
struct PolygonCounts {
  std::uint64_t concave = 0;    ///< cut so that their triangles cover their shape
  std::uint64_t crossed = 0;    ///< no triangles cover them; cut into fans all the same
  std::uint64_t unchecked = 0;  ///< they come before their vertices; cut into fans unseen

  friend PolygonCounts operator+(const PolygonCounts& a, const PolygonCounts& b) {
    return {a.concave + b.concave, a.crossed + b.crossed, a.unchecked + b.unchecked};
  }
};

}  // namespace meshhier::mesh_io
