#include "cluster_simplify/collapse_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace meshhier::cluster_simplify {

CollapseMesh::CollapseMesh(const TileMesh& mesh)
    : own_count_(mesh.own_count),
      stars_(mesh.vertices.size()),
      parents_(mesh.vertices.size()),
      edge_to_(mesh.vertices.size(), kNone) {
  faces_.reserve(mesh.interior.size() + mesh.border.size());
  for (const auto* list : {&mesh.interior, &mesh.border}) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      const Triangle& t = (*list)[i];
      if (i == 0 || t != (*list)[i - 1])  // repeats, one after the other, show nothing more
        faces_.push_back({{raw(t[0]), raw(t[1]), raw(t[2])}, {kNone, kNone, kNone}});
    }
  }
  std::iota(parents_.begin(), parents_.end(), 0U);
  collect_stars();
  collect_edges();
}

void CollapseMesh::collect_stars() {
  for (const Face& face : faces_) {
    for (const std::uint32_t v : face.corners)
      ++stars_[v].count;
  }
  std::uint32_t begin = 0;
  for (Star& star : stars_) {
    star.begin = begin;
    begin += std::exchange(star.count, 0);
  }
  corners_.reserve(begin + begin / 2);  // what is joined on the way to half the vertices
  corners_.resize(begin);
  for (std::uint32_t t = 0; t < faces_.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      Star& star = stars_[faces_[t].corners[k]];
      corners_[star.begin + star.count++] = 4 * t + k;
    }
  }
}

void CollapseMesh::collect_edges() {
  edges_.reserve(faces_.size() * 3 / 2 + 64);
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
    const Star& star = stars_[v];
    for (std::uint32_t i = star.begin; i < star.begin + star.count; ++i) {
      Face& face = faces_[corners_[i] / 4];
      const std::uint32_t k = corners_[i] % 4;
      const std::uint32_t before = k == 0 ? 2 : k - 1;
      meet(face.corners[k == 2 ? 0 : k + 1], face.edges[k]);
      meet(face.corners[before], face.edges[before]);
    }
    for (const std::uint32_t other : met)
      edge_to_[other] = kNone;
    met.clear();
  }
}

bool CollapseMesh::is_isolated(std::uint32_t vertex) {
  Star& star = stars_[vertex];
  while (star.count > 0 && !faces_[corners_[star.begin + star.count - 1] / 4].is_alive())
    --star.count;
  return star.count == 0;
}

std::uint32_t CollapseMesh::representative(std::uint32_t vertex) {
  while (parents_[vertex] != vertex) {
    parents_[vertex] = parents_[parents_[vertex]];
    vertex = parents_[vertex];
  }
  return vertex;
}

void CollapseMesh::gather(std::uint32_t vertex, std::vector<Fan>& fans) {
  Star& star = stars_[vertex];
  fans.resize(star.count);
  std::uint32_t* const corners = corners_.data() + star.begin;
  std::uint32_t alive = 0;
  for (std::uint32_t i = 0; i < star.count; ++i) {
    const std::uint32_t corner = corners[i];
    const Face& face = faces_[corner / 4];
    if (!face.is_alive())
      continue;
    corners[alive] = corner;
    const std::uint32_t k = corner % 4;
    const std::uint32_t after = k == 2 ? 0 : k + 1;
    const std::uint32_t before = k == 0 ? 2 : k - 1;
    fans[alive++] = {corner / 4,        k, face.corners[after], face.corners[before], face.edges[k],
                     face.edges[before]};
  }
  star.count = alive;
  fans.resize(alive);
}

/// Puts the triangles that live on at one vertex, in one run.
void CollapseMesh::join_stars(std::uint32_t from, std::uint32_t to,
                              std::span<const Fan> around_from, std::span<const Fan> around_to) {
  const auto begin = static_cast<std::uint32_t>(corners_.size());
  for (const auto fans : {around_to, around_from}) {
    for (const Fan& fan : fans) {
      if (faces_[fan.triangle].is_alive())
        corners_.push_back(4 * fan.triangle + fan.slot);
    }
  }
  stars_[to] = {begin, static_cast<std::uint32_t>(corners_.size()) - begin};
  stars_[from].count = 0;
}

}  // namespace meshhier::cluster_simplify
