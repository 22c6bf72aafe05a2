// Surfaces that have each triangle twice, once reversed: around an edge, one side alone.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/edge_star.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Whether most edges have twice as many triangles as those of a plain surface. O(edges).
bool is_two_sided(const CollapseMesh& mesh);

/// Both sides are one set of points: what is measured of one holds for both. Keeps its memory from
/// one edge to the next.
class OneSide {
 public:
  /// Finds triangles that follow each other around both ends of the edge and of which all others
  /// are the reverses. False if there are none. O(n^2) of at most kMost triangles at an end.
  bool find(const EdgeStar& star);

  /// The triangles that find() found.
  EdgeStar& star() { return star_; }
  /// A triangle of the side, and its reverse; a triangle at the edge is in two pairs.
  std::span<const std::array<std::uint32_t, 2>> pairs() const { return pairs_; }

 private:
  static constexpr std::size_t kMost = 64;

  bool find_around(Fans fans, std::uint32_t seed, std::vector<CollapseMesh::Fan>& side);
  bool find_reverses(Fans fans);

  EdgeStar star_;
  std::vector<CollapseMesh::Fan> from_, to_;
  std::vector<std::size_t> reverses_;  ///< of fans, by their places
  std::vector<std::array<std::uint32_t, 2>> pairs_;
};

}  // namespace meshhier::cluster_simplify
