// The shape-outline: a thumbnail of the model made of lines.
#pragma once

#include "hierarchy/vec.h"

#include <cstdint>
#include <vector>

namespace meshhier {

/// Polyline i has the vertices [starts[i], starts[i + 1]); a closed one repeats its first vertex as
/// its last.
struct Outline {
  std::vector<Vec3f> vertices;  ///< relative to the hierarchy's origin
  std::vector<std::uint32_t> starts{
      0};  ///< ascending; starts.size() - 1 polylines; every one has 2 vertices or more

  std::size_t polyline_count() const { return starts.size() - 1; }
};

/// How the outline came about, for the manifest.
struct OutlineReport {
  std::uint32_t sector_level = 0;  ///< level whose nodes are the sectors
  std::uint32_t sector_count = 0;
  double tolerance = 0;  ///< used, as a part of the bounding-box diagonal
  std::uint64_t polylines_found = 0;
  std::uint64_t polylines_dropped = 0;  ///< to fit the budget
};

}  // namespace meshhier
