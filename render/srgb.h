// Between light and the numbers of a screen (IEC 61966-2-1, sRGB), by exact arithmetic.
#pragma once

#include <cstdint>

namespace meshhier::render {

/// The light, 0 to 1, of a screen's value; what is below 0 or no number is 0, above 1 is 1.
double light_of(double value);

/// The 8-bit value nearest to a light, which is cut to 0 to 1; 0 of what is no number.
std::uint8_t screen_value(double light);

}  // namespace meshhier::render
