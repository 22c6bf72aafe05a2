// A surface as a weighted graph whose cuts measure what compactness measures.
#pragma once

#include "base/vec.h"
#include "partition/surface.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// An undirected graph without loops; every edge is there twice, once at either end. All weights
/// together, each edge once, stay below 2^30.
struct Graph {
  struct Arc {
    std::uint32_t to;
    std::uint32_t weight;  ///< > 0
  };
  std::vector<std::uint32_t> first;   ///< per vertex its first arc; one entry more than vertices
  std::vector<Arc> arcs;              ///< by vertex
  std::vector<std::uint32_t> weight;  ///< per vertex: mesh vertices it stands for
  std::vector<Vec3f> center;          ///< per vertex: a point among them, in [0, 1]^3

  std::uint32_t size() const { return static_cast<std::uint32_t>(weight.size()); }
  std::uint32_t degree(std::uint32_t v) const { return first[v + 1] - first[v]; }
  std::span<const Arc> arcs_of(std::uint32_t v) const {
    return std::span(arcs).subspan(first[v], degree(v));
  }
};

/// The graph of a surface whose vertices are taken in groups: an edge between two groups weighs the
/// length of the line between them, from the midpoints of the surface's edges to the centroids of
/// their triangles, in whole parts of the mean length. So the weight of the edges between two sets
/// of groups is the length of the line between them, as compactness() measures it. `group_of`: per
/// vertex of the surface, < count. Independent of the order of the triangles and of the corner they
/// start with. O(n + t). Holds up to 24 bytes a group, 16 a triangle and 48 one between groups.
Graph surface_graph(const Surface& surface, std::span<const std::uint32_t> group_of,
                    std::uint32_t count);

/// The same with each vertex alone.
Graph surface_graph(const Surface& surface);

/// Joins the clusters' vertices: vertex v goes to `cluster_of[v]` < `count`. Arcs within a cluster
/// go, arcs between the same two clusters become one. O(n + m).
Graph contract(const Graph& graph, std::span<const std::uint32_t> cluster_of, std::uint32_t count);

/// The graph of the vertices listed, which get the numbers of their places. O(of what is listed),
/// with `place_of` as workspace: one entry a vertex of `graph`, any content, garbage afterwards.
Graph subgraph(const Graph& graph, std::span<const std::uint32_t> vertices,
               std::span<std::uint32_t> place_of);

/// Makes the graph connected: for components without an edge between them, edges of least weight
/// between vertices that follow each other on a space-filling curve (Morton 1966). O(n log n).
void link_components(Graph& graph);

}  // namespace meshhier::partition
