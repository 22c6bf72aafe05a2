// The first, rough parts of a small graph.
#pragma once

#include "partition/refine.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// Bisects a graph recursively into parts of about `targets`, all of them on one side of a line
/// before they are told apart. Each bisection is the best of several: planes across the vertices'
/// centres, and regions grown from single vertices, each refined. Returns each vertex's part.
/// Requires a connected graph for good results, not for sound ones. O(k (n log n + m)) worst, k the
/// number of tries times the depth.
std::vector<std::uint32_t> bisect_recursively(const Graph& graph,
                                              std::span<const std::uint32_t> targets,
                                              RefineCounts& counts);

}  // namespace meshhier::partition
