#include "mesh_io/asc_head.h"

#include "base/small_letters.h"
#include "base/text_mark.h"
#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::string_view kAscHeadBlanks = " \t\r\n";
constexpr std::size_t kMostHeadBytes = 4096;

/// The words of a head, in small letters.
enum AscWord : std::uint8_t {
  kAscColumns,
  kAscRows,
  kAscXCorner,
  kAscYCorner,
  kAscXCentre,
  kAscYCentre,
  kAscCellSize,
  kAscCellWidth,
  kAscCellHeight,
  kAscAbsent,
  kAscWordCount
};
constexpr std::array<std::string_view, kAscWordCount> kAscWords = {
    "ncols",     "nrows",    "xllcorner", "yllcorner", "xllcenter",
    "yllcenter", "cellsize", "dx",        "dy",        "nodata_value"};

using AscNumbers = std::array<std::optional<double>, kAscWordCount>;

std::string_view take_asc_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kAscHeadBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kAscHeadBlanks));
  text.remove_prefix(word.size());
  return word;
}

/// Takes words and their numbers from the start of a text, up to a word that is none of a head.
AscNumbers take_asc_numbers(std::string_view& text, const std::filesystem::path& path) {
  AscNumbers numbers;
  for (;;) {
    std::string_view rest = text;
    const std::string word = small_letters(take_asc_word(rest));
    const auto known = std::ranges::find(kAscWords, word);
    if (known == kAscWords.end())
      return numbers;
    const std::string_view number = take_asc_word(rest);
    const auto value = parse_real<double>(number);
    const bool may_be_nan = word == kAscWords[kAscAbsent];
    if (!value || (!may_be_nan && !std::isfinite(*value))) {
      fail_file(path, fmt::format("expected a number behind \"{}\", found {}", word,
                                  number_in_quotes(number)));
    }
    numbers[static_cast<std::size_t>(known - kAscWords.begin())] = *value;
    text = rest;
  }
}

std::uint32_t side_of(const AscNumbers& numbers, AscWord word, const std::filesystem::path& path) {
  const double side = numbers[word].value_or(0);
  if (!(side >= 1) || side >= 0x1p32 || side != std::trunc(side)) {
    fail_file(path, fmt::format("expected \"{}\" and a whole number from 1 on, found {}",
                                kAscWords[word], side));
  }
  return static_cast<std::uint32_t>(side);
}

/// Returns the middle of the first cell of the last row on one axis.
double first_middle(const AscNumbers& numbers, AscWord corner, AscWord centre, double size,
                    const std::filesystem::path& path) {
  if (numbers[centre])
    return *numbers[centre];
  if (!numbers[corner]) {
    fail_file(path, fmt::format("expected \"{}\" or \"{}\" in the head", kAscWords[corner],
                                kAscWords[centre]));
  }
  return *numbers[corner] + size / 2;
}

/// Returns the size that the last UNIT of a WKT has.
double unit_size(std::string_view wkt) {
  const std::size_t unit = wkt.rfind("UNIT[");
  const std::size_t comma = unit == std::string_view::npos ? unit : wkt.find(',', unit);
  if (comma == std::string_view::npos)
    return 1;
  const std::string_view number = wkt.substr(comma + 1);
  const auto size = parse_real<double>(number.substr(0, number.find_first_of(",] \t\r\n")));
  return size && std::isfinite(*size) && *size > 0 ? *size : 1;
}

}  // namespace

AscHead read_asc_head(const storage::File& file) {
  std::string start(kMostHeadBytes, '\0');
  start.resize(file.read_at(0, std::as_writable_bytes(std::span(start))));
  std::string_view text = without_mark(start);
  const AscNumbers numbers = take_asc_numbers(text, file.path());
  AscHead head{.columns = side_of(numbers, kAscColumns, file.path()),
               .rows = side_of(numbers, kAscRows, file.path()),
               .map = {},
               .absent = numbers[kAscAbsent],
               .bytes = start.size() - text.size()};
  const double width = numbers[kAscCellSize].value_or(numbers[kAscCellWidth].value_or(0));
  const double height = numbers[kAscCellSize].value_or(numbers[kAscCellHeight].value_or(0));
  if (!(width > 0) || !(height > 0))
    fail_file(file.path(), "expected \"cellsize\" above 0 in the head");
  const double x = first_middle(numbers, kAscXCorner, kAscXCentre, width, file.path());
  const double y = first_middle(numbers, kAscYCorner, kAscYCentre, height, file.path());
  head.map = {{x, y + (head.rows - 1.0) * height}, {width, 0}, {0, -height}};
  return head;
}

geodesy::RasterMap keys_of_wkt(std::string_view text) {
  text = without_mark(text);
  text.remove_prefix(std::min(text.find_first_not_of(kAscHeadBlanks), text.size()));
  const std::string_view name = text.substr(0, text.find('['));
  constexpr std::array<std::string_view, 2> kLengths = {"PROJCS", "PROJCRS"};
  constexpr std::array<std::string_view, 3> kDegrees = {"GEOGCS", "GEOGCRS", "GEODCRS"};
  const auto is_in = [&](const auto& names) {
    return std::ranges::find(names, name) != names.end();
  };
  geodesy::RasterMap keys;
  if ((!is_in(kLengths) && !is_in(kDegrees)) || text.find(']') == std::string_view::npos)
    return keys;
  keys.kind = is_in(kLengths) ? geodesy::MapKind::lengths : geodesy::MapKind::degrees;
  keys.crs = text.substr(0, text.find_last_of(']') + 1);
  const double unit = unit_size(text);
  // Degrees are told in radians, with some of their digits.
  constexpr double kNear = 1e-9;
  const double degrees = unit * 180 / std::numbers::pi;
  keys.unit = keys.kind == geodesy::MapKind::lengths ? unit
              : std::abs(degrees - 1) < kNear        ? 1
                                                     : degrees;
  return keys;
}

}  // namespace meshhier::mesh_io
