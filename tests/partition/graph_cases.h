// Graphs and counts for tests of graph partitioning.
#pragma once

#include "partition/graph.h"
#include "tests/support/meshes.h"

#include <cstdint>
#include <vector>

namespace meshhier::partition {

using Numbers = std::vector<std::uint32_t>;

inline Surface surface_of(const tests::TestMesh& mesh) {
  return make_surface(mesh.positions, {mesh.triangles.begin(), mesh.triangles.end()});
}

inline Graph graph_of(const tests::TestMesh& mesh) {
  return surface_graph(surface_of(mesh));
}

inline Numbers sizes_of(const Numbers& part_of, std::size_t parts) {
  Numbers sizes(parts);
  for (const std::uint32_t part : part_of)
    ++sizes.at(part);
  return sizes;
}

inline std::int64_t cut_of(const Graph& graph, const Numbers& part_of) {
  std::int64_t cut = 0;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    for (const Graph::Arc& arc : graph.arcs_of(v))
      cut += part_of[v] != part_of[arc.to] ? arc.weight : 0;
  }
  return cut / 2;
}

}  // namespace meshhier::partition
