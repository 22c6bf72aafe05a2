// A surface as a weighted graph whose cuts measure what compactness measures.
#pragma once

#include "hierarchy/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// A triangle by vertex numbers.
using LocalTriangle = std::array<std::uint32_t, 3>;

/// An undirected graph without loops; every edge is there twice, once at either end. All weights
/// together, each edge once, stay below 2^30.
struct Graph {
  struct Arc {
    std::uint32_t to = 0;
    std::uint32_t weight = 0;  ///< > 0
  };
  std::vector<std::uint32_t> first;   ///< per vertex its first arc; one entry more than vertices
  std::vector<Arc> arcs;              ///< by vertex
  std::vector<std::uint32_t> weight;  ///< per vertex: mesh vertices it stands for
  std::vector<Vec3f> center;          ///< per vertex: their mean, in [0, 1]^3

  std::uint32_t size() const { return static_cast<std::uint32_t>(weight.size()); }
  std::uint32_t degree(std::uint32_t v) const { return first[v + 1] - first[v]; }
  std::span<const Arc> arcs_of(std::uint32_t v) const {
    return std::span(arcs).subspan(first[v], degree(v));
  }
};

/// The graph of a surface: an edge weighs the length of the lines from its midpoint to the
/// centroids of its triangles, in whole parts of the mean. So the weight of the edges between two
/// sets of vertices is the length of the line between them, as compactness() measures it.
/// Vertex v is what triangles call `first` + v; those with other corners are left out, and those
/// with two equal ones make no loops. Of a mesh with more than `kMostTriangles` triangles a vertex
/// a choice of so many distinct ones is taken. Independent of the order of the triangles and of the
/// corner they start with. O(n + t), t log t for the choice. Holds up to 36 bytes a vertex and 48 a
/// triangle, 12 more if there is a choice.
Graph surface_graph(std::span<const Vec3f> positions, std::span<const LocalTriangle> triangles,
                    std::uint32_t first = 0);

/// On a closed surface there are two triangles a vertex; this bounds the memory for any other.
inline constexpr std::size_t kMostTriangles = 3;

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
