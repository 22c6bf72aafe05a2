#include "cluster_simplify/one_side.h"

#include <algorithm>
#include <cstddef>

namespace meshhier::cluster_simplify {
namespace {

constexpr std::size_t kNowhere = SIZE_MAX;

/// Where the one fan is that fits; kNowhere if none does, or several.
template <class Fits>
std::size_t only(Fans fans, const Fits& fits) {
  const auto first = std::find_if(fans.begin(), fans.end(), fits);
  if (first == fans.end() || std::find_if(first + 1, fans.end(), fits) != fans.end())
    return kNowhere;
  return static_cast<std::size_t>(first - fans.begin());
}

}  // namespace

bool is_two_sided(const CollapseMesh& mesh) {
  constexpr std::uint32_t kTriangles = 4;
  const auto edges = mesh.edges();
  const auto twice = std::ranges::count_if(
      edges, [](const CollapseMesh::Edge& edge) { return edge.triangle_count == kTriangles; });
  return 2 * static_cast<std::size_t>(twice) > edges.size();
}

bool OneSide::find(const EdgeStar& star) {
  pairs_.clear();
  const Fans around_from = star.around_from(), around_to = star.around_to();
  const auto is_at_edge = [&](const CollapseMesh::Fan& fan) { return fan.is_at(star.to()); };
  const auto seed = std::find_if(around_from.begin(), around_from.end(), is_at_edge);
  if (seed == around_from.end() || !find_around(around_from, seed->triangle, from_) ||
      !find_around(around_to, seed->triangle, to_))
    return false;
  const auto is_on_both = [&](const CollapseMesh::Fan& fan) {
    return !is_at_edge(fan) ||
           std::ranges::find(to_, fan.triangle, &CollapseMesh::Fan::triangle) != to_.end();
  };
  if (!std::ranges::all_of(from_, is_on_both))
    return false;
  star_.take(star, from_, to_);
  return true;
}

/// Finds, for each fan, the one with the other corners exchanged; false if one has none, or
/// several.
bool OneSide::find_reverses(Fans fans) {
  reverses_.clear();
  for (const CollapseMesh::Fan& fan : fans) {
    reverses_.push_back(only(fans, [&](const CollapseMesh::Fan& other) {
      return other.next == fan.previous && other.previous == fan.next;
    }));
  }
  return std::ranges::find(reverses_, kNowhere) == reverses_.end();
}

/// Goes from the triangle `seed` to those beside it, on both ways, as far as there are any.
bool OneSide::find_around(Fans fans, std::uint32_t seed, std::vector<CollapseMesh::Fan>& side) {
  side.clear();
  if (fans.size() > kMost || fans.size() % 2 != 0 || !find_reverses(fans))
    return false;
  const auto first = static_cast<std::size_t>(
      std::ranges::find(fans, seed, &CollapseMesh::Fan::triangle) - fans.begin());
  const auto add = [&](std::size_t at) {
    side.push_back(fans[at]);
    pairs_.push_back({fans[at].triangle, fans[reverses_[at]].triangle});
  };
  const auto is_other = [&](const CollapseMesh::Fan& fan, std::size_t reverse) {
    return fan.triangle != fans[reverse].triangle;
  };
  add(first);
  std::size_t at = first;
  const std::size_t half = fans.size() / 2;
  while (side.size() <= half) {
    const std::size_t last = at;
    at = only(fans, [&](const CollapseMesh::Fan& fan) {
      return fan.next == fans[last].previous && is_other(fan, reverses_[last]);
    });
    if (at == first)
      return side.size() == half;
    if (at == kNowhere)
      break;
    add(at);
  }
  for (at = first; side.size() <= half;) {
    const std::size_t last = at;
    at = only(fans, [&](const CollapseMesh::Fan& fan) {
      return fan.previous == fans[last].next && is_other(fan, reverses_[last]);
    });
    if (at == kNowhere)
      break;
    add(at);
  }
  return side.size() == half;
}

}  // namespace meshhier::cluster_simplify
