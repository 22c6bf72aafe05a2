#include "cluster_simplify/collapse_mesh.h"

#include <algorithm>
#include <numeric>

namespace meshhier::cluster_simplify {

CollapseMesh::CollapseMesh(const TileMesh& mesh)
    : own_count_(mesh.own_count),
      first_(mesh.vertices.size(), kNone),
      last_(mesh.vertices.size(), kNone),
      parents_(mesh.vertices.size()),
      edge_to_(mesh.vertices.size(), kNone) {
  const std::size_t count = mesh.interior.size() + mesh.border.size();
  triangles_.reserve(count);
  for (const auto* list : {&mesh.interior, &mesh.border}) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      const Triangle& t = (*list)[i];
      if (i == 0 || t != (*list)[i - 1])  // repeats, one after the other, show nothing more
        triangles_.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    }
  }
  next_.assign(3 * triangles_.size(), kNone);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles_[t][k];
      (first_[v] == kNone ? first_[v] : next_[last_[v]]) = 3 * t + k;
      last_[v] = 3 * t + k;
    }
  }
  std::iota(parents_.begin(), parents_.end(), 0U);
  collect_edges();
}

void CollapseMesh::collect_edges() {
  triangle_edges_.assign(triangles_.size(), {kNone, kNone, kNone});
  edges_.reserve(triangles_.size() * 3 / 2 + 64);
  // Edges to vertices of higher number, vertex by vertex; edge_to_ tells those already met.
  std::vector<std::uint32_t> met;
  for (std::uint32_t v = 0; v < vertex_count(); ++v) {
    const auto meet = [&](std::uint32_t other, std::uint32_t& place) {
      if (other <= v)
        return;
      if (edge_to_[other] == kNone) {
        edge_to_[other] = static_cast<std::uint32_t>(edges_.size());
        edges_.push_back({v, other, 0});
        met.push_back(other);
      }
      place = edge_to_[other];
      ++edges_[place].triangle_count;
    };
    for (std::uint32_t corner = first_[v]; corner != kNone; corner = next_[corner]) {
      const std::uint32_t t = corner / 3;
      const std::uint32_t k = corner % 3;
      meet(triangles_[t][(k + 1) % 3], triangle_edges_[t][k]);
      meet(triangles_[t][(k + 2) % 3], triangle_edges_[t][(k + 2) % 3]);
    }
    for (const std::uint32_t other : met)
      edge_to_[other] = kNone;
    met.clear();
  }
}

std::uint32_t CollapseMesh::first_live(std::uint32_t vertex) {
  while (first_[vertex] != kNone && triangles_[first_[vertex] / 3][0] == kNone)
    first_[vertex] = next_[first_[vertex]];
  return first_[vertex];
}

std::uint32_t CollapseMesh::representative(std::uint32_t vertex) {
  while (parents_[vertex] != vertex) {
    parents_[vertex] = parents_[parents_[vertex]];
    vertex = parents_[vertex];
  }
  return vertex;
}

void CollapseMesh::gather(std::uint32_t vertex, std::vector<Fan>& fans) {
  fans.clear();
  std::uint32_t previous = kNone;
  for (std::uint32_t corner = first_[vertex]; corner != kNone; corner = next_[corner]) {
    const std::uint32_t t = corner / 3;
    if (triangles_[t][0] == kNone) {  // dead: leave it out of the list for good
      (previous == kNone ? first_[vertex] : next_[previous]) = next_[corner];
      continue;
    }
    previous = corner;
    const std::uint32_t k = corner - 3 * t;
    const std::uint32_t after = k == 2 ? 0 : k + 1;
    const std::uint32_t before = k == 0 ? 2 : k - 1;
    fans.push_back({t, triangles_[t][after], triangles_[t][before], triangle_edges_[t][k],
                    triangle_edges_[t][before]});
  }
  last_[vertex] = previous;
}

}  // namespace meshhier::cluster_simplify
