#include "cluster_simplify/nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

// Points, or boxes, of one box: five levels for the 16,384 vertices of a joined tile.
constexpr std::size_t kRun = 8;

std::size_t run_count(std::size_t count) {
  return (count + kRun - 1) / kRun;
}

double squared_distance(Vec3f point, Vec3d asked) {
  const Vec3d away = to_double(point) - asked;
  return dot(away, away);
}

/// Never more than that of a point inside, rounding and all: it takes the same steps.
double squared_distance_to_box(const Bounds& box, Vec3d asked) {
  const Vec3d below = to_double(box.min) - asked;
  const Vec3d above = asked - to_double(box.max);
  const Vec3d away{std::max({below.x, above.x, 0.0}), std::max({below.y, above.y, 0.0}),
                   std::max({below.z, above.z, 0.0})};
  return dot(away, away);
}

}  // namespace

struct NearestPoints::Search {
  Vec3d asked;
  double least;  ///< only what is nearer is of interest
  std::size_t best = 0;
};

NearestPoints::NearestPoints(std::span<const Vec3f> positions,
                             std::span<const std::uint32_t> candidates)
    : candidates_(candidates.begin(), candidates.end()), points_(candidates.size()) {
  std::transform(candidates.begin(), candidates.end(), points_.begin(),
                 [&](std::uint32_t v) { return positions[v]; });
  std::vector<Bounds>& finest = levels_.emplace_back(run_count(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i)
    finest[i / kRun].add(points_[i]);
  while (levels_.back().size() > 1) {
    const std::vector<Bounds>& finer = levels_.back();
    std::vector<Bounds> coarser(run_count(finer.size()));
    for (std::size_t i = 0; i < finer.size(); ++i)
      coarser[i / kRun].add(finer[i]);
    levels_.push_back(std::move(coarser));
  }
}

/// Down to the nearest box of each level, and the nearest point in there.
double NearestPoints::some_distance(Vec3d asked) const {
  std::size_t best = 0;
  for (std::size_t level = levels_.size() - 1; level-- > 0;) {
    const std::vector<Bounds>& boxes = levels_[level];
    const std::size_t begin = best * kRun;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = begin; i < std::min(begin + kRun, boxes.size()); ++i) {
      const double distance = squared_distance_to_box(boxes[i], asked);
      if (distance < least) {
        least = distance;
        best = i;
      }
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = best * kRun; i < std::min((best + 1) * kRun, points_.size()); ++i)
    least = std::min(least, squared_distance(points_[i], asked));
  return least;
}

void NearestPoints::look_through(std::size_t level, std::size_t index, Search& search) const {
  if (!(squared_distance_to_box(levels_[level][index], search.asked) < search.least))
    return;
  const std::size_t begin = index * kRun;
  if (level > 0) {
    const std::size_t end = std::min(begin + kRun, levels_[level - 1].size());
    for (std::size_t i = begin; i < end; ++i)
      look_through(level - 1, i, search);
    return;
  }
  for (std::size_t i = begin; i < std::min(begin + kRun, points_.size()); ++i) {
    const double distance = squared_distance(points_[i], search.asked);
    if (distance < search.least) {
      search.least = distance;
      search.best = i;
    }
  }
}

std::uint32_t NearestPoints::nearest(Vec3f asked) const {
  const Vec3d point = to_double(asked);
  // As near as a point already known counts: there may be one before it in the order.
  Search search{point,
                std::nextafter(some_distance(point), std::numeric_limits<double>::infinity())};
  look_through(levels_.size() - 1, 0, search);
  return candidates_[search.best];
}

std::vector<std::uint32_t> nearest_of(std::span<const Vec3f> positions,
                                      std::span<const std::uint32_t> candidates,
                                      std::span<const std::uint32_t> asked) {
  const NearestPoints points(positions, candidates);
  std::vector<std::uint32_t> nearest(asked.size());
  std::transform(asked.begin(), asked.end(), nearest.begin(),
                 [&](std::uint32_t v) { return points.nearest(positions[v]); });
  return nearest;
}

}  // namespace meshhier::cluster_simplify
