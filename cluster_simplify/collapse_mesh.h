// The connectivity of a joined tile while edges collapse in it.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Triangles, their edges, and the triangles around each vertex, of any mesh at all: edges may have
/// one, two or many triangles, orientations may disagree. Ghosts are vertices like others here; the
/// edges that may collapse are those between two own vertices.
///
/// An edge collapse lets one vertex stand for two: its triangles die, the others follow. All
/// operations cost the number of triangles around the two vertices.
class CollapseMesh {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// A triangle seen from one of its corners.
  struct Fan {
    std::uint32_t triangle;
    std::uint32_t next, previous;            ///< the other corners, in the triangle's order
    std::uint32_t next_edge, previous_edge;  ///< from the corner to them
  };

  struct Edge {
    std::uint32_t a, b;
    std::uint32_t triangle_count;  ///< 0: the edge is gone
  };

  /// O(t) for bounded valences, O(t log t) at worst.
  explicit CollapseMesh(const TileMesh& mesh);

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(first_.size()); }
  std::uint32_t own_count() const { return own_count_; }
  std::span<const Edge> edges() const { return edges_; }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  bool is_own_edge(std::uint32_t e) const {
    return edges_[e].a < own_count_ && edges_[e].b < own_count_;
  }
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }
  /// [t][k]: the edge of triangle t from its corner k to the next.
  std::span<const std::array<std::uint32_t, 3>> triangle_edges() const { return triangle_edges_; }

  /// Whether any triangle is left at the vertex.
  bool is_isolated(std::uint32_t vertex) { return first_live(vertex) == kNone; }
  /// What stands for the vertex now.
  std::uint32_t representative(std::uint32_t vertex);

  /// Collects the triangles around a vertex.
  void gather(std::uint32_t vertex, std::vector<Fan>& fans);

  /// `to` takes over the triangles of `from`; `around_to` and `around_from` as just gathered.
  /// Calls gone(edge) for every edge that vanishes.
  template <class Gone>
  void collapse(std::uint32_t from, std::uint32_t to, std::span<const Fan> around_from,
                std::span<const Fan> around_to, const Gone& gone);

 private:
  std::uint32_t first_live(std::uint32_t vertex);
  void collect_edges();

  std::uint32_t own_count_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;       ///< dead: first corner kNone
  std::vector<std::array<std::uint32_t, 3>> triangle_edges_;  ///< [k]: from corner k to k + 1
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> next_;          ///< a list of corners 3 t + k per vertex
  std::vector<std::uint32_t> first_, last_;  ///< its ends
  std::vector<std::uint32_t> parents_;       ///< which vertex a vertex was collapsed into
  std::vector<std::uint32_t> edge_to_;       ///< scratch: the edge from `to` to a vertex
};

template <class Gone>
void CollapseMesh::collapse(std::uint32_t from, std::uint32_t to, std::span<const Fan> around_from,
                            std::span<const Fan> around_to, const Gone& gone) {
  for (const Fan& fan : around_to) {
    edge_to_[fan.next] = fan.next_edge;
    edge_to_[fan.previous] = fan.previous_edge;
  }
  const auto release = [&](std::uint32_t e) {
    if (--edges_[e].triangle_count == 0)
      gone(e);
  };
  // The edge a triangle that leaves `from` has with one of its other corners from now on.
  const auto moved = [&](std::uint32_t e, std::uint32_t corner) {
    const std::uint32_t known = edge_to_[corner];
    if (known == kNone) {
      Edge& edge = edges_[e];
      (edge.a == from ? edge.a : edge.b) = to;
      edge_to_[corner] = e;
      return e;
    }
    if (known != e) {  // the same edge if another triangle of `from` brought it
      ++edges_[known].triangle_count;
      release(e);
    }
    return known;
  };
  const auto dies = [&](const Fan& fan) { return fan.next == to || fan.previous == to; };
  // What follows comes before what dies: an edge that loses its own triangle may get another.
  for (const Fan& fan : around_from) {
    if (dies(fan))
      continue;
    auto& corners = triangles_[fan.triangle];
    auto& sides = triangle_edges_[fan.triangle];
    const int k = corners[0] == from ? 0 : corners[1] == from ? 1 : 2;
    corners[k] = to;
    sides[k] = moved(fan.next_edge, fan.next);
    sides[(k + 2) % 3] = moved(fan.previous_edge, fan.previous);
  }
  for (const Fan& fan : around_from) {
    if (!dies(fan))
      continue;
    triangles_[fan.triangle][0] = kNone;
    for (const std::uint32_t e : triangle_edges_[fan.triangle])
      release(e);
  }
  for (const auto fans : {around_from, around_to}) {
    for (const Fan& fan : fans)
      edge_to_[fan.next] = edge_to_[fan.previous] = kNone;
  }
  if (first_[from] != kNone) {
    (first_[to] == kNone ? first_[to] : next_[last_[to]]) = first_[from];
    last_[to] = last_[from];
    first_[from] = kNone;
  }
  parents_[from] = to;
}

}  // namespace meshhier::cluster_simplify
