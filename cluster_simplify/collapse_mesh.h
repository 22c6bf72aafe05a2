// The connectivity of a joined tile while edges collapse in it.
//
//      faces_[t]     corners, edges; edge k runs from corner k to the next one
//      edges_[e]     ends a, b, and how many triangles have it
//      stars_[v]     a run of corners_: each entry 4 t + k, triangle t's corner k is at v
//
//      collapse of `from` into `to`:
//
//              p                      p
//            / | \                  / |             triangles at the edge die; their other two
//           / dies \               /  |             edges become one: p-from is gone, p-to stays
//      ---from -----to---   ->    --- to ---
//           \ dies /               \  |             all others of `from` follow: corner and edges
//            \ | /                  \ |             are renamed, edges that meet are merged
//              q                      q
//
// Invariants. An edge's triangle_count is the number of living triangles that have it; a star's run
// holds all living corners at its vertex, and dead ones until it is next looked at, so a count is
// an upper bound. parents_ leads from a vertex to the one that stands for it (union by collapse,
// with path halving). edge_to_ is kNone everywhere between collapses.
//
// Memory. Stars that join are appended to corners_; when it is twice as long as at first, the runs
// in use move together (make_room()).
#pragma once

#include "base/bounds.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/triangle.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

class EdgeStar;

/// Triangles, their edges, and the triangles around each vertex, of any mesh at all: edges may have
/// one, two or many triangles, orientations may disagree. Ghosts are vertices like others here; the
/// edges that may collapse are those between two own vertices.
///
/// An edge collapse lets one vertex stand for two: its triangles die, the others follow. All
/// operations cost the number of triangles around the two vertices.
class CollapseMesh {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// The next and the previous of a triangle's corners 0, 1, 2: two bits each, since asking which
  /// is guessed wrong every third time.
  static constexpr std::uint32_t after(std::uint32_t corner) {
    return 0b00'10'01U >> 2 * corner & 3;
  }
  static constexpr std::uint32_t before(std::uint32_t corner) {
    return 0b01'00'10U >> 2 * corner & 3;
  }

  /// A triangle and its edges, [k]: from corner k to the next. Dead ones have no first corner.
  struct Face {
    Triangle<std::uint32_t> corners;
    std::array<std::uint32_t, 3> edges;
    bool is_alive() const { return corners[0] != kNone; }
  };

  /// A triangle seen from one of its corners.
  struct Fan {
    std::uint32_t triangle;
    std::uint32_t slot;                      ///< which of its corners
    std::uint32_t next, previous;            ///< the other corners, in the triangle's order
    std::uint32_t next_edge, previous_edge;  ///< from the corner to them

    bool is_at(std::uint32_t vertex) const { return next == vertex || previous == vertex; }
    std::uint32_t corner() const { return 4 * triangle + slot; }
  };

  struct Edge {
    std::uint32_t a, b;
    std::uint32_t triangle_count;  ///< 0: the edge is gone
  };

