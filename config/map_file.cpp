#include "config/map_file.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "base/text_mark.h"
#include "base/trimmed.h"
#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace meshhier::config {
namespace {

using Numbers = std::array<double, 3>;

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kModelMetadata = "<ModelMetadata";

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, what);
}

/// Takes the first part off `text`, up to one of `separators`, which goes too.
std::string_view take(std::string_view& text, std::string_view separators) {
  const std::size_t end = std::min(text.find_first_of(separators), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

/// Takes the first line that is not blank, without blanks around it.
std::string_view take_line(std::string_view& text) {
  std::string_view line;
  while (line.empty() && !text.empty())
    line = trimmed(take(text, "\r\n"), kBlanks);
  return line;
}

// ---- numbers

/// Parses two or three finite numbers and nothing else.
std::optional<Numbers> find_numbers(std::string_view text) {
  Numbers numbers{};
  std::size_t count = 0;
  while (!text.empty()) {
    const std::string_view word = take(text, " \t\r\n,;");
    if (word.empty())
      continue;
    const std::optional<double> number = mesh_io::parse_real<double>(word);
    if (!number || !std::isfinite(*number) || count == numbers.size())
      return std::nullopt;
    numbers[count++] = *number;
  }
  return count >= 2 ? std::optional(numbers) : std::nullopt;
}

Numbers numbers_of(std::string_view text, const std::string& what) {
  if (const std::optional<Numbers> numbers = find_numbers(text))
    return *numbers;
  refuse(fmt::format("expected two or three numbers {}, found {}", what, mesh_io::in_quotes(text)));
}

// ---- XML

/// Returns the text between the first <name> and its </name>.
std::optional<std::string_view> find_element(std::string_view xml, const std::string& name) {
  const std::string opening = '<' + name + '>';
  const std::size_t begin = xml.find(opening);
  if (begin == std::string_view::npos)
    return std::nullopt;
  xml.remove_prefix(begin + opening.size());
  const std::size_t end = xml.find("</" + name + '>');
  if (end == std::string_view::npos)
    refuse(fmt::format("<{}> has no end", name));
  return trimmed(xml.substr(0, end), kBlanks);
}

/// Replaces the five entities that every XML has by the characters that they stand for.
std::string without_entities(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&quot;", '"'}, {"&apos;", '\''}, {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}}};
  std::string plain;
  while (!text.empty()) {
    const auto entity = std::ranges::find_if(
        kEntities, [&](const auto& one) { return text.starts_with(one.first); });
    const bool found = entity != kEntities.end();
    plain += found ? entity->second : text[0];
    text.remove_prefix(found ? entity->first.size() : 1);
  }
  return plain;
}

/// Whether coordinates belong to no map: "LOCAL", "Local:0,0", nothing.
bool is_local(std::string_view srs) {
  return srs.empty() || small_letters(srs.substr(0, 5)) == "local";
}

/// Parses "ENU:latitude,longitude", perhaps with a height; nothing if it is a CRS.
std::optional<MapPlace> find_place(std::string_view text) {
  constexpr std::string_view kMark = "ENU:";
  if (!text.starts_with(kMark))
    return std::nullopt;
  const std::string_view place = text.substr(kMark.size());
  const std::optional<Numbers> numbers = find_numbers(place);
  if (!numbers || !(std::abs((*numbers)[0]) <= 90) || !(std::abs((*numbers)[1]) <= 180))
    refuse("expected a latitude and a longitude in degrees, found " + mesh_io::in_quotes(text));
  const bool has_height = std::ranges::count(place, ',') > 1;
  return MapPlace{(*numbers)[0], (*numbers)[1],
                  has_height ? std::optional((*numbers)[2]) : std::nullopt};
}

MapFile parse_xml(std::string_view xml) {
  MapFile file;
  if (const auto crs = find_element(xml, "SRS"); crs && !is_local(*crs)) {
    file.place = find_place(*crs);
    if (!file.place)
      file.crs = without_entities(*crs);
  } else {
    file.is_local = crs || xml.find(kModelMetadata) != std::string_view::npos;
  }
  if (const auto origin = find_element(xml, "SRSOrigin"))
    file.offset = numbers_of(*origin, "in <SRSOrigin>");
  if (!file.crs && !file.offset && !file.place && !file.is_local)
    refuse("expected XML with <SRS> and <SRSOrigin>, found neither");
  return file;
}

// ---- text

bool is_wkt(std::string_view text) {
  const std::size_t bracket = text.find_first_of("[(");
  return bracket != std::string_view::npos && bracket > 0 &&
         std::ranges::all_of(text.substr(0, bracket), [](char c) {
           return (c >= 'A' && c <= 'Z') || c == '_' || kBlanks.find(c) != std::string_view::npos;
         });
}

/// Returns the code of the zone that OpenDroneMap calls "WGS84 UTM 32N"; any other line as it is.
std::string crs_of_line(std::string_view line) {
  constexpr std::string_view kUtm = "WGS84 UTM ";
  constexpr int kMostZones = 60;
  if (!line.starts_with(kUtm) || (!line.ends_with('N') && !line.ends_with('S')))
    return std::string(line);
  const std::string_view digits = line.substr(kUtm.size(), line.size() - kUtm.size() - 1);
  const std::optional<std::int64_t> zone = mesh_io::parse_integer(trimmed(digits, kBlanks));
  if (!zone || *zone < 1 || *zone > kMostZones)
    refuse("expected a zone of UTM from 1 to 60, found " + mesh_io::in_quotes(line));
  return fmt::format("EPSG:32{}{:02}", line.ends_with('N') ? '6' : '7', *zone);
}

MapFile parse_lines(std::string_view text) {
  const std::string_view whole = text;
  const std::string_view first = take_line(text);
  if (find_numbers(first))
    return {std::nullopt, find_numbers(first)};
  if (const std::optional<Numbers> numbers = find_numbers(whole))  // a number a line
    return {std::nullopt, numbers};
  MapFile file{crs_of_line(first), std::nullopt};
  if (const std::string_view second = take_line(text); !second.empty())
    file.offset = numbers_of(second, "in the second line");
  return file;
}

}  // namespace

MapFile parse_map_file(std::string_view text) {
  text = trimmed(without_mark(text), kBlanks);
  if (text.empty())
    refuse("expected a CRS or an offset, found an empty file");
  if (text.starts_with('<'))
    return parse_xml(text);
  if (is_wkt(text))
    return {std::string(text), std::nullopt};
  return parse_lines(text);
}

}  // namespace meshhier::config
