#include "mesh_io/number_text.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

namespace meshhier::mesh_io {
namespace {

/// std::from_chars knows no '+'; "+-1" stays none.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

/// True if the decimal number `word`, beyond the range of its type, is large (else it is tiny): the
/// power of ten of its first digit that is not zero.
bool is_large(std::string_view word) {
  const std::size_t exponent_at = std::min(word.find_first_of("eE"), word.size());
  const std::string_view mantissa = word.substr(0, exponent_at);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t digit = std::min(mantissa.find_first_of("123456789"), mantissa.size());
  std::int64_t power = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(digit);
  if (exponent_at < word.size()) {
    const std::string_view exponent = word.substr(exponent_at + 1);
    const auto value = parse_integer(exponent);
    // An exponent beyond 64 bits: its sign decides.
    if (!value)
      return exponent[0] != '-';
    power += std::clamp<std::int64_t>(*value, -1'000'000, 1'000'000);
  }
  return power > 0;
}

}  // namespace

std::optional<std::int64_t> parse_integer(std::string_view word) {
  // Up to 18 digits cannot overflow; vertex indices have at most ten.
  constexpr std::size_t kSafeDigits = 18;
  const std::string_view digits = without_plus(word);
  if (digits.size() <= kSafeDigits && !digits.empty() && digits[0] != '-') {
    std::int64_t value = 0;
    for (const char c : digits) {
      if (c < '0' || c > '9')
        return std::nullopt;
      value = value * 10 + (c - '0');
    }
    return value;
  }
  std::int64_t value = 0;
  const char* const end = digits.data() + digits.size();
  const auto [at, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc{} || at != end)
    return std::nullopt;
  return value;
}

template <class Scalar>
std::optional<Scalar> parse_real(std::string_view word) {
  const std::string_view digits = without_plus(word);
  Scalar value = 0;
  const char* const end = digits.data() + digits.size();
  const auto [at, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::invalid_argument || at != end)
    return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    value = is_large(digits) ? std::numeric_limits<Scalar>::infinity() : Scalar{0};
    if (digits[0] == '-')
      value = -value;
  }
  return value;
}

template std::optional<float> parse_real<float>(std::string_view);
template std::optional<double> parse_real<double>(std::string_view);

}  // namespace meshhier::mesh_io