  /// O(t) for bounded valences, O(t log t) at worst.
  explicit CollapseMesh(const TileMesh& mesh);

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(stars_.size()); }
  std::uint32_t own_count() const { return own_count_; }
  std::span<const Edge> edges() const { return edges_; }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  bool is_own_edge(std::uint32_t e) const {
    return edges_[e].a < own_count_ && edges_[e].b < own_count_;
  }
  std::span<const Face> faces() const { return faces_; }

  /// No more triangles are left at the vertex; before the first collapse, just as many.
  std::uint32_t most_triangles(std::uint32_t vertex) const { return stars_[vertex].count; }
  /// Whether there are too many triangles at the vertex to go through them for every collapse
  /// beside it: n of them would take n squared. Scans stay below a tenth of the limit.
  bool has_high_valence(std::uint32_t vertex) const { return stars_[vertex].count > kHighValence; }
  /// Whether any triangle is left at the vertex.
  bool is_isolated(std::uint32_t vertex);
  /// Returns the vertex that stands for this one now. Shortens the way for the next call.
  std::uint32_t representative(std::uint32_t vertex) {
    while (parents_[vertex] != vertex) {
      parents_[vertex] = parents_[parents_[vertex]];
      vertex = parents_[vertex];
    }
    return vertex;
  }

  /// Asks for the memory that star_of() will look at: first the star, later its faces, or as many
  /// as most vertices have.
  void fetch_edge(std::uint32_t e) const { __builtin_prefetch(&edges_[e]); }
  void fetch_star(std::uint32_t vertex) const {
    __builtin_prefetch(corners_.data() + stars_[vertex].begin);
  }
  void fetch_faces(std::uint32_t vertex) const {
    const Star star = stars_[vertex];
    for (std::uint32_t i = 0; i < std::min(star.count, kMostFetched); ++i) {
      const Face& face = faces_[corners_[star.begin + i] / 4];
      __builtin_prefetch(&face);
      __builtin_prefetch(&face.edges[2]);  // a fourth of them lie in two cache lines
    }
  }

  /// Collects the triangles around a vertex at the beginning of `room`, which grows if it must.
  std::span<const Fan> star_of(std::uint32_t vertex, std::vector<Fan>& room);
  void gather(std::uint32_t vertex, std::vector<Fan>& fans) {
    fans.resize(star_of(vertex, fans).size());
  }

  /// `to` takes over the triangles of `from`; `around_to` and `around_from` as just gathered.
  /// Calls gone(edge) for every edge that vanishes.
  template <class Gone>
  void collapse(std::uint32_t from, std::uint32_t to, std::span<const Fan> around_from,
                std::span<const Fan> around_to, const Gone& gone);

  /// The same where the edge's star is a disc. Returns the edges that vanish.
  std::array<std::uint32_t, 3> collapse_disc(const EdgeStar& star);

 private:
  static constexpr std::uint32_t kMostFetched = 16;
  static constexpr std::uint32_t kHighValence = 1024;

  /// The corners, 4 t + k, at a vertex: a run of corners_, dead ones among them until next looked
  /// at.
  struct Star {
    std::uint32_t begin = 0, count = 0;
  };

  void collect_stars();
  void collect_edges();
  void make_room(std::size_t count);
  void join_stars(std::uint32_t from, std::uint32_t to, std::span<const Fan> around_from,
                  std::span<const Fan> around_to);

  std::uint32_t own_count_;
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
  std::vector<Star> stars_;
  std::vector<std::uint32_t> corners_;  ///< grows by the joined stars, up to make_room()
  std::vector<std::uint32_t> parents_;  ///< which vertex a vertex was collapsed into
  std::vector<std::uint32_t> edge_to_;  ///< scratch: the edge from `to` to a vertex
};

using Fans = std::span<const CollapseMesh::Fan>;

/// Whether every triangle has that corner, too.
inline bool all_at(Fans fans, std::uint32_t vertex) {
  return std::all_of(fans.begin(), fans.end(),
                     [&](const CollapseMesh::Fan& fan) { return fan.is_at(vertex); });
}

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
  // Triangles that move come before those that die: an edge that loses one may get another.
  for (const Fan& fan : around_from) {
    if (fan.is_at(to))
      continue;
    Face& face = faces_[fan.triangle];
    face.corners[fan.slot] = to;
    face.edges[fan.slot] = moved(fan.next_edge, fan.next);
    face.edges[before(fan.slot)] = moved(fan.previous_edge, fan.previous);
  }
  for (const Fan& fan : around_from) {
    if (!fan.is_at(to))
      continue;
    faces_[fan.triangle].corners[0] = kNone;
    for (const std::uint32_t e : faces_[fan.triangle].edges)
      release(e);
  }
  for (const auto fans : {around_from, around_to}) {
    for (const Fan& fan : fans)
      edge_to_[fan.next] = edge_to_[fan.previous] = kNone;
  }
  join_stars(from, to, around_from, around_to);
  parents_[from] = to;
}

/// The box of the vertices that have triangles, before the first collapse; may be empty. O(n).
Bounds surface_bounds(const CollapseMesh& mesh, std::span<const Vec3f> positions);

}  // namespace meshhier::cluster_simplify
