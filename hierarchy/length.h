// Lengths as people write them: "0.5", "2m".
#pragma once

#include "base/number_text.h"
#include "hierarchy/unit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace meshhier {

/// A number alone is in the unit of whatever it is a length of, which need not be known.
struct Length {
  double number = 0;
  std::optional<Unit> unit{};

  constexpr Length(double count, std::optional<Unit> of = {}) : number(count), unit(of) {}
  /// Returns the number in a unit of so many metres, above 0 if this one has a unit. Powers of ten
  /// are exact: 7 cm are 0.07 m.
  double in(double metres) const {
    if (!unit)
      return number;
    const double own = metres_of(*unit), parts = metres / own;
    return parts == std::round(parts) ? number / parts : number * (own / metres);
  }
};

/// Parses a finite number and perhaps a unit of kUnits behind it; nothing if it is anything else.
inline std::optional<Length> parse_length(std::string_view text) {
  const std::size_t end = std::min(text.find_last_of("0123456789.") + 1, text.size());
  const auto number = parse_finite(text.substr(0, end));
  const auto unit = value_named(kUnits, text.substr(end));
  if (!number || (end < text.size() && !unit))
    return std::nullopt;
  return Length(*number, unit);
}

}  // namespace meshhier
