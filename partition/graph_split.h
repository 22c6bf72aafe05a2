// A graph split into parts of given sizes, with short lines between them.
#pragma once

#include "partition/graph.h"
#include "partition/refine.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// Splits a graph of unit weights: returns each vertex's part. Part i gets exactly `sizes[i]`
/// vertices. Parts are ordered as a tree's leaves: the first half, rounded up, of any run of parts
/// that came of halving is on one side of a short line.
///
/// Multilevel (Karypis & Kumar, Multilevel k-way Partitioning Scheme for Irregular Graphs, 1998):
/// the graph is coarsened to a few vertices a part; those are bisected recursively; and on the way
/// back to finer graphs the lines are refined between all parts, at the end with exact sizes.
///
/// Requires 1 <= sizes.size() <= kMostParts; all sizes > 0, summing to graph.size(). Deterministic.
/// O(m) but for logarithms. `counts`: what it took, added up; may be null.
std::vector<std::uint32_t> split_graph(const Graph& graph, std::span<const std::uint32_t> sizes,
                                       RefineCounts* counts = nullptr);

/// The same for a surface whose graph is never made as a whole: stars of vertices are split first,
/// then the lines between parts are refined in a graph of the stars along them, where one fixed
/// vertex a part stands for everything else. Independent of the order of the triangles.
std::vector<std::uint32_t> split_surface(const Surface& surface,
                                         std::span<const std::uint32_t> sizes,
                                         RefineCounts* counts = nullptr);

/// With more parts than this a graph should be split in two rounds: the graph that is bisected has
/// some vertices for every part, and bisecting is not O(m).
inline constexpr std::uint32_t kMostParts = Refiner::kMostParts;

}  // namespace meshhier::partition
