// Numbers as text: fast, exact, independent of the locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {

/// A decimal integer with an optional sign that fits int64; nothing else in `word`.
std::optional<std::int64_t> parse_integer(std::string_view word);

/// A decimal number with optional sign, fraction and exponent, or "inf" or "nan" in any case;
/// nothing else in `word`. Correctly rounded to `Scalar` (float or double); too large becomes
/// infinite, too small zero.
template <class Scalar>
std::optional<Scalar> parse_real(std::string_view word);

}  // namespace meshhier::mesh_io
