#include "cluster_simplify/nearest.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

namespace meshhier::cluster_simplify {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using IndexedPoint = std::pair<Kernel::Point_3, std::uint32_t>;
using Traits =
    CGAL::Search_traits_adapter<IndexedPoint, CGAL::First_of_pair_property_map<IndexedPoint>,
                                CGAL::Search_traits_3<Kernel>>;
using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;

Kernel::Point_3 point(Vec3f p) {
  return {double{p.x}, double{p.y}, double{p.z}};
}

// Below so many distances looking at all of them takes less time than planting a tree.
constexpr std::size_t kFewDistances = std::size_t{1} << 21;

std::uint32_t nearest_of_all(std::span<const Vec3f> positions,
                             std::span<const std::uint32_t> candidates, Vec3d asked) {
  std::uint32_t best = candidates[0];
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t v : candidates) {
    const Vec3d away = to_double(positions[v]) - asked;
    const double squared = dot(away, away);
    if (squared < least) {
      least = squared;
      best = v;
    }
  }
  return best;
}

}  // namespace

std::vector<std::uint32_t> nearest_of(std::span<const Vec3f> positions,
                                      std::span<const std::uint32_t> candidates,
                                      std::span<const std::uint32_t> asked) {
  std::vector<std::uint32_t> nearest;
  nearest.reserve(asked.size());
  if (asked.size() * candidates.size() <= kFewDistances) {
    for (const std::uint32_t v : asked)
      nearest.push_back(nearest_of_all(positions, candidates, to_double(positions[v])));
    return nearest;
  }
  // The tree takes quadratic time for equal points: one of them is enough.
  std::vector<std::uint32_t> sorted(candidates.begin(), candidates.end());
  const auto key = [&](std::uint32_t v) {
    return std::tuple(positions[v].x, positions[v].y, positions[v].z);
  };
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key(a), a) < std::tuple(key(b), b);
  });
  std::vector<IndexedPoint> points;
  points.reserve(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || positions[sorted[i]] != positions[sorted[i - 1]])
      points.emplace_back(point(positions[sorted[i]]), sorted[i]);
  }
  const Search::Tree tree(points.begin(), points.end());
  for (const std::uint32_t v : asked)
    nearest.push_back(Search(tree, point(positions[v]), 1).begin()->first.second);
  return nearest;
}

}  // namespace meshhier::cluster_simplify
