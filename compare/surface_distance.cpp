#include "compare/surface_distance.h"

#include "execution/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace meshhier::comparing {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double square(double x) {
  return x * x;
}

/// Returns the square of the largest distance between a point of one box and a point of the other.
double squared_reach(const BoundsD& a, const Bounds& b) {
  return square(std::max(b.max.x - a.min.x, a.max.x - b.min.x)) +
         square(std::max(b.max.y - a.min.y, a.max.y - b.min.y)) +
         square(std::max(b.max.z - a.min.z, a.max.z - b.min.z));
}

double squared_distance_to_middle(Vec3d point, const Bounds& bounds) {
  const Vec3d away = point - (to_double(bounds.min) + to_double(bounds.max)) * 0.5;
  return dot(away, away);
}

/// The nearest triangles of points that are found so far.
class NearestSoFar {
 public:
  using Answer = NearestOnSurface;

  NearestSoFar(const CutSurface& surface, std::span<const Vec3d> points, Ties ties,
               double squared_size, const TakeShown& take)
      : found(points.size()),
        surface_(surface),
        points_(points),
        ties_(ties),
        squared_size_(squared_size),
        take_(take) {}

  /// Equal distances are told apart by the order of tiles, or else not at all.
  bool any_order() const { return ties_ == Ties::first; }
  /// Returns whether a box that is so far from a point may hold what is nearer, or comes before
  /// what is as near.
  bool is_open(std::size_t point, double squared) const {
    return ties_ == Ties::any ? squared < found[point].squared
                              : squared <= with_rounding(found[point].squared, squared_size_);
  }
  bool is_open(const TileQuery& query) const {
    return is_open(query.point,
                   squared_distance(points_[query.point], surface_.facts(query.tile).bounds));
  }
  NearestOnSurface ask(const TileTree& tree, const TileQuery& query, std::uint32_t& hint) const {
    const Vec3d point = points_[query.point];
    const double limit = found[query.point].squared;
    if (ties_ == Ties::any) {
      const double squared = tree.search.nearest(point, limit, hint);
      return {squared, query.tile, hint};
    }
    const NearTriangle first = tree.search.first_nearest(point, limit, hint);
    if (first.triangle != TriangleTree::kNone)
      hint = first.triangle;
    return {first.squared, query.tile, first.triangle};
  }
  void take(const TileTree& tree, const TileQuery& query, const NearestOnSurface& answer) {
    NearestOnSurface& now = found[query.point];
    const auto rank = [](const NearestOnSurface& one) {
      return std::tuple(one.squared, one.tile, one.triangle);
    };
    const bool is_better = ties_ == Ties::any
                               ? answer.squared < now.squared
                               : answer.triangle != TriangleTree::kNone && rank(answer) < rank(now);
    if (!is_better)
      return;
    now = answer;
    if (take_)
      take_(query.point, tree.shown(answer.tile, answer.triangle));
  }

  std::vector<NearestOnSurface> found;

 private:
  const CutSurface& surface_;
  std::span<const Vec3d> points_;
  Ties ties_;
  double squared_size_;
  const TakeShown& take_;
};

}  // namespace

double squared_distance(Vec3d p, const Bounds& b) {
  return square(std::max({b.min.x - p.x, 0.0, p.x - b.max.x})) +
         square(std::max({b.min.y - p.y, 0.0, p.y - b.max.y})) +
         square(std::max({b.min.z - p.z, 0.0, p.z - b.max.z}));
}

/// Returns the tiles that may be nearest to a point of the block. A box has a triangle in it, so
/// the nearest triangle is no farther than the far side of any box: boxes beyond that are left out.
std::vector<SurfaceDistance::Candidate> SurfaceDistance::candidates(
    std::span<const Vec3d> block) const {
  BoundsD box;
  for (Vec3d point : block)
    box.add(point);
  double reach = kFar;
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    if (!surface_.facts(i).bounds.empty())
      reach = std::min(reach, squared_reach(box, surface_.facts(i).bounds));
  }
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    const Bounds& bounds = surface_.facts(i).bounds;
    if (bounds.empty())
      continue;
    if (const double gap = squared_gap(box, bounds); gap <= with_rounding(reach, squared_size_))
      found.push_back({gap, static_cast<std::uint32_t>(i)});
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The tile whose box is nearest to the point; of several (it lies in all of them) the one whose
/// middle is.
std::uint32_t SurfaceDistance::likely_tile(Vec3d point,
                                           std::span<const Candidate> candidates) const {
  std::pair<double, double> least{kFar, kFar};
  std::uint32_t tile = candidates.front().tile;
  for (const Candidate& candidate : candidates) {
    if (candidate.squared > least.first)
      break;
    const Bounds& bounds = surface_.facts(candidate.tile).bounds;
    const std::pair<double, double> now{squared_distance(point, bounds),
                                        squared_distance_to_middle(point, bounds)};
    if (now < least) {
      least = now;
      tile = candidate.tile;
    }
  }
  return tile;
}

/// First each point is looked up in the tile that is nearly always the right one, then in all whose
/// boxes are nearer than what was found there.
std::vector<NearestOnSurface> SurfaceDistance::nearest(std::span<const Vec3d> points,
                                                       const execution::CancelToken& cancel,
                                                       Ties ties, const TakeShown& take) {
  NearestSoFar so_far(surface_, points, ties, squared_size_, take);
  if (surface_.total().triangles == 0)
    return std::move(so_far.found);
  std::vector<TileQuery> first(points.size());
  execution::parallel_for(block_count(points.size()), [&](std::size_t block) {
    const std::vector<Candidate> near = candidates(block_of(points, block));
    for (TileQuery& query : block_of(std::span(first), block)) {
      query.point = static_cast<std::uint32_t>(&query - first.data());
      query.tile = likely_tile(points[query.point], near);
    }
  });
  answer_queries(trees_, first, so_far, cancel);

  const auto others = [&](std::size_t block) {
    const std::vector<Candidate> near = candidates(block_of(points, block));
    std::vector<TileQuery> more;
    for (const TileQuery& asked : block_of(std::span(first), block)) {
      for (const Candidate& candidate : near) {
        // Candidates come by their distance from the whole block: none behind this one is nearer
        // to the point.
        if (!so_far.is_open(asked.point, candidate.squared))
          break;
        const TileQuery query{candidate.tile, asked.point};
        if (candidate.tile != asked.tile && so_far.is_open(query))
          more.push_back(query);
      }
    }
    return more;
  };
  answer_collected(trees_, points.size(), others, so_far, cancel);
  return std::move(so_far.found);
}

std::vector<double> SurfaceDistance::distances(std::span<const Vec3d> points,
                                               const execution::CancelToken& cancel) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const NearestOnSurface& found : nearest(points, cancel))
    distances.push_back(std::sqrt(found.squared));
  return distances;
}

}  // namespace meshhier::comparing
