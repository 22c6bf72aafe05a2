#include "mesh_io/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <system_error>

namespace meshhier::mesh_io {
namespace {

/// std::from_chars knows no '+'; "+-1" stays none.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

/// Returns true if the decimal number `word`, beyond the range of its type, is large (else it is
/// tiny): the power of ten of its first digit that is not zero.
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

/// The value of one in the last digit of a number: 0.001 of "2.500". 0 if it is out of all range.
double unit_of_last_digit(std::string_view word) {
  static constexpr std::array kUnits{1e0,   1e-1,  1e-2,  1e-3,  1e-4,  1e-5,  1e-6,
                                     1e-7,  1e-8,  1e-9,  1e-10, 1e-11, 1e-12, 1e-13,
                                     1e-14, 1e-15, 1e-16, 1e-17, 1e-18, 1e-19, 1e-20};
  const std::size_t exponent_at = std::min(word.find_first_of("eE"), word.size());
  const std::size_t point = std::min(word.find('.'), exponent_at);
  const std::size_t decimals = exponent_at - std::min(point + 1, exponent_at);
  if (exponent_at == word.size() && decimals < kUnits.size())
    return kUnits[decimals];
  const std::string_view exponent = word.substr(std::min(exponent_at + 1, word.size()));
  const std::int64_t power =
      parse_integer(exponent).value_or(0) - static_cast<std::int64_t>(decimals);
  return parse_real<double>("1e" + std::to_string(power)).value_or(0);
}

/// Returns whether a float says all that a text does whose double is no float.
bool float_says_it(std::string_view word, double value) {
  const auto narrow = static_cast<float>(value);
  if (!std::isfinite(narrow))
    return false;
  // The float may lie in the middle between two texts, as -266108.4375 does beside -266108.438, and
  // the double is off the text by half its own last bit.
  const double size = std::abs(value);
  const double last_bit = std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
  if (std::abs(value - static_cast<double>(narrow)) > (unit_of_last_digit(word) + last_bit) / 2)
    return false;
  // Rounded twice, by way of the double, the float may be another one.
  return parse_real<float>(word) == narrow;
}

/// Returns whether older programs on Windows write this for no number: "-1.#IND00", "1.#QNAN0",
/// "1.#INF".
bool is_no_number(std::string_view word) {
  word.remove_prefix(word.starts_with('-') ? 1 : 0);
  return word.starts_with("1.#IND") || word.starts_with("1.#INF") || word.starts_with("1.#QNAN") ||
         word.starts_with("1.#SNAN");
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
  if (error == std::errc::invalid_argument || at != end) {
    return is_no_number(digits) ? std::optional(std::numeric_limits<Scalar>::quiet_NaN())
                                : std::nullopt;
  }
  if (error == std::errc::result_out_of_range) {
    value = is_large(digits) ? std::numeric_limits<Scalar>::infinity() : Scalar{0};
    if (digits[0] == '-')
      value = -value;
  }
  return value;
}

std::optional<std::int64_t> parse_whole(std::string_view word) {
  constexpr double kMost = 9007199254740992;
  const auto value = parse_real<double>(word);
  const bool is_whole = value && *value == std::floor(*value) && std::abs(*value) <= kMost;
  return is_whole ? std::optional(static_cast<std::int64_t>(*value)) : std::nullopt;
}

std::optional<DecimalNumber> parse_decimal(std::string_view word) {
  const auto value = parse_real<double>(word);
  if (!value)
    return std::nullopt;
  const bool is_float = static_cast<double>(static_cast<float>(*value)) == *value;
  return DecimalNumber{*value, is_float || float_says_it(word, *value)};
}

template std::optional<float> parse_real<float>(std::string_view);
template std::optional<double> parse_real<double>(std::string_view);

}  // namespace meshhier::mesh_io
