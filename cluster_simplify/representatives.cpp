#include "cluster_simplify/representatives.h"

#include "base/closest_point.h"
#include "base/widest_corner.h"
#include "cluster_simplify/area_mean.h"
#include "cluster_simplify/kd_cells.h"
#include "cluster_simplify/nearest.h"
#include "hierarchy/triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

constexpr std::uint32_t kNoVertex = CollapseMesh::kNone;

// Larger stars are not looked through for every lost piece beside them, which would take quadratic
// time; their middle is near enough.
constexpr std::uint32_t kMostAroundVertex = 64;

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
  std::vector<std::uint32_t> best(cell_count, kNoVertex);
  std::vector<double> least(cell_count, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const std::uint32_t cell = cell_of[i];
    const Vec3d offset = to_double(positions[i]) - means[cell] * (1 / counts[cell]);
    if (best[cell] == kNoVertex || dot(offset, offset) < least[cell]) {
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

/// Adds up how far the collapses moved the surface, and how far joining across gaps moves it.
class DeviationSum {
 public:
  DeviationSum(const CollapsedTile& tile, const std::vector<std::uint32_t>& alive,
               const std::vector<std::uint32_t>& into)
      : tile_(tile),
        into_(into),
        around_(tile.places.size(), kNowhere),
        squared_sum_(tile.deviation.squared_sum()),
        moved_(tile.places.size()),
        drawn_(over_vertices(), careless()) {
    std::ranges::copy(tile.deviation.moved(), moved_.begin());
    const auto lost = tile.deviation.lost_triangles();
    lost_triangles_.assign(lost.begin(), lost.end());
    for (const std::uint32_t t : alive)
      add(t);
  }

  /// `chosen`: the vertices that are representatives.
  Deviation result(const std::vector<std::uint32_t>& chosen) {
    add_joined();
    const double farthest_lost = measure_lost();
    const double unit = tile_.frame.to_global(1.0);
    Deviation deviation;
    deviation.around.reserve(chosen.size());
    deviation.interior = certain(interior_);
    deviation.lost = certain(static_cast<float>(farthest_lost));
    deviation.mean_square = mean_square() * unit * unit;
    for (const std::uint32_t v : chosen)
      deviation.around.push_back(certain(around_[v]));
    return deviation;
  }

 private:
  using LostTriangle = DeviationMeter::LostTriangle;
  using LostVertex = DeviationMeter::LostVertex;

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
      lost_triangles_.push_back(
          {{tile_.places[corners[0]], tile_.places[corners[1]], tile_.places[corners[2]]},
           tile_.deviation.of_triangle(t)});
      return;
    }
    // A triangle that follows its corners is nowhere farther from where it was than they are.
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
    drawn_.add(double{deviation}, [&] {
      return std::array{tile_.places[ends[0]], tile_.places[ends[1]], tile_.places[ends[2]]};
    });
  }

  /// In the area of the mesh.
  LostArea lost_area(const LostTriangle& lost, double farthest) const {
    const double local = doubled_area(lost.corners[0], lost.corners[1], lost.corners[2]);
    return {tile_.frame.to_global(tile_.frame.to_global(local)), farthest};
  }

  void add_square(std::uint32_t vertex, float weight, double square) {
    squared_sum_ += double{weight} * square;
    moved_[vertex] = std::max(moved_[vertex], std::sqrt(square));
  }
  double over_vertices() const {
    const double whole = tile_.deviation.weight_sum();
    return whole > 0 ? squared_sum_ / whole : 0;
  }
  double careless() const {
    const auto count = static_cast<double>(tile_.fallbacks.torn + tile_.fallbacks.without_care());
    return std::min(1.0, count / std::max(1.0, static_cast<double>(into_.size())));
  }
  /// As large as the vertices, the surface as it was, or as it is drawn have it.
  double mean_square() const {
    const double vertices = over_vertices();
    return std::max(
        {vertices, mean_over_joined(tile_.joined, moved_, lost_areas_, vertices), drawn_.value()});
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

  /// Holds what is drawn no more against what still is, and returns how far the farthest triangle
  /// is from it. Infinite where nothing is drawn.
  double measure_lost() {
    const std::vector<LostVertex> vertices = lost_vertices();
    double farthest = 0;
    if (lost_triangles_.empty() && vertices.empty())
      return farthest;
    const NearestDrawn nearest(tile_.places, drawn_vertices());
    for (const LostTriangle& lost : lost_triangles_) {
      const double away = nearest.from(lost.corners[0], [&](std::uint32_t drawn) {
        return std::sqrt(squared_distance_to_star(lost.corners, drawn)) + double{lost.deviation};
      });
      farthest = std::max(farthest, away);
      lost_areas_.push_back(lost_area(lost, away));
    }
    for (const LostVertex& lost : vertices) {
      add_square(lost.vertex, lost.weight, nearest.from(lost.position, [&](std::uint32_t drawn) {
        return square_to_star(lost.position, drawn);
      }));
    }
    return farthest;
  }

  std::vector<std::uint32_t> drawn_vertices() const {
    return left_of(static_cast<std::uint32_t>(around_.size()),
                   [&](std::uint32_t v) { return is_shown(v); });
  }
  bool is_shown(std::uint32_t vertex) const { return around_[vertex] != kNowhere; }

  /// Calls visit(vertex, weight, the one that stands for it) for each that stands for others or
  /// itself.
  template <class Visit>
  void for_each_weight(const Visit& visit) const {
    for (std::uint32_t v = 0; v < into_.size(); ++v) {
      const float weight = tile_.deviation.weight(v);
      if (into_[v] != kNoVertex && weight > 0)
        visit(v, weight, into_[into_[v]]);
    }
  }

  /// Those around which all was lost, and those whose representative is not drawn.
  std::vector<LostVertex> lost_vertices() const {
    const auto known = tile_.deviation.lost_vertices();
    std::vector<LostVertex> lost(known.begin(), known.end());
    for_each_weight([&](std::uint32_t v, float weight, std::uint32_t representative) {
      if (!is_shown(representative))
        lost.push_back({v, tile_.places[v], weight});
    });
    return lost;
  }

  /// Counts vertices that were joined with others by their distance from what is drawn around the
  /// one that stands for them.
  void add_joined() {
    for_each_weight([&](std::uint32_t v, float weight, std::uint32_t representative) {
      if (is_shown(representative) && into_[v] != v)
        add_square(v, weight, square_to_star(tile_.places[v], representative));
    });
  }

  double square_to_star(Vec3f from, std::uint32_t vertex) const {
    return squared_distance_to_star(std::span(&from, 1), vertex);
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
    if (tile_.mesh.most_triangles(vertex) > kMostAroundVertex)
      return least;
    std::vector<CollapseMesh::Fan> room;
    for (const CollapseMesh::Fan& fan : tile_.mesh.star_of(vertex, room)) {
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
  std::vector<LostTriangle> lost_triangles_;
  std::vector<LostArea> lost_areas_;
  float interior_ = 0;
  double squared_sum_;         ///< over vertices: weight times squared distance
  std::vector<double> moved_;  ///< per vertex; ghosts: 0
  DrawnMean drawn_;
};

/// Own vertices that are left after the collapses, ascending, all and by whether they show
/// anything.
struct LeftVertices {
  std::vector<std::uint32_t> all, shown, isolated;
};

LeftVertices left_vertices(CollapseMesh& mesh, const std::vector<std::uint32_t>& alive) {
  std::vector<char> has_triangle(mesh.vertex_count());
  for (const std::uint32_t t : alive) {
    for (const std::uint32_t v : mesh.faces()[t].corners)
      has_triangle[v] = 1;
  }
  LeftVertices left;
  left.all =
      left_of(mesh.own_count(), [&](std::uint32_t v) { return mesh.representative(v) == v; });
  left.shown.reserve(left.all.size());
  for (const std::uint32_t v : left.all)
    (has_triangle[v] ? left.shown : left.isolated).push_back(v);
  return left;
}

/// Where those that are left go: into themselves or others.
class Joins {
 public:
  Joins(const VertexArray& vertices, std::uint32_t own_count)
      : vertices_(vertices), into_(own_count, kNoVertex) {}

  /// Returns how many were joined because there is no room for more than `target`.
  std::uint32_t join_shown(const std::vector<std::uint32_t>& shown, std::uint32_t target) {
    if (shown.size() <= target) {
      absorb(shown, shown);
      return 0;
    }
    absorb(shown, join_neighbours(vertices_, shown, target));
    return static_cast<std::uint32_t>(shown.size()) - target;
  }

  void join_isolated(const LeftVertices& left, std::uint32_t target) {
    if (left.isolated.empty())
      return;
    std::vector<std::uint32_t> kept;
    if (left.shown.size() < target) {
      kept = join_neighbours(vertices_, left.isolated,
                             target - static_cast<std::uint32_t>(left.shown.size()));
    }
    std::vector<std::uint32_t> around = left.shown;
    around.insert(around.end(), kept.begin(), kept.end());
    absorb(left.isolated, nearest_of(vertices_.positions, around, left.isolated));
    absorb(kept, kept);  // whatever lies at the same point
  }

  const std::vector<std::uint32_t>& into() const { return into_; }

 private:
  void absorb(const std::vector<std::uint32_t>& group, const std::vector<std::uint32_t>& targets) {
    for (std::size_t i = 0; i < group.size(); ++i)
      into_[group[i]] = targets[i];
  }

  const VertexArray& vertices_;
  std::vector<std::uint32_t> into_;  ///< kNoVertex: of those that collapsed
};

/// For each own vertex the place among `chosen` of the one that stands for it.
std::vector<std::uint32_t> parents_of(CollapseMesh& mesh, const std::vector<std::uint32_t>& into,
                                      const std::vector<std::uint32_t>& chosen) {
  std::vector<std::uint32_t> number(mesh.own_count(), kNoVertex);
  for (std::uint32_t i = 0; i < chosen.size(); ++i)
    number[chosen[i]] = i;
  std::vector<std::uint32_t> parents(mesh.own_count());
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    // An isolated vertex may have gone into a shown one that was then joined with another.
    parents[v] = number[into[into[mesh.representative(v)]]];
  }
  return parents;
}

}  // namespace

Contraction choose_representatives(const CollapsedTile& tile, std::uint32_t target) {
  const std::span<const CollapseMesh::Face> faces = tile.mesh.faces();
  const std::vector<std::uint32_t> alive =
      left_of(static_cast<std::uint32_t>(faces.size()),
              [&](std::uint32_t t) { return faces[t].is_alive(); });
  const LeftVertices left = left_vertices(tile.mesh, alive);
  Joins joins(tile.vertices, tile.mesh.own_count());
  Contraction result;
  result.fallbacks.joined = joins.join_shown(left.shown, target);
  joins.join_isolated(left, target);
  const std::vector<std::uint32_t>& into = joins.into();
  std::vector<std::uint32_t> chosen;
  chosen.reserve(target);
  std::copy_if(left.all.begin(), left.all.end(), std::back_inserter(chosen),
               [&](std::uint32_t v) { return into[v] == v; });
  result.representatives.channels = tile.vertices.channels;
  result.representatives.append(tile.vertices, chosen);
  result.parent_of = parents_of(tile.mesh, into, chosen);
  result.deviation = DeviationSum(tile, alive, into).result(chosen);
  return result;
}

}  // namespace meshhier::cluster_simplify
