#include "cluster_simplify/representatives.h"

#include "cluster_simplify/closest_point.h"
#include "cluster_simplify/kd_cells.h"
#include "cluster_simplify/nearest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

constexpr std::uint32_t kNone = CollapseMesh::kNone;

// Larger stars are not looked through for every lost piece beside them, which would take quadratic
// time; their middle is near enough.
constexpr std::uint32_t kMostAround = 64;

std::vector<Vec3f> positions_of(const VertexArray& vertices,
                                const std::vector<std::uint32_t>& chosen) {
  std::vector<Vec3f> positions;
  positions.reserve(chosen.size());
  for (const std::uint32_t v : chosen)
    positions.push_back(vertices.positions[v]);
  return positions;
}

/// For each of `group` the one of its cell that is nearest to the cell's mean.
std::vector<std::uint32_t> join_neighbours(const VertexArray& vertices,
                                           const std::vector<std::uint32_t>& group,
                                           std::uint32_t cell_count) {
  const std::vector<Vec3f> positions = positions_of(vertices, group);
  const std::vector<std::uint32_t> cell_of = kd_cells(positions, cell_count);
  std::vector<Vec3d> means(cell_count);
  std::vector<double> counts(cell_count);
  for (std::size_t i = 0; i < group.size(); ++i) {
    means[cell_of[i]] = means[cell_of[i]] + to_double(positions[i]);
    ++counts[cell_of[i]];
  }
  std::vector<std::uint32_t> best(cell_count, kNone);
  std::vector<double> least(cell_count, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const std::uint32_t cell = cell_of[i];
    const Vec3d offset = to_double(positions[i]) - means[cell] * (1 / counts[cell]);
    if (best[cell] == kNone || dot(offset, offset) < least[cell]) {
      best[cell] = group[i];
      least[cell] = dot(offset, offset);
    }
  }
  std::vector<std::uint32_t> into(group.size());
  for (std::size_t i = 0; i < group.size(); ++i)
    into[i] = best[cell_of[i]];
  return into;
}

/// Adds up what the collapses moved the surface, and what joining vertices across gaps adds.
class DriftSum {
 public:
  DriftSum(const CollapsedTile& tile, const std::vector<std::uint32_t>& into)
      : tile_(tile), into_(into), around_(tile.mesh.own_count()), drawn_(tile.places.size()) {
    const auto vanished = tile.drift.vanished();
    lost_.assign(vanished.begin(), vanished.end());
    for (std::uint32_t t = 0; t < tile.mesh.faces().size(); ++t) {
      if (tile.mesh.faces()[t].is_alive())
        add(t);
    }
  }

  /// `number`: of a representative, by its vertex.
  Drift result(const std::vector<std::uint32_t>& number, std::size_t count) {
    Drift drift;
    drift.around.resize(count);
    drift.interior = certain(interior_);
    drift.lost = certain(lost());
    drift.squared_sum =
        tile_.drift.squared_sum() * tile_.frame.to_global(1.0) * tile_.frame.to_global(1.0);
    for (std::uint32_t v = 0; v < around_.size(); ++v) {
      if (number[v] != kNone)
        drift.around[number[v]] = certain(around_[v]);
    }
    return drift;
  }

 private:
  using Corners = std::array<std::uint32_t, 3>;

  std::uint32_t root(std::uint32_t v) const { return v < into_.size() ? into_[v] : v; }
  Corners roots(const Corners& corners) const {
    return {root(corners[0]), root(corners[1]), root(corners[2])};
  }
  static bool is_drawn(const Corners& roots) {
    return roots[0] != roots[1] && roots[1] != roots[2] && roots[2] != roots[0];
  }

  void add(std::uint32_t t) {
    const Corners& corners = tile_.mesh.faces()[t].corners;
    const Corners ends = roots(corners);
    if (!is_drawn(ends)) {
      lost_.push_back(
          {{tile_.places[corners[0]], tile_.places[corners[1]], tile_.places[corners[2]]},
           tile_.drift.of_triangle(t)});
      return;
    }
    float joined = 0;  // squared: how far its corners went by joining
    for (std::size_t k = 0; k < 3; ++k) {
      if (ends[k] != corners[k]) {
        const Vec3f away = tile_.places[ends[k]] - tile_.places[corners[k]];
        joined = std::max(joined, dot(away, away));
      }
    }
    const float drift = tile_.drift.of_triangle(t) + std::sqrt(joined);
    bool is_interior = true;
    for (const std::uint32_t v : ends) {
      is_interior = is_interior && v < around_.size();
      drawn_[v] = 1;
      if (v < around_.size())
        around_[v] = std::max(around_[v], drift);
    }
    if (is_interior)
      interior_ = std::max(interior_, drift);
  }

