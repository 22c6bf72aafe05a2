// Between light and the numbers of a screen (IEC 61966-2-1, sRGB), by exact arithmetic.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier {

/// The light, 0 to 1, of a screen's value; what is below 0 or no number is 0, above 1 is 1.
double light_of(double value);

/// The screen's value of a light, both 0 to 1; what is below 0 or no number is 0, above 1 is 1. As
/// the nearest number of 8 or 16 bits the way back from light_of(), rounded to a float, is exact.
double value_of(double light);

/// The 8-bit value nearest to a light, which is cut to 0 to 1; 0 of what is no number.
std::uint8_t screen_value(double light);

/// The 8-bit value nearest to a screen's value from 0 to 1, to which it is cut.
std::uint8_t screen_byte(float value);

/// The same in whole numbers: light of 8-bit values from 0 to 65535, for sums that are exact. Each
/// value's light is nearest to that value.
class LightTable {
 public:
  LightTable();
  static const LightTable& get();

  std::uint32_t light(std::uint8_t value) const { return lights_[value]; }
  /// Requires light <= 65535.
  std::uint8_t value(std::uint32_t light) const { return values_[light]; }

 private:
  std::array<std::uint16_t, 256> lights_{};
  std::vector<std::uint8_t> values_;  ///< of each light
};

/// Both ways along straight lines between 1,024 points of the curve, for means of many colours:
/// within 4e-7 of light_of(), and value() undoes light() but for rounding.
class LightCurve {
 public:
  LightCurve();
  static const LightCurve& get();

  /// 0 to 1 each; what is outside is cut, what is no number is 0.
  double light(double value) const;
  double value(double light) const;

 private:
  static constexpr std::size_t kParts = 1024;
  std::array<double, kParts + 1> lights_{};           ///< of values at equal steps
  std::array<std::uint16_t, kParts> first_points_{};  ///< the last one not above each part of light
};

}  // namespace meshhier
