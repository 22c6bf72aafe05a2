#include "compare/surface_distance.h"

#include "execution/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
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

std::size_t block_count(std::size_t points) {
  return (points + kSearchedPoints - 1) / kSearchedPoints;
}

template <class Element>
std::span<Element> block_of(std::span<Element> all, std::size_t block) {
  const std::size_t first = block * kSearchedPoints;
  return all.subspan(first, std::min(kSearchedPoints, all.size() - first));
}

}  // namespace

double squared_distance(Vec3d p, const Bounds& b) {
  return square(std::max({b.min.x - p.x, 0.0, p.x - b.max.x})) +
         square(std::max({b.min.y - p.y, 0.0, p.y - b.max.y})) +
         square(std::max({b.min.z - p.z, 0.0, p.z - b.max.z}));
}

std::vector<TileQuery> by_tile(std::span<const TileQuery> queries, std::size_t tiles) {
  std::vector<std::size_t> ends(tiles + 1);
  for (const TileQuery& query : queries)
    ++ends[query.tile + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<TileQuery> sorted(queries.size());
  for (const TileQuery& query : queries)
    sorted[ends[query.tile]++] = query;
  return sorted;
}

std::vector<std::shared_ptr<const TriangleSearch>> TreeCache::get(
    std::span<const std::uint32_t> positions) {
  std::vector<std::shared_ptr<const TriangleSearch>> trees(positions.size());
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto found = places_.find(positions[i]);
    if (found == places_.end()) {
      missing.push_back(i);
      continue;
    }
    entries_.splice(entries_.begin(), entries_, found->second);
    trees[i] = found->second->tree;
  }
  execution::parallel_for(missing.size(), [&](std::size_t i) {
    trees[missing[i]] =
        std::make_shared<const TriangleSearch>(surface_.load(positions[missing[i]]).triangles);
  });
  for (std::size_t i : missing)
    insert(positions[i], trees[i]);
  return trees;
}

void TreeCache::insert(std::uint32_t position, std::shared_ptr<const TriangleSearch> tree) {
  was_read_[position] = true;
  used_bytes_ += tree->memory_bytes();
  entries_.push_front({position, std::move(tree)});
  places_[position] = entries_.begin();
  while (used_bytes_ > limit_bytes_ && entries_.size() > 1) {
    used_bytes_ -= entries_.back().tree->memory_bytes();
    places_.erase(entries_.back().position);
    entries_.pop_back();
  }
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
    if (const double gap = squared_gap(box, bounds); gap <= reach)
      found.push_back({gap, static_cast<std::uint32_t>(i)});
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Takes the queries of the next kSearchedTiles tiles away from the front of `queries`. Returns
/// those that are still open: distances found since they were asked may answer them without a tree.
std::vector<SurfaceDistance::Query> SurfaceDistance::take_batch(
    std::span<const Vec3d> points, std::span<const NearestOnSurface> found,
    std::span<const Query>& queries) const {
  std::vector<Query> batch;
  std::size_t tiles = 0, taken = 0;
  for (; taken < queries.size(); ++taken) {
    const Query& query = queries[taken];
    if (taken == 0 || query.tile != queries[taken - 1].tile) {
      if (++tiles > kSearchedTiles)
        break;
    }
    if (squared_distance(points[query.point], surface_.facts(query.tile).bounds) <
        found[query.point].squared)
      batch.push_back(query);
  }
  queries = queries.subspan(taken);
  return batch;
}

/// Answers the queries of a batch. None influences another.
std::vector<NearestOnSurface> SurfaceDistance::answer_batch(std::span<const Vec3d> points,
                                                            std::span<const NearestOnSurface> found,
                                                            std::span<const Query> batch) {
  std::vector<std::uint32_t> tiles;
  for (const Query& query : batch) {
    if (tiles.empty() || tiles.back() != query.tile)
      tiles.push_back(query.tile);
  }
  const auto trees = trees_.get(tiles);
  std::vector<NearestOnSurface> answers(batch.size());
  execution::parallel_for(block_count(batch.size()), [&](std::size_t block) {
    const auto queries = block_of(batch, block);
    const auto results = block_of(std::span(answers), block);
    std::size_t tree = 0;
    std::uint32_t hint = 0;  // the nearest triangle of the query before
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const auto [tile, point] = queries[i];
      if (i == 0 || tile != tiles[tree]) {
        tree = static_cast<std::size_t>(std::lower_bound(tiles.begin(), tiles.end(), tile) -
                                        tiles.begin());
        hint = 0;
      }
      const double squared = trees[tree]->nearest(points[point], found[point].squared, hint);
      results[i] = {squared, tile, hint};
    }
  });
  return answers;
}

/// Lowers found[query.point] to the distance that query.tile has, if that is less.
void SurfaceDistance::answer(std::span<const Vec3d> points, std::span<const Query> queries,
                             std::vector<NearestOnSurface>& found,
                             const execution::CancelToken& cancel) {
  const std::vector<Query> sorted = by_tile(queries, surface_.size());
  for (std::span<const Query> waiting(sorted); !waiting.empty();) {
    cancel.check();
    const std::vector<Query> batch = take_batch(points, found, waiting);
    const std::vector<NearestOnSurface> answers = answer_batch(points, found, batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      NearestOnSurface& nearest = found[batch[i].point];
      if (answers[i].squared < nearest.squared)
        nearest = answers[i];
    }
  }
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
                                                       const execution::CancelToken& cancel) {
  std::vector<NearestOnSurface> found(points.size());
  if (surface_.total().triangles == 0)
    return found;
  std::vector<std::vector<Candidate>> near(block_count(points.size()));
  std::vector<Query> first(points.size());
  execution::parallel_for(near.size(), [&](std::size_t block) {
    near[block] = candidates(block_of(points, block));
    const std::size_t begin = block * kSearchedPoints;
    const std::size_t end = std::min(begin + kSearchedPoints, points.size());
    for (std::size_t i = begin; i < end; ++i)
      first[i] = {likely_tile(points[i], near[block]), static_cast<std::uint32_t>(i)};
  });
  answer(points, first, found, cancel);

  std::vector<Query> more;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const Candidate& candidate : near[i / kSearchedPoints]) {
      // Candidates come by their distance from the whole block: none behind this one is nearer to
      // the point.
      if (candidate.squared >= found[i].squared)
        break;
      if (candidate.tile != first[i].tile &&
          squared_distance(points[i], surface_.facts(candidate.tile).bounds) < found[i].squared)
        more.push_back({candidate.tile, static_cast<std::uint32_t>(i)});
    }
  }
  answer(points, more, found, cancel);
  return found;
}

std::vector<SurfaceTriangle> SurfaceDistance::triangles(std::span<const NearestOnSurface> found,
                                                        const execution::CancelToken& cancel) {
  std::vector<Query> queries;
  for (std::size_t i = 0; i < found.size(); ++i)
    queries.push_back({found[i].tile, static_cast<std::uint32_t>(i)});
  std::vector<SurfaceTriangle> triangles(found.size());
  look_up(trees_, by_tile(queries, surface_.size()), cancel,
          [&](const TriangleSearch& tree, std::size_t, const Query& query) {
            triangles[query.point] = tree[found[query.point].triangle];
          });
  return triangles;
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
