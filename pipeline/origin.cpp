#include "pipeline/origin.h"

#include "base/power_of_two.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace meshhier::pipeline {
namespace {

/// One side of a box.
struct Side {
  double low, high;

  double length() const { return high - low; }
  double largest() const { return std::max(std::abs(low), std::abs(high)); }
  bool is_far(double longest) const { return largest() > 2 * longest; }
};

std::array<Side, 3> sides_of(const BoundsD& box) {
  return {{{box.min.x, box.max.x}, {box.min.y, box.max.y}, {box.min.z, box.max.z}}};
}

double longest_of(const std::array<Side, 3>& sides) {
  return std::max({sides[0].length(), sides[1].length(), sides[2].length()});
}

/// Returns the multiple of a power of two that is nearest to the middle. The power is about a
/// thousandth of the length that matters, so that differences to it are small; or a float's last
/// digit, so that a coordinate of 0 stays exact, too, unless that is more than a quarter of the
/// length.
double origin_along(const Side& side, double longest) {
  double length = std::max(side.length(), longest / 1024);
  if (length == 0)
    length = side.largest() * 1e-6;
  const double last_digit = power_of_two_from(side.largest()) * 0x1p-23;
  const double fine = power_of_two_from(length) / 1024;
  const double grid = last_digit <= length / 4 ? std::max(fine, last_digit) : fine;
  const double origin = std::round((side.low / 2 + side.high / 2) / grid) * grid;
  return std::isfinite(origin) ? origin : 0;
}

/// Returns how many points of a sample are beyond its core at each end.
std::size_t left_out(std::size_t count) {
  constexpr std::size_t kPart = 32, kFewest = 8;
  return count < kFewest ? 0 : (count + kPart - 1) / kPart;
}

/// Whether floats relative to `origin` are too coarse for the vertices along the side, though
/// others would not be.
bool is_coarse(const Side& core, double origin, std::uint64_t count) {
  constexpr double kHalfDigit = 0x1p-24, kPart = 1e-3;
  const double reach = std::max(std::abs(core.low - origin), std::abs(core.high - origin));
  const double distance = core.length() / std::sqrt(static_cast<double>(count));
  return core.length() > 0 && reach > 2 * core.length() && kHalfDigit * reach > kPart * distance;
}

/// Returns the core with as much on both sides of it; where all axes are alike, with many times its
/// longest side.
Side near(const Side& core, bool is_coarse, double longest) {
  constexpr double kManyTimes = 16;
  const double beyond = is_coarse ? core.length() : kManyTimes * longest;
  return {core.low - beyond, core.high + beyond};
}

BoundsD box_of(const std::array<Side, 3>& sides) {
  return {{sides[0].low, sides[1].low, sides[2].low},
          {sides[0].high, sides[1].high, sides[2].high}};
}

constexpr int kCells = 1024;
constexpr int kFewCells = kCells / 16;

template <class Coordinate>
bool fills_few_cells(std::span<const Vec3d> sample, const Side& side, Coordinate coordinate) {
  std::bitset<kCells> filled;
  int count = 0;
  for (const Vec3d& point : sample) {
    const double part = (coordinate(point) - side.low) / side.length();
    const auto cell = static_cast<std::size_t>(std::clamp(part * kCells, 0.0, kCells - 1.0));
    count += filled[cell] ? 0 : 1;
    if (count >= kFewCells)
      return false;  // soon, for most meshes
    filled.set(cell);
  }
  return true;
}

}  // namespace

bool is_far_from_zero(const BoundsD& box) {
  if (box.empty())
    return false;
  const std::array<Side, 3> sides = sides_of(box);
  const double longest = longest_of(sides);
  return std::ranges::any_of(sides, [&](const Side& side) { return side.is_far(longest); });
}

Vec3d origin_of(const BoundsD& box) {
  if (box.empty())
    return {};
  const std::array<Side, 3> sides = sides_of(box);
  const double longest = longest_of(sides);
  const auto along = [&](const Side& side) {
    return side.is_far(longest) ? origin_along(side, longest) : 0.0;
  };
  return {along(sides[0]), along(sides[1]), along(sides[2])};
}

BoundsD core_of(std::span<const Vec3d> sample) {
  if (sample.empty())
    return {};
  const std::size_t beyond = left_out(sample.size());
  std::array<Side, 3> sides{};
  std::vector<double> along(sample.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(sample, along.begin(), [&](const Vec3d& p) { return p[axis]; });
    const auto at = [&](std::size_t i) {
      const auto place = along.begin() + static_cast<std::ptrdiff_t>(i);
      std::nth_element(along.begin(), place, along.end());
      return *place;
    };
    sides[static_cast<std::size_t>(axis)] = {at(beyond), at(sample.size() - 1 - beyond)};
  }
  return box_of(sides);
}

Origin choose_origin(const BoundsD& all, const BoundsD& core, std::uint64_t count) {
  Origin origin{origin_of(all)};
  if (core.empty())
    return origin;
  const std::array<Side, 3> sides = sides_of(core);
  std::array<bool, 3> coarse{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    coarse[axis] = is_coarse(sides[axis], origin.at[static_cast<int>(axis)], count);
  if (std::ranges::none_of(coarse, std::identity()))
    return origin;
  const Vec3d of_core = origin_of(core);
  std::array<double, 3> at{of_core.x, of_core.y, of_core.z};
  std::array<Side, 3> around{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (is_coarse(sides[axis], at[axis], count))
      at[axis] = origin_along(sides[axis], 0);
    around[axis] = near(sides[axis], coarse[axis], longest_of(sides));
  }
  return {{at[0], at[1], at[2]}, box_of(around)};
}

bool may_need_origin(std::span<const Vec3d> sample, const BoundsD& all, std::uint64_t count) {
  return is_far_from_zero(all) || may_have_strays(sample, all) ||
         choose_origin(all, core_of(sample), count).at != Vec3d{};
}

double rounding_of(std::span<const Vec3d> sample, Vec3d origin) {
  if (sample.empty())
    return 0;
  std::vector<double> lost(sample.size());
  std::ranges::transform(sample, lost.begin(), [&](const Vec3d& p) {
    const Vec3d exact = p - origin;
    return length(to_double(to_float(exact)) - exact);
  });
  const auto place = lost.end() - 1 - static_cast<std::ptrdiff_t>(left_out(sample.size()));
  std::nth_element(lost.begin(), place, lost.end());
  return *place;
}

bool may_have_strays(std::span<const Vec3d> sample, const BoundsD& box) {
  if (box.empty())
    return false;
  const std::array<Side, 3> sides = sides_of(box);
  const double longest = longest_of(sides);
  const auto is_sparse = [&](const Side& side, auto coordinate) {
    return side.length() > longest / 2 && fills_few_cells(sample, side, coordinate);
  };
  return longest > 0 && std::isfinite(longest) &&
         (is_sparse(sides[0], [](const Vec3d& p) { return p.x; }) ||
          is_sparse(sides[1], [](const Vec3d& p) { return p.y; }) ||
          is_sparse(sides[2], [](const Vec3d& p) { return p.z; }));
}

}  // namespace meshhier::pipeline
