// Units of length.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace meshhier {

enum class Unit : std::uint8_t { mm, cm, m, km, in, ft, us_ft };

inline constexpr std::array<std::string_view, 7> kUnitNames{"mm", "cm", "m",    "km",
                                                            "in", "ft", "us_ft"};

constexpr std::string_view name_of(Unit unit) {
  return kUnitNames[static_cast<std::size_t>(unit)];
}

/// A survey foot of the US is 1200 / 3937 m.
constexpr double metres_of(Unit unit) {
  constexpr std::array<double, kUnitNames.size()> kMetres{0.001,  0.01,         1, 1000, 0.0254,
                                                          0.3048, 1200.0 / 3937};
  return kMetres[static_cast<std::size_t>(unit)];
}

}  // namespace meshhier
