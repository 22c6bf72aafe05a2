// Units of length.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace meshhier {

enum class Unit : std::uint8_t { mm, cm, m, km, in, ft, us_ft };

namespace detail {
struct UnitFacts {
  std::string_view name;
  double metres;
};
/// In the order of Unit. A survey foot of the US is 1200 / 3937 m.
inline constexpr std::array<UnitFacts, 7> kUnits{{{"mm", 0.001},
                                                  {"cm", 0.01},
                                                  {"m", 1},
                                                  {"km", 1000},
                                                  {"in", 0.0254},
                                                  {"ft", 0.3048},
                                                  {"us_ft", 1200.0 / 3937}}};
}  // namespace detail

/// "mm" ... "us_ft".
constexpr std::string_view name_of(Unit unit) {
  return detail::kUnits[static_cast<std::size_t>(unit)].name;
}

constexpr double metres_of(Unit unit) {
  return detail::kUnits[static_cast<std::size_t>(unit)].metres;
}

}  // namespace meshhier