  /// From what is drawn no more to what is drawn around the vertex nearest to it; infinite if there
  /// is none.
  float lost() const {
    if (lost_.empty())
      return 0;
    std::vector<std::uint32_t> drawn;
    for (std::uint32_t v = 0; v < drawn_.size(); ++v) {
      if (drawn_[v])
        drawn.push_back(v);
    }
    if (drawn.empty())
      return std::numeric_limits<float>::infinity();
    std::vector<Vec3f> positions(tile_.places.begin(), tile_.places.end());
    std::vector<std::uint32_t> asked;
    for (const DriftMeter::Vanished& piece : lost_) {
      asked.push_back(static_cast<std::uint32_t>(positions.size()));
      positions.push_back(piece.corners[0]);
    }
    const std::vector<std::uint32_t> nearest = nearest_of(positions, drawn, asked);
    double farthest = 0;
    for (std::size_t i = 0; i < lost_.size(); ++i) {
      farthest = std::max(farthest, std::sqrt(squared_distance_to_star(lost_[i], nearest[i])) +
                                        double{lost_[i].drift});
    }
    return static_cast<float>(farthest);
  }

  /// From all of a triangle to the nearest of those that are drawn around a vertex.
  double squared_distance_to_star(const DriftMeter::Vanished& piece, std::uint32_t vertex) const {
    const auto at = [&](std::uint32_t v) { return to_double(tile_.places[v]); };
    const auto farthest = [&](const TriangleFrame& frame) {
      double most = 0;
      for (const Vec3f corner : piece.corners)
        most = std::max(most, squared_distance(to_double(corner), frame));
      return most;
    };
    double least = farthest({at(vertex), at(vertex), at(vertex)});
    if (tile_.mesh.most_triangles(vertex) > kMostAround)
      return least;
    std::vector<CollapseMesh::Fan> fans;
    tile_.mesh.gather(vertex, fans);
    for (const CollapseMesh::Fan& fan : fans) {
      const Corners ends = roots({vertex, fan.next, fan.previous});
      if (is_drawn(ends))
        least = std::min(least, farthest({at(ends[0]), at(ends[1]), at(ends[2])}));
    }
    return least;
  }

  /// In the coordinates of the mesh, rounding counted.
  float certain(float local) const {
    if (!(local > 0))
      return 0;
    return static_cast<float>((tile_.frame.to_global(double{local}) + tile_.frame.rounding()) *
                              (1 + 0x1p-20));
  }

  const CollapsedTile& tile_;
  const std::vector<std::uint32_t>& into_;  ///< own vertex -> the one it was joined with, or itself
  std::vector<float> around_;
  std::vector<char> drawn_;
  std::vector<DriftMeter::Vanished> lost_;
  float interior_ = 0;
};

}  // namespace

Contraction choose_representatives(const CollapsedTile& tile, std::uint32_t target) {
  CollapseMesh& mesh = tile.mesh;
  const VertexArray& vertices = tile.vertices;
  std::vector<char> has_triangle(mesh.vertex_count());
  for (const CollapseMesh::Face& face : mesh.faces()) {
    if (face.is_alive()) {
      for (const std::uint32_t v : face.corners)
        has_triangle[v] = 1;
    }
  }
  std::vector<std::uint32_t> shown;
  std::vector<std::uint32_t> isolated;
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    if (mesh.representative(v) == v)
      (has_triangle[v] ? shown : isolated).push_back(v);
  }
  std::vector<std::uint32_t> into(mesh.own_count(), kNone);
  const auto absorb = [&](const std::vector<std::uint32_t>& group,
                          const std::vector<std::uint32_t>& targets) {
    for (std::size_t i = 0; i < group.size(); ++i)
      into[group[i]] = targets[i];
  };
  Contraction result;
  if (shown.size() > target) {
    result.fallbacks.joined = static_cast<std::uint32_t>(shown.size()) - target;
    absorb(shown, join_neighbours(vertices, shown, target));
  } else {
    absorb(shown, shown);
  }
  const std::uint32_t room = target - std::min(target, static_cast<std::uint32_t>(shown.size()));
  if (!isolated.empty()) {
    std::vector<std::uint32_t> kept;
    if (room > 0)
      kept = join_neighbours(vertices, isolated, room);
    std::vector<std::uint32_t> around = shown;
    around.insert(around.end(), kept.begin(), kept.end());
    absorb(isolated, nearest_of(vertices.positions, around, isolated));
    absorb(kept, kept);  // whatever lies at the same point
  }

  std::vector<std::uint32_t> number(mesh.own_count(), kNone);
  result.representatives.channels = vertices.channels;
  result.representatives.reserve(target);
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    if (into[v] != v)
      continue;
    number[v] = static_cast<std::uint32_t>(result.representatives.size());
    result.representatives.append(vertices, v, v + 1);
  }
  result.parent_of.resize(mesh.own_count());
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    // An isolated vertex may have gone into a shown one that was then joined with another.
    std::uint32_t root = into[mesh.representative(v)];
    root = into[root];
    result.parent_of[v] = number[root];
  }
  result.drift = DriftSum(tile, into).result(number, result.representatives.size());
  return result;
}

}  // namespace meshhier::cluster_simplify
