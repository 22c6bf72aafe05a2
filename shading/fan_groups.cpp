#include "shading/fan_groups.h"

#include "base/sort_few.h"
#include "shading/crease.h"

#include <algorithm>
#include <limits>

namespace meshhier::shading {
namespace {

constexpr std::size_t kMostGroups = 32;

double cosine_between(const Vec3d& a, const Vec3d& b) {
  const double size = length(a) * length(b);
  return size > 0 ? dot(a, b) / size : -1;
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

}  // namespace

const FanGroups& FanGrouper::group(std::span<const FanCorner> corners) {
  groups_.is_one_fan = find_fans(corners) <= 1;
  groups_.group_of.assign(corners.size(), 0);
  groups_.normals.clear();
  if (groups_.is_one_fan) {
    Vec3d& sum = groups_.normals.emplace_back();
    for (const FanCorner& corner : corners)
      sum = sum + corner.area;
  } else {
    join_fans(corners);
  }
  return groups_;
}

/// Fills fan_of_, unless there is but one. Returns how many there are.
std::size_t FanGrouper::find_fans(std::span<const FanCorner> corners) {
  sizes_.clear();
  for (const FanCorner& corner : corners)
    sizes_.push_back(length(corner.area));
  if (!walk_around(corners))
    return join_neighbours(corners);
  const std::size_t count = round_.size();
  sharp_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_smooth(corners, round_[i], round_[i + 1 < count ? i + 1 : 0]))
      sharp_.push_back(i);
  }
  return divide_round();
}

/// Whether the corners lie in one round about the place, two at each edge, turned alike; as they
/// do inside a surface.
bool FanGrouper::walk_around(std::span<const FanCorner> corners) {
  const std::size_t count = corners.size();
  if (count == 0 || count > std::numeric_limits<std::uint8_t>::max())
    return false;
  for (std::size_t i = 0; i < count; ++i)
    corner_of_[corners[i].next] = static_cast<std::uint8_t>(i);
  round_.clear();
  std::uint32_t corner = 0;
  do {
    round_.push_back(corner);
    const std::uint32_t edge = corners[corner].previous;
    corner = corner_of_[edge];
    if (corner >= count || corners[corner].next != edge)
      return false;  // left by another place
  } while (corner != 0 && round_.size() < count);
  return corner == 0 && round_.size() == count;
}

/// A fan goes from crease to crease; a single crease divides nothing.
std::size_t FanGrouper::divide_round() {
  if (sharp_.size() <= 1)
    return 1;
  const std::size_t begin = sharp_[0] + 1;
  std::rotate(round_.begin(), round_.begin() + static_cast<std::ptrdiff_t>(begin), round_.end());
  sharp_.push_back(sharp_[0] + round_.size());
  fan_of_.resize(round_.size());
  for (std::size_t i = 1; i < sharp_.size(); ++i) {
    const auto fan =
        std::span(round_).subspan(sharp_[i - 1] + 1 - begin, sharp_[i] - sharp_[i - 1]);
    const std::uint32_t least = *std::min_element(fan.begin(), fan.end());
    for (const std::uint32_t corner : fan)
      fan_of_[corner] = least;
  }
  return sharp_.size() - 1;
}

/// At open borders, and wherever a surface is none.
std::size_t FanGrouper::join_neighbours(std::span<const FanCorner> corners) {
  const auto count = static_cast<std::uint32_t>(corners.size());
  sides_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const std::uint32_t far_place : {corners[i].next, corners[i].previous})
      sides_.push_back(std::uint64_t{far_place} << 32 | i);
  }
  sort_few(std::span(sides_), [](std::uint64_t side) { return side; });
  joined_.reset(count);
  std::size_t fan_count = count;
  for (std::size_t begin = 0, end = 0; begin < sides_.size(); begin = end) {
    while (end < sides_.size() && sides_[end] >> 32 == sides_[begin] >> 32)
      ++end;
    const auto a = static_cast<std::uint32_t>(sides_[begin]);
    const auto b = static_cast<std::uint32_t>(sides_[end - 1]);
    if (end - begin == 2 && is_smooth(corners, a, b))
      fan_count -= std::size_t{joined_.join(a, b)};
  }
  fan_of_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    fan_of_[i] = joined_.find(i);
  return fan_count;
}

bool FanGrouper::is_smooth(std::span<const FanCorner> corners, std::uint32_t a,
                           std::uint32_t b) const {
  const double size = sizes_[a] * sizes_[b];
  return (size > 0 ? dot(corners[a].area, corners[b].area) / size : -1) >= crease_cosine();
}

/// The fan of the longest sum leads the first group.
void FanGrouper::join_fans(std::span<const FanCorner> corners) {
  sums_.assign(corners.size(), {});
  for (std::size_t i = 0; i < corners.size(); ++i)
    sums_[fan_of_[i]] = sums_[fan_of_[i]] + corners[i].area;
  fans_.clear();
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (fan_of_[i] == i)
      fans_.push_back(i);
  }
  std::sort(fans_.begin(), fans_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double size_of_a = dot(sums_[a], sums_[a]);
    const double size_of_b = dot(sums_[b], sums_[b]);
    return size_of_a != size_of_b ? size_of_a > size_of_b : a < b;
  });
  leaders_.clear();
  group_of_fan_.resize(corners.size());
  for (const std::uint32_t fan : fans_) {
    const std::size_t group = nearest_or_new_group(sums_[fan]);
    groups_.normals[group] = groups_.normals[group] + sums_[fan];
    group_of_fan_[fan] = static_cast<std::uint32_t>(group);
  }
  for (std::size_t i = 0; i < corners.size(); ++i)
    groups_.group_of[i] = group_of_fan_[fan_of_[i]];
}

std::size_t FanGrouper::nearest_or_new_group(const Vec3d& sum) {
  const bool has_direction = dot(sum, sum) > 0;
  const Nearest nearest = nearest_leader(leaders_, sum);
  const bool leads =
      has_direction && nearest.cosine < crease_cosine() && leaders_.size() < kMostGroups;
  if (!leads && !leaders_.empty())
    return nearest.leader;
  leaders_.push_back(sum);
  groups_.normals.emplace_back();
  return leaders_.size() - 1;
}

}  // namespace meshhier::shading
