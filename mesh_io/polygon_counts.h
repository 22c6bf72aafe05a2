// What polygons became.
#pragma once

#include <cstdint>

namespace meshhier::mesh_io {

/// Of polygons that are no fans.
struct PolygonCounts {
  std::uint64_t concave = 0;    ///< cut so that their triangles cover their shape
  std::uint64_t crossed = 0;    ///< no triangles cover them; fans
  std::uint64_t unchecked = 0;  ///< ahead of their vertices; fans

  friend PolygonCounts operator+(const PolygonCounts& a, const PolygonCounts& b) {
    return {a.concave + b.concave, a.crossed + b.crossed, a.unchecked + b.unchecked};
  }
};

}  // namespace meshhier::mesh_io
