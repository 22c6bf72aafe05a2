// Smaller graphs of the same shape.
#pragma once

#include "partition/graph.h"

#include <cstdint>
#include <vector>

namespace meshhier::partition {

/// Which vertices become one.
struct Clusters {
  std::vector<std::uint32_t> of;  ///< per vertex, < count; every cluster has a vertex
  std::uint32_t count = 0;
};

/// Vertices with their neighbours that are in no cluster yet, in order of numbers: a quarter to a
/// sixth of a surface's vertices is left. What has no arc stays alone. O(n + m).
Clusters star_clusters(const Graph& graph);

/// The same on a surface's vertices and edges. O(n + t). Holds 12 bytes a vertex and a triangle.
Clusters star_clusters(const Surface& surface);

/// Pairs of neighbours, joined by the heaviest edges for their weight (Karypis & Kumar 1998; the
/// rating of Holtgrewe, Sanders & Schulz 2010); vertices without a free neighbour are paired with
/// each other if their heaviest neighbour is the same. No cluster weighs more than `most` unless
/// one vertex does. O(n + m).
Clusters matched_pairs(const Graph& graph, std::uint32_t most);

}  // namespace meshhier::partition
