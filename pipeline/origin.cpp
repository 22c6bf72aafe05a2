#include "pipeline/origin.h"

#include "hierarchy/power_of_two.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>

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

/// The multiple of a power of two that is nearest to the middle. The power is about a thousandth of
/// the length that matters, so that what is left of the coordinates is small; or a float's last
/// digit, so that a coordinate of 0 stays exact, too, unless that is more than a quarter of it.
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
      return false;  // of most meshes soon
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
