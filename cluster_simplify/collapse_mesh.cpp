#include "cluster_simplify/collapse_mesh.h"

#include "cluster_simplify/edge_star.h"

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
      const TileTriangle& t = (*list)[i];
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
  corners_.reserve(2 * std::size_t{begin});  // as much as make_room() lets it grow to
  corners_.resize(begin);
  for (std::uint32_t t = 0; t < faces_.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      Star& star = stars_[faces_[t].corners[k]];
      corners_[star.begin + star.count++] = 4 * t + k;
    }
  }
}

void CollapseMesh::collect_edges() {
  // The stars have the sides of all triangles by the lower of their ends, in the triangles' order.
  // Which sides meet cannot be guessed, so that it is not asked: every side writes its edge.
  struct Met {
    std::uint32_t low, edge;
  };
  std::vector<Met> last_met(vertex_count(), {kNone, 0});  // by its higher end
  edges_.resize(3 * faces_.size() + 1);                   // and where the next one would be
  std::uint32_t count = 0;
  for (std::uint32_t low = 0; low < stars_.size(); ++low) {
    const auto meet = [&](std::uint32_t high, std::uint32_t& edge_of_side, bool is_side) {
      Met& met = last_met[high];
      const bool is_new = is_side & (met.low != low);
      const std::uint32_t e = is_new ? count : met.edge;
      edges_[count] = {low, high, 0};
      edges_[e].triangle_count += std::uint32_t{is_side};
      count += std::uint32_t{is_new};
      met = {is_side ? low : met.low, e};
      edge_of_side = is_side ? e : edge_of_side;
    };
    const Star star = stars_[low];
    for (std::uint32_t i = star.begin; i < star.begin + star.count; ++i) {
      Face& face = faces_[corners_[i] / 4];
      const std::uint32_t k = corners_[i] % 4;
      const std::uint32_t next = face.corners[after(k)];
      const std::uint32_t previous = face.corners[before(k)];
      const bool has_next = next >= low;  // one side of a corner that is there twice
      const bool has_previous = previous > low;
      // Most triangles begin with their smallest corner and are sorted by it: those come last.
      if (!(has_next & has_previous)) {
        meet(has_next ? next : previous, face.edges[has_next ? k : before(k)],
             has_next | has_previous);
      } else if (k == 0) {
        meet(next, face.edges[0], true);
        meet(previous, face.edges[2], true);
      } else {
        meet(previous, face.edges[before(k)], true);
        meet(next, face.edges[k], true);
      }
    }
  }
  edges_.resize(count);
}

bool CollapseMesh::is_isolated(std::uint32_t vertex) {
  Star& star = stars_[vertex];
  while (star.count > 0 && !faces_[corners_[star.begin + star.count - 1] / 4].is_alive())
    --star.count;
  return star.count == 0;
}

std::span<const CollapseMesh::Fan> CollapseMesh::star_of(std::uint32_t vertex,
                                                         std::vector<Fan>& room) {
  Star& star = stars_[vertex];
  if (room.size() < star.count)
    room.resize(star.count);
  Fan* const fans = room.data();
  std::uint32_t* const corners = corners_.data() + star.begin;
  std::uint32_t alive = 0;
  for (std::uint32_t i = 0; i < star.count; ++i) {
    const std::uint32_t corner = corners[i];
    const Face& face = faces_[corner / 4];
    const std::uint32_t k = corner % 4;
    // Dead ones are overwritten by the next: there is no guessing which these are.
    corners[alive] = corner;
    fans[alive] = {
        corner / 4,           k, face.corners[after(k)], face.corners[before(k)], face.edges[k],
        face.edges[before(k)]};
    alive += static_cast<std::uint32_t>(face.is_alive());
  }
  star.count = alive;
  return {fans, alive};
}

std::array<std::uint32_t, 3> CollapseMesh::collapse_disc(const EdgeStar& star) {
  const auto links = star.links();
  const auto [first, last] = star.at_edge();
  const std::uint32_t turn = star.to_begin();
  for (const Fan* fan : star.at_edge())
    faces_[fan->triangle].corners[0] = kNone;
  for (std::uint32_t i = 0; i < turn; ++i) {
    faces_[links[i]->triangle].corners[links[i]->slot] = star.to();
    if (i == 0)
      continue;
    Edge& edge = edges_[links[i]->next_edge];
    (edge.a == star.from() ? edge.a : edge.b) = star.to();
  }
  // At the first and the last ring vertex of `from` there is an edge to `to` already: it takes the
  // place of the one to `from`, which dies. Its triangle count stays, one triangle for another.
  const Fan& begin = *links[0];
  const Fan& end = *links[turn - 1];
  faces_[begin.triangle].edges[begin.slot] = links[star.size() - 1]->previous_edge;
  faces_[end.triangle].edges[before(end.slot)] = links[turn]->next_edge;
  const std::array gone{first->next_edge, first->previous_edge, last->next_edge};
  for (const std::uint32_t e : gone)
    edges_[e].triangle_count = 0;

  stars_[star.from()].count = 0;
  make_room(star.size());
  stars_[star.to()] = {static_cast<std::uint32_t>(corners_.size()), star.size()};
  for (const Fan* fan : links)
    corners_.push_back(fan->corner());
  parents_[star.from()] = star.to();
  return gone;
}

/// Stars that were joined leave their old runs behind. Once these are as much as all stars were at
/// first, the runs in use are moved together: around a vertex of very many triangles each collapse
/// would leave as many behind.
void CollapseMesh::make_room(std::size_t count) {
  if (corners_.size() + count <= 2 * 3 * faces_.size())
    return;
  std::vector<std::uint32_t> packed;
  packed.reserve(corners_.size());
  for (Star& star : stars_) {
    const auto begin = corners_.begin() + star.begin;
    star.begin = static_cast<std::uint32_t>(packed.size());
    packed.insert(packed.end(), begin, begin + star.count);
  }
  corners_ = std::move(packed);
}

/// Puts the triangles that live on at one vertex, in one run.
void CollapseMesh::join_stars(std::uint32_t from, std::uint32_t to,
                              std::span<const Fan> around_from, std::span<const Fan> around_to) {
  make_room(around_from.size() + around_to.size());
  const auto begin = static_cast<std::uint32_t>(corners_.size());
  for (const auto fans : {around_to, around_from}) {
    for (const Fan& fan : fans) {
      if (faces_[fan.triangle].is_alive())
        corners_.push_back(fan.corner());
    }
  }
  stars_[to] = {begin, static_cast<std::uint32_t>(corners_.size()) - begin};
  stars_[from].count = 0;
}

Bounds surface_bounds(const CollapseMesh& mesh, std::span<const Vec3f> positions) {
  Bounds bounds;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.most_triangles(v) > 0)
      bounds.add(positions[v]);
  }
  return bounds;
}

}  // namespace meshhier::cluster_simplify
