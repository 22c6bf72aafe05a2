// Units of length.
#pragma once

#include "base/named_value.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace meshhier {

enum class Unit : std::uint8_t { mm, cm, m, km, in, ft, us_ft };

struct UnitRow {
  std::string_view name;
  Unit value;
  double metres;
};
inline constexpr std::array kUnits{UnitRow{"mm", Unit::mm, 0.001},
                                   UnitRow{"cm", Unit::cm, 0.01},
                                   UnitRow{"m", Unit::m, 1},
                                   UnitRow{"km", Unit::km, 1000},
                                   UnitRow{"in", Unit::in, 0.0254},
                                   UnitRow{"ft", Unit::ft, 0.3048},
                                   UnitRow{"us_ft", Unit::us_ft, 1200.0 / 3937}};

constexpr std::string_view name_of(Unit unit) {
  return name_in(kUnits, unit);
}
constexpr double metres_of(Unit unit) {
  return row_with(kUnits, unit).metres;
}

}  // namespace meshhier
