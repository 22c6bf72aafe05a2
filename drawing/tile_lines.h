// The lines of one tile: its segments, joined as far as the tile goes.
#pragma once

#include "drawing/cut_segments.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::drawing {

/// An edge by the places of its two ends, in bits that are ordered as the numbers are: equal in all
/// tiles that have it, whatever numbers its vertices have there.
struct EdgeName {
  std::array<std::uint32_t, 6> bits{};
  friend auto operator<=>(const EdgeName&, const EdgeName&) = default;
};

/// A stretch of a line within a tile.
struct TileStretch {
  std::uint32_t level = 0;
  std::uint32_t points = 0;  ///< 1 or more; of a closed one the first does not come again
  bool is_closed = false;
  EdgeName first{}, last{};  ///< the edges where it begins and ends
};

struct TileLines {
  std::vector<TileStretch> stretches;
  std::vector<Vec3d> points;  ///< of all, in the input's coordinates
};

/// Memory that a segment takes while tile_lines() is at work.
inline constexpr std::uint64_t kSegmentBytes = 144;

/// Returns the lines at the levels. Deterministic, thread-safe. O(n log n) in the segments and in
/// the vertices.
TileLines tile_lines(const SlicedPart& part, const CutLevels& levels);

}  // namespace meshhier::drawing
