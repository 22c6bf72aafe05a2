#include "cluster_simplify/representatives.h"

#include "cluster_simplify/kd_cells.h"
#include "cluster_simplify/nearest.h"
#include "hierarchy/closest_point.h"
#include "hierarchy/triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
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

/// Those of [0, count) that `stays` says yes to. About half of all triangles and vertices are left,
/// which ones no processor can predict: no branch.
template <class Stays>
std::vector<std::uint32_t> left_of(std::uint32_t count, const Stays& stays) {
  std::vector<std::uint32_t> left(count);
  std::size_t left_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    left[left_count] = i;
    left_count += std::size_t{stays(i)};
  }
  left.resize(left_count);
  return left;
}

/// Adds up what the collapses moved the surface, and what joining vertices across gaps adds.
class DeviationSum {
 public:
  DeviationSum(const CollapsedTile& tile, const std::vector<std::uint32_t>& alive,
               const std::vector<std::uint32_t>& into)
      : tile_(tile), into_(into), around_(tile.places.size(), kNowhere) {
    const auto vanished = tile.deviation.vanished();
    lost_.assign(vanished.begin(), vanished.end());
    for (const std::uint32_t t : alive)
      add(t);
  }

  /// `chosen`: the vertices that are representatives.
  Deviation result(const std::vector<std::uint32_t>& chosen) const {
    Deviation deviation;
    deviation.around.reserve(chosen.size());
    deviation.interior = certain(interior_);
    deviation.lost = certain(lost());
    deviation.squared_sum = (tile_.deviation.squared_sum() + stray_squares()) *
                            tile_.frame.to_global(1.0) * tile_.frame.to_global(1.0);
    deviation.weight_sum = tile_.deviation.weight_sum();
    for (const std::uint32_t v : chosen)
      deviation.around.push_back(certain(around_[v]));
    return deviation;
  }

 private:
  static constexpr float kNowhere = -1;  // nothing is drawn at the vertex

  std::uint32_t root(std::uint32_t v) const { return v < into_.size() ? into_[v] : v; }
  Triangle<std::uint32_t> roots(const Triangle<std::uint32_t>& corners) const {
    return {root(corners[0]), root(corners[1]), root(corners[2])};
  }
  static bool is_drawn(const Triangle<std::uint32_t>& roots) { return !is_degenerate(roots); }

  void add(std::uint32_t t) {
    const Triangle<std::uint32_t>& corners = tile_.mesh.faces()[t].corners;
    const Triangle<std::uint32_t> ends = roots(corners);
    if (!is_drawn(ends)) {
      lost_.push_back(
          {{tile_.places[corners[0]], tile_.places[corners[1]], tile_.places[corners[2]]},
           tile_.deviation.of_triangle(t)});
      return;
    }
    float deviation = tile_.deviation.of_triangle(t);
    if (ends != corners)
      deviation += farthest_join(corners, ends);
    bool is_interior = true;
    for (const std::uint32_t v : ends) {
      is_interior = is_interior && v < into_.size();
      around_[v] = std::max(around_[v], deviation);
    }
    if (is_interior)
      interior_ = std::max(interior_, deviation);
  }

