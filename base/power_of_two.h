// Powers of two, exactly: exp2() and log2() of the C library may differ between processors.
#pragma once

#include <cmath>

namespace meshhier {

/// The least power of two that is not below `value`, which is above 0 and finite; infinity if none
/// is in range.
inline double power_of_two_from(double value) {
  int exponent = 0;
  const bool is_power = std::frexp(value, &exponent) == 0.5;
  return std::ldexp(1.0, is_power ? exponent - 1 : exponent);
}

}  // namespace meshhier
