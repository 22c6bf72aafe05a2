#include "base/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace meshhier {
namespace {

/// Takes the root of a number from 0.001 to 1 by Newton's method: 20 steps reach the last bits from
/// above.
constexpr double fifth_root(double x) {
  double root = 1;
  for (int step = 0; step < 20; ++step) {
    const double squared = root * root;
    root = (4 * root + x / (squared * squared)) / 5;
  }
  return root;
}

/// The same for a number from 0.0007 to 1.
double cube_root(double x) {
  double root = 1;
  for (int step = 0; step < 14; ++step)
    root = (2 * root + x / (root * root)) / 3;
  return root;
}

/// The light of a value from 0 to 1.
constexpr double light(double value) {
  if (value <= 0.04045)
    return value / 12.92;
  const double base = (value + 0.055) / 1.055;
  return base * base * fifth_root(base * base);  // to the power of 2.4
}

/// The least light of each value from 1 to 255: that of the value half a step below.
constexpr std::array<double, 255> kLeastLight = [] {
  std::array<double, 255> least{};
  for (int i = 0; i < 255; ++i)
    least[static_cast<std::size_t>(i)] = light((i + 0.5) / 255);
  return least;
}();

/// The least value that a light may have, by a part of the range from 0 to 1.
constexpr std::size_t kParts = 1024;
constexpr std::array<std::uint8_t, kParts> kFirstValue = [] {
  std::array<std::uint8_t, kParts> first{};
  std::size_t value = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    while (value < kLeastLight.size() && kLeastLight[value] <= static_cast<double>(part) / kParts)
      ++value;
    first[part] = static_cast<std::uint8_t>(value);
  }
  return first;
}();

constexpr int kFullLight = 65535;

}  // namespace

double light_of(double value) {
  return value > 0 ? light(std::min(value, 1.0)) : 0;
}

double value_of(double light) {
  if (!(light > 0))
    return 0;
  if (!(light < 1))
    return 1;
  if (light <= 0.0031308)
    return light * 12.92;
  return 1.055 * cube_root(light * std::sqrt(std::sqrt(light))) - 0.055;  // power of 1 / 2.4
}

std::uint8_t screen_value(double light) {
  if (!(light > 0))
    return 0;
  if (!(light < 1))
    return 255;
  std::size_t value = kFirstValue[static_cast<std::size_t>(light * kParts)];
  while (value < kLeastLight.size() && kLeastLight[value] <= light)
    ++value;
  return static_cast<std::uint8_t>(value);
}

std::uint8_t screen_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 255));
}

LightTable::LightTable() : values_(kFullLight + 1) {
  for (std::size_t value = 0; value < lights_.size(); ++value) {
    const double full = light_of(static_cast<double>(value) / 255) * kFullLight;
    lights_[value] = static_cast<std::uint16_t>(full + 0.5);
  }
  for (std::size_t light = 0; light < values_.size(); ++light)
    values_[light] = screen_value(static_cast<double>(light) / kFullLight);
}

const LightTable& LightTable::get() {
  static const LightTable table;
  return table;
}

LightCurve::LightCurve() {
  for (std::size_t i = 0; i < lights_.size(); ++i)
    lights_[i] = light_of(static_cast<double>(i) / kParts);
  std::uint16_t point = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    while (lights_[point + 1U] <= static_cast<double>(part) / kParts)
      ++point;
    first_points_[part] = point;
  }
}

const LightCurve& LightCurve::get() {
  static const LightCurve curve;
  return curve;
}

double LightCurve::light(double value) const {
  if (!(value > 0))
    return 0;
  if (!(value < 1))
    return 1;
  const auto i = static_cast<std::size_t>(value * kParts);
  return lights_[i] + (value * kParts - static_cast<double>(i)) * (lights_[i + 1] - lights_[i]);
}

double LightCurve::value(double light) const {
  if (!(light > 0))
    return 0;
  if (!(light < 1))
    return 1;
  std::size_t i = first_points_[static_cast<std::size_t>(light * kParts)];
  while (lights_[i + 1] <= light)
    ++i;
  return (static_cast<double>(i) + (light - lights_[i]) / (lights_[i + 1] - lights_[i])) / kParts;
}

}  // namespace meshhier
