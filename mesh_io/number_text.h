// Numbers as text: fast, exact, independent of the locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {

/// Parses a decimal integer with an optional sign that fits int64. Nothing if `word` is anything
/// else.
std::optional<std::int64_t> parse_integer(std::string_view word);

/// Parses an integer that is written as a float: "3.0", of at most 2^53.
std::optional<std::int64_t> parse_whole(std::string_view word);

/// Parses a decimal number with optional sign, fraction and exponent, or "inf" or "nan" in any
/// case; "-nan(ind)", "1.#QNAN" and the like of Windows give NaN. Nothing if `word` is anything
/// else. Correctly rounded to `Scalar` (float or double); too large becomes infinite, too small
/// zero.
template <class Scalar>
std::optional<Scalar> parse_real(std::string_view word);

/// A decimal number whose type nobody declared.
struct DecimalNumber {
  double value = 0;
  /// A float says all that the text does: rounded to the text's last digit it is the text again.
  /// That is so for what was written from a float, in whatever number of digits.
  bool fits_float = true;
};

/// Parses as parse_real<double>() does. float(value) is the correctly rounded float if
/// `fits_float`.
std::optional<DecimalNumber> parse_decimal(std::string_view word);

}  // namespace meshhier::mesh_io
