// Where the triangles of a tile pass through levels.
//
// Problem. Triangles that share an edge, in one tile or in two, must end their segments at the same
// point of it, bit for bit, whatever lies exactly on a level: corners, edges, whole triangles.
//
// Idea. One rule decides each corner by itself: on the level counts as above (a symbolic
// perturbation: the level is lowered by less than any difference of heights). So no corner is on
// the level, and a triangle is passed through twice, at the two edges from below to above, or not
// at all:
//
//            above                       down: the edge that goes from above to below
//             /\                         up: the one that goes from below to above
//      down  /  \  up
//     ------*<---*------  level          Segments run from down to up of a triangle that turns
//          /      \                      counter-clockwise: solid, and what is higher, is on
//         /________\                     their left. Neighbours with one sense of turn go through
//     below       below                  an edge in opposite directions: ends meet beginnings.
//
// The point on an edge is computed from its two ends alone, from the nearer one on: what has an end
// exactly on the level is that end.
//
// Invariant. Each edge of a closed mesh that is passed has as many segments as triangles. Lines of
// a closed mesh are closed.
//
// Cost. Linear in the vertices and in the segments, with a logarithm of the levels for a triangle.
#pragma once

#include "drawing/levels.h"
#include "export/cut_part.h"
#include "export/map_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace meshhier::drawing {

/// An edge that is passed: numbers of the part's vertices.
struct PassedEdge {
  std::uint32_t below = 0, above = 0;
};

/// A part of a tile, with the heights of its vertices above the sheet.
class SlicedPart {
 public:
  /// Both must outlive it.
  SlicedPart(const exporting::CutPart& part, const exporting::MapFrame& view);

  /// Calls visit(level, down, up) for each segment, triangle by triangle.
  template <class Visit>
  void for_each_segment(const CutLevels& levels, const Visit& visit) const {
    for (const auto& t : part_.triangles) {
      const auto [low, high] = std::minmax({heights_[t[0]], heights_[t[1]], heights_[t[2]]});
      const LevelRange range = levels.between(low, high);
      for (std::uint32_t level = range.begin; level < range.end; ++level)
        visit_segment(t, level, levels[level].height, visit);
    }
  }

  /// Returns how many segments there are.
  std::uint64_t count_segments(const CutLevels& levels) const;

  /// Returns the point of an edge at a height, in the input's coordinates.
  Vec3d point_at(const PassedEdge& edge, double height) const;

  const exporting::CutPart& part() const { return part_; }

 private:
  template <class Visit>
  void visit_segment(const Triangle<std::uint32_t>& t, std::uint32_t level, double height,
                     const Visit& visit) const {
    PassedEdge down, up;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      const bool starts_above = heights_[from] >= height, ends_above = heights_[to] >= height;
      if (starts_above && !ends_above)
        down = {to, from};
      if (!starts_above && ends_above)
        up = {from, to};
    }
    visit(level, down, up);
  }

  const exporting::CutPart& part_;
  Vec3d origin_;
  std::vector<double> heights_;
};

}  // namespace meshhier::drawing
