#include "hierarchy/lattice.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace meshhier {
namespace {

/// So many steps from 0 a float still has a bit for each.
constexpr double kMostSteps = 16777216;  // 2^24

/// Steps stay well within the exponents of normal floats, for viewers that scale by them.
constexpr int kLeastExponent = -100;

double last_number(int bits) {
  return std::ldexp(1.0, bits) - 1;
}

/// The coordinate in steps, rounded, halves up.
double in_steps(double coordinate, double step) {
  return std::floor(coordinate / step + 0.5);
}

/// Where an axis of the lattice begins, in steps: as much room below as above.
double first_step(double min, double max, double step, int bits) {
  const double low = in_steps(min, step);
  const double room = last_number(bits) - (in_steps(max, step) - low);
  const double first = low - std::floor(room / 2);
  return std::clamp(first, -kMostSteps, kMostSteps - last_number(bits));
}

bool holds(double min, double max, double step, int bits) {
  const double low = in_steps(min, step), high = in_steps(max, step);
  return high - low <= last_number(bits) && std::max(std::abs(low), std::abs(high)) <= kMostSteps;
}

bool is_axis_sound(double corner, double step, int bits) {
  const double first = corner / step;
  return std::trunc(first) == first && first >= -kMostSteps &&
         first + last_number(bits) <= kMostSteps;
}

std::uint32_t number_of(double coordinate, double corner, double step, int bits) {
  // Beyond the largest float there is no point.
  constexpr double kLargest = std::numeric_limits<float>::max();
  const double first = corner / step;
  const double low = std::max(0.0, -std::floor(kLargest / step) - first);
  const double high = std::min(last_number(bits), std::floor(kLargest / step) - first);
  return static_cast<std::uint32_t>(std::clamp(in_steps(coordinate, step) - first, low, high));
}

}  // namespace

Vec3<std::uint32_t> Lattice::numbers_of(Vec3f position) const {
  return {number_of(position.x, corner.x, step, bits), number_of(position.y, corner.y, step, bits),
          number_of(position.z, corner.z, step, bits)};
}

Vec3f Lattice::point(Vec3<std::uint32_t> numbers) const {
  return to_float(
      {corner.x + numbers.x * step, corner.y + numbers.y * step, corner.z + numbers.z * step});
}

bool Lattice::is_sound() const {
  if (bits < kFewestBits || bits > kMostBits || !(step > 0) || !std::isfinite(step))
    return false;
  int exponent = 0;
  const bool is_power = std::frexp(step, &exponent) == 0.5;
  constexpr int kMostExponent = std::numeric_limits<float>::max_exponent;
  return is_power && exponent > kLeastExponent && exponent <= kMostExponent &&
         is_axis_sound(corner.x, step, bits) && is_axis_sound(corner.y, step, bits) &&
         is_axis_sound(corner.z, step, bits);
}

Lattice make_lattice(const Bounds& bounds, int bits) {
  assert(bits >= Lattice::kFewestBits && bits <= Lattice::kMostBits && !bounds.empty());
  const Vec3d min = to_double(bounds.min), max = to_double(bounds.max);
  const Vec3d size = max - min;
  const double extent = std::max({size.x, size.y, size.z});
  int exponent = kLeastExponent;
  if (extent > 0)
    exponent = std::max(kLeastExponent, std::ilogb(extent / last_number(bits)));
  Lattice lattice;
  lattice.bits = bits;
  lattice.step = std::ldexp(1.0, exponent);
  while (!holds(min.x, max.x, lattice.step, bits) || !holds(min.y, max.y, lattice.step, bits) ||
         !holds(min.z, max.z, lattice.step, bits))
    lattice.step *= 2;
  lattice.corner = Vec3d{first_step(min.x, max.x, lattice.step, bits),
                         first_step(min.y, max.y, lattice.step, bits),
                         first_step(min.z, max.z, lattice.step, bits)} *
                   lattice.step;
  return lattice;
}

float float_above(double value) {
  const auto nearest = static_cast<float>(value);
  return double{nearest} < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                 : nearest;
}

double round_to(const Lattice& lattice, std::span<Vec3f> positions) {
  double worst = 0;
  for (Vec3f& position : positions) {
    const Vec3f rounded = lattice.nearest(position);
    worst = std::max(worst, length(to_double(rounded) - to_double(position)));
    position = rounded;
  }
  return worst;
}

}  // namespace meshhier
