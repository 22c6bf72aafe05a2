#include "execution/size_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace meshhier::execution {

namespace {

struct Unit {
  std::string_view name;  ///< lower case
  double bytes;
};

constexpr std::array kUnits{
    Unit{"", 1},
    Unit{"b", 1},
    Unit{"k", 1024.0},
    Unit{"kib", 1024.0},
    Unit{"kb", 1e3},
    Unit{"m", 1024.0 * 1024},
    Unit{"mib", 1024.0 * 1024},
    Unit{"mb", 1e6},
    Unit{"g", 1024.0 * 1024 * 1024},
    Unit{"gib", 1024.0 * 1024 * 1024},
    Unit{"gb", 1e9},
    Unit{"t", 1024.0 * 1024 * 1024 * 1024},
    Unit{"tib", 1024.0 * 1024 * 1024 * 1024},
    Unit{"tb", 1e12},
};

constexpr std::array<std::string_view, 5> kBinaryUnits{"B", "KiB", "MiB", "GiB", "TiB"};

/// Up to here every integer is a double, so the arithmetic below is exact for whole numbers.
constexpr double kLimit = 9007199254740992.0;  // 2^53

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

std::string_view without_spaces_around(std::string_view text) {
  while (!text.empty() && is_space(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_space(text.back()))
    text.remove_suffix(1);
  return text;
}

const Unit* find_unit(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                  [&](const Unit& unit) { return unit.name == lower; });
  return found == kUnits.end() ? nullptr : &*found;
}

}  // namespace

std::optional<std::uint64_t> parse_size(std::string_view text) {
  text = without_spaces_around(text);
  // from_chars() would also take a sign, "inf" and "nan".
  if (text.empty() || text.front() < '0' || text.front() > '9')
    return std::nullopt;
  double number = 0;
  const auto [end, failure] =
      std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  if (failure != std::errc{})
    return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  const Unit* unit = find_unit(without_spaces_around(text));
  if (unit == nullptr || number * unit->bytes >= kLimit)
    return std::nullopt;
  return static_cast<std::uint64_t>(number * unit->bytes);
}

std::string exact_size_text(std::uint64_t bytes) {
  constexpr std::uint64_t kMega = 1'000'000;
  if (bytes != 0 && bytes % kMega == 0 && bytes % (std::uint64_t{1} << 20) != 0)
    return fmt::format("{}MB", bytes / kMega);
  std::size_t unit = 0;
  while (bytes != 0 && bytes % 1024 == 0 && unit + 1 < kBinaryUnits.size()) {
    bytes /= 1024;
    ++unit;
  }
  return fmt::format("{}{}", bytes, unit == 0 ? std::string_view() : kBinaryUnits[unit]);
}

std::string rounded_size_text(std::uint64_t bytes) {
  if (bytes < 1000)
    return fmt::format("{} B", bytes);
  double number = static_cast<double>(bytes);
  std::size_t unit = 0;
  // 999.5 would round to four digits.
  while (number >= 999.5 && unit + 1 < kBinaryUnits.size()) {
    number /= 1024;
    ++unit;
  }
  const int decimals = number < 9.995 ? 2 : number < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f} {}", number, decimals, kBinaryUnits[unit]);
}

std::string duration_text(double seconds) {
  if (seconds < 9.95)
    return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::llround(std::min(seconds, 1e9)));
  if (whole < 60)
    return fmt::format("{} s", whole);
  if (whole < 3600)
    return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace meshhier::execution
