#include "server/byte_range.h"

#include "base/small_letters.h"
#include "base/trimmed.h"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace meshhier::server {
namespace {

constexpr std::string_view kUnit = "bytes=";

/// Parses a number of digits only; one beyond 64 bits counts as the largest.
std::optional<std::uint64_t> parse_digits(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  std::uint64_t number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  return failure == std::errc::result_out_of_range ? UINT64_MAX : number;
}

RangeAnswer last_bytes(std::uint64_t count, std::uint64_t file_bytes) {
  const std::uint64_t bytes = std::min(count, file_bytes);
  if (bytes == 0)
    return {RangeAnswer::Kind::outside, {}};
  return {RangeAnswer::Kind::part, {file_bytes - bytes, bytes}};
}

}  // namespace

RangeAnswer find_range(std::string_view header, std::uint64_t file_bytes) {
  if (small_letters(header.substr(0, kUnit.size())) != kUnit)
    return {};
  const std::string_view text = trimmed(header.substr(kUnit.size()));
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos)
    return {};
  const auto first = parse_digits(text.substr(0, dash));
  const auto last = parse_digits(text.substr(dash + 1));
  if (dash == 0)
    return last ? last_bytes(*last, file_bytes) : RangeAnswer{};
  const bool is_open = dash + 1 == text.size();
  if (!first || (!last && !is_open) || (last && *last < *first))
    return {};
  if (*first >= file_bytes)
    return {RangeAnswer::Kind::outside, {}};
  const std::uint64_t end = is_open ? file_bytes : std::min(*last, file_bytes - 1) + 1;
  return {RangeAnswer::Kind::part, {*first, end - *first}};
}

}  // namespace meshhier::server
