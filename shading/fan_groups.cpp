#include "shading/fan_groups.h"

#include "hierarchy/sort_few.h"
#include "hierarchy/union_find.h"
#include "shading/crease.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace meshhier::shading {
namespace {

constexpr std::size_t kMostGroups = 32;

/// Around most places there are no more corners.
constexpr std::size_t kFew = 16;

double cosine_between(const Vec3d& a, const Vec3d& b) {
  const double size = length(a) * length(b);
  return size > 0 ? dot(a, b) / size : -1;
}

/// A corner at one of its two edges.
struct Side {
  std::uint32_t far_place = 0;
  std::uint32_t corner = 0;
};

/// Sorts the sides, and calls visit(a, b) for the corners at each edge that exactly two have.
template <class Visit>
void visit_neighbours(std::span<Side> sides, const Visit& visit) {
  sort_few(sides,
           [](const Side& side) { return std::uint64_t{side.far_place} << 32 | side.corner; });
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].far_place == sides[begin].far_place)
      ++end;
    if (end - begin == 2)
      visit(sides[begin].corner, sides[begin + 1].corner);
  }
}

/// Of each corner the least one of its fan; none if all are one fan.
std::vector<std::uint32_t> find_fans(std::span<const FanCorner> corners, double cosine) {
  std::vector<Side> sides;
  sides.reserve(2 * corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    sides.push_back({corners[i].next, i});
    sides.push_back({corners[i].previous, i});
  }
  UnionFind fans(static_cast<std::uint32_t>(corners.size()));
  std::size_t count = corners.size();
  visit_neighbours(std::span(sides), [&](std::uint32_t a, std::uint32_t b) {
    if (cosine_between(corners[a].area, corners[b].area) >= cosine)
      count -= std::size_t{fans.join(a, b)};
  });
  if (count <= 1)
    return {};
  std::vector<std::uint32_t> fan_of(corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i)
    fan_of[i] = fans.find(i);
  return fan_of;
}

/// The same of a few corners, without memory of its own: whether all are one fan.
bool are_one_fan(std::span<const FanCorner> corners, double cosine) {
  std::array<Side, 2 * kFew> room;
  std::array<double, kFew> sizes;
  std::array<std::size_t, kFew> fan_of;
  const auto sides = std::span(room).first(2 * corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    sides[2 * i] = {corners[i].next, i};
    sides[2 * i + 1] = {corners[i].previous, i};
    sizes[i] = length(corners[i].area);
    fan_of[i] = i;
  }
  std::size_t count = corners.size();
  visit_neighbours(sides, [&](std::uint32_t a, std::uint32_t b) {
    const double size = sizes[a] * sizes[b];
    const bool meet = (size > 0 ? dot(corners[a].area, corners[b].area) / size : -1) >= cosine;
    const std::size_t gone = fan_of[b];
    const std::size_t stays = fan_of[a];
    if (!meet || gone == stays)
      return;
    for (std::size_t i = 0; i < corners.size(); ++i)
      fan_of[i] = fan_of[i] == gone ? stays : fan_of[i];
    --count;
  });
  return count <= 1;
}

/// The fans, the one of the longest sum first.
std::vector<std::uint32_t> by_size(const std::vector<std::uint32_t>& fan_of,
                                   const std::vector<Vec3d>& sums) {
  std::vector<std::uint32_t> fans;
  for (std::uint32_t i = 0; i < fan_of.size(); ++i) {
    if (fan_of[i] == i)
      fans.push_back(i);
  }
  std::stable_sort(fans.begin(), fans.end(), [&](std::uint32_t a, std::uint32_t b) {
    return dot(sums[a], sums[a]) > dot(sums[b], sums[b]);
  });
  return fans;
}

struct Nearest {
  std::size_t leader = 0;
  double cosine = -2;
};

/// The first of equally near ones.
Nearest nearest_leader(const std::vector<Vec3d>& leaders, const Vec3d& direction) {
  Nearest best;
  for (std::size_t i = 0; i < leaders.size(); ++i) {
    const double cosine = cosine_between(leaders[i], direction);
    if (cosine > best.cosine)
      best = {i, cosine};
  }
  return best;
}

FanGroups one_group(std::span<const FanCorner> corners) {
  Vec3d sum;
  for (const FanCorner& corner : corners)
    sum = sum + corner.area;
  return {std::vector<std::uint32_t>(corners.size()), {sum}};
}

}  // namespace

bool is_one_fan(std::span<const FanCorner> corners) {
  const double cosine = crease_cosine();
  return corners.size() <= kFew ? are_one_fan(corners, cosine) : find_fans(corners, cosine).empty();
}

FanGroups group_fans(std::span<const FanCorner> corners) {
  const double cosine = crease_cosine();
  const std::vector<std::uint32_t> fan_of = find_fans(corners, cosine);
  if (fan_of.empty())
    return one_group(corners);
  std::vector<Vec3d> sums(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    sums[fan_of[i]] = sums[fan_of[i]] + corners[i].area;

  FanGroups groups;
  std::vector<Vec3d> leaders;
  std::vector<std::uint32_t> group_of_fan(corners.size());
  for (const std::uint32_t fan : by_size(fan_of, sums)) {
    const bool has_direction = dot(sums[fan], sums[fan]) > 0;
    Nearest nearest = nearest_leader(leaders, sums[fan]);
    const bool leads = has_direction && nearest.cosine < cosine && leaders.size() < kMostGroups;
    if (leads || leaders.empty()) {
      nearest.leader = leaders.size();
      leaders.push_back(sums[fan]);
      groups.normals.emplace_back();
    }
    groups.normals[nearest.leader] = groups.normals[nearest.leader] + sums[fan];
    group_of_fan[fan] = static_cast<std::uint32_t>(nearest.leader);
  }
  groups.group_of.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    groups.group_of[i] = group_of_fan[fan_of[i]];
  return groups;
}

}  // namespace meshhier::shading
