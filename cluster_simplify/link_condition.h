// Tells what a collapse would do to the topology of the surface around its edge.
#pragma once

#include "cluster_simplify/collapse_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// From harmless to harmful.
enum class TopologyChange : std::uint8_t {
  none,      ///< the surface stays what it is, up to deformation
  tears,     ///< a hole or handle closes, sheets touch, or two triangles become one
  vanishes,  ///< nothing but these triangles hangs together, and all of them go
  pinches,   ///< two open borders meet in a point: what is between them comes off
};

/// The link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999) with open borders as if closed by
/// one more vertex; holds for surfaces with non-manifold edges, too. Keeps a mark per vertex
/// between calls; O(fans).
class LinkCondition {
 public:
  explicit LinkCondition(std::uint32_t vertex_count) : marks_(vertex_count) {}

  /// `around_a`, `around_b`: all triangles around a and b, two ends of an edge.
  TopologyChange change(const CollapseMesh& mesh, std::uint32_t a, std::uint32_t b, Fans around_a,
                        Fans around_b);

 private:
  void mark_neighbours(std::uint32_t b, Fans around_a);

  std::vector<std::uint32_t> marks_;
  std::uint32_t stamp_ = 0;  ///< marks: stamp_ a neighbour of a, stamp_ + 1 opposite the edge
};

}  // namespace meshhier::cluster_simplify