  /// How far a triangle's corners went by joining.
  float farthest_join(const Triangle<std::uint32_t>& corners,
                      const Triangle<std::uint32_t>& ends) const {
    float squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f away = tile_.places[ends[k]] - tile_.places[corners[k]];
      squared = std::max(squared, dot(away, away));
    }
    return std::sqrt(squared);
  }

  /// From what is drawn no more to what is drawn around the vertex nearest to it; infinite if there
  /// is none.
  float lost() const {
    if (lost_.empty())
      return 0;
    const std::vector<std::uint32_t> drawn = drawn_vertices();
    if (drawn.empty())
      return std::numeric_limits<float>::infinity();
    const NearestPoints points(tile_.places, drawn);
    double farthest = 0;
    for (const DeviationMeter::Vanished& piece : lost_) {
      const double away = squared_distance_to_star(piece.corners, points.nearest(piece.corners[0]));
      farthest = std::max(farthest, std::sqrt(away) + double{piece.deviation});
    }
    return static_cast<float>(farthest);
  }

  std::vector<std::uint32_t> drawn_vertices() const {
    return left_of(static_cast<std::uint32_t>(around_.size()),
                   [&](std::uint32_t v) { return is_shown(v); });
  }
  bool is_shown(std::uint32_t vertex) const { return around_[vertex] != kNowhere; }

  /// Of vertices that are drawn no more where they were, because all around them vanished or they
  /// were joined with others: weight times squared distance to what is drawn around the one that
  /// stands for them, or nearest to them.
  double stray_squares() const {
    std::vector<DeviationMeter::LostVertex> strays(tile_.deviation.lost_vertices().begin(),
                                                   tile_.deviation.lost_vertices().end());
    double sum = 0;
    for (std::uint32_t v = 0; v < into_.size(); ++v) {
      const float weight = tile_.deviation.weight(v);
      if (into_[v] == kNone || !(weight > 0))
        continue;
      if (!is_shown(into_[into_[v]]))
        strays.push_back({tile_.places[v], weight});
      else if (into_[v] != v)
        sum += square_to_star({tile_.places[v], weight}, into_[into_[v]]);
    }
    return sum + squares_to_nearest(strays);
  }

  double squares_to_nearest(std::span<const DeviationMeter::LostVertex> strays) const {
    if (strays.empty())
      return 0;
    const std::vector<std::uint32_t> drawn = drawn_vertices();
    if (drawn.empty())
      return std::numeric_limits<double>::infinity();
    const NearestPoints points(tile_.places, drawn);
    double sum = 0;
    for (const DeviationMeter::LostVertex& stray : strays)
      sum += square_to_star(stray, points.nearest(stray.position));
    return sum;
  }

  double square_to_star(const DeviationMeter::LostVertex& stray, std::uint32_t vertex) const {
    return double{stray.weight} * squared_distance_to_star(std::span(&stray.position, 1), vertex);
  }

  /// From all of some points to the nearest of the triangles that are drawn around a vertex.
  double squared_distance_to_star(std::span<const Vec3f> from, std::uint32_t vertex) const {
    const auto at = [&](std::uint32_t v) { return to_double(tile_.places[v]); };
    const auto farthest = [&](const TriangleFrame& frame) {
      double most = 0;
      for (const Vec3f point : from)
        most = std::max(most, squared_distance(to_double(point), frame));
      return most;
    };
    double least = farthest({at(vertex), at(vertex), at(vertex)});
    if (tile_.mesh.most_triangles(vertex) > kMostAround)
      return least;
    std::vector<CollapseMesh::Fan> fans;
    tile_.mesh.gather(vertex, fans);
    for (const CollapseMesh::Fan& fan : fans) {
      const Triangle<std::uint32_t> ends = roots({vertex, fan.next, fan.previous});
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
  std::vector<float> around_;               ///< per vertex: the deviation of what is drawn there
  std::vector<DeviationMeter::Vanished> lost_;
  float interior_ = 0;
};

}  // namespace

Contraction choose_representatives(const CollapsedTile& tile, std::uint32_t target) {
  CollapseMesh& mesh = tile.mesh;
  const VertexArray& vertices = tile.vertices;
  const std::span<const CollapseMesh::Face> faces = mesh.faces();
  const std::vector<std::uint32_t> alive =
      left_of(static_cast<std::uint32_t>(faces.size()),
              [&](std::uint32_t t) { return faces[t].is_alive(); });
  std::vector<char> has_triangle(mesh.vertex_count());
  for (const std::uint32_t t : alive) {
    for (const std::uint32_t v : faces[t].corners)
      has_triangle[v] = 1;
  }
  std::vector<std::uint32_t> collapsed_into(mesh.own_count());
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v)
    collapsed_into[v] = mesh.representative(v);
  const std::vector<std::uint32_t> left =
      left_of(mesh.own_count(), [&](std::uint32_t v) { return collapsed_into[v] == v; });
  std::vector<std::uint32_t> shown;
  std::vector<std::uint32_t> isolated;
  shown.reserve(left.size());
  for (const std::uint32_t v : left)
    (has_triangle[v] ? shown : isolated).push_back(v);
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
  std::vector<std::uint32_t> chosen;
  chosen.reserve(target);
  for (const std::uint32_t v : left) {
    if (into[v] != v)
      continue;
    number[v] = static_cast<std::uint32_t>(chosen.size());
    chosen.push_back(v);
  }
  result.representatives.channels = vertices.channels;
  result.representatives.append(vertices, chosen);
  result.parent_of.resize(mesh.own_count());
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    // An isolated vertex may have gone into a shown one that was then joined with another.
    result.parent_of[v] = number[into[into[collapsed_into[v]]]];
  }
  result.deviation = DeviationSum(tile, alive, into).result(chosen);
  return result;
}

}  // namespace meshhier::cluster_simplify
