// Splits a graph into parts of given sizes, with short lines between them.
//
// Problem. The line between parts should be short, and each part must have its exact size. Looking
// at single vertices finds short pieces of lines, but not where a line should run.
//
// Idea. Multilevel (Karypis & Kumar, Multilevel k-way Partitioning Scheme for Irregular Graphs,
// 1998): decide on a small graph of the same shape, then carry the decision back.
//
//      surface, n vertices                                      parts of exact sizes
//          | stars become vertices                                   ^ refine_boundary():
//          v   (star_clusters)                                       |   lines vertex by vertex
//      n / 4 to n / 6                                           parts, about their sizes
//          | stars once more, then                                   ^ refine_coarsely()
//          v   matched pairs                                         |   on every graph
//      16 vertices a part  ----------- bisect_recursively() --------+
//
// Invariants. A coarse vertex weighs as many vertices as it stands for, an edge as much as the line
// between its ends is long: so a cut means the same on every level. Only what stands for boundary
// vertices can be on a boundary of the next finer graph, so each step looks at these alone.
//
// Cost. O(m) but for logarithms. The finest graph of a surface is never made as a whole: vertices
// are expanded from their stars along lines only (decision 003).
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
/// Requires 1 <= sizes.size() <= kMostParts; all sizes > 0, summing to graph.size(). Pure,
/// deterministic; may be called by many threads. `counts`: what it took is added; may be null.
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
