#include "mesh_io/gdal_tags.h"

#include "base/small_letters.h"
#include "geodesy/raster_map.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint16_t kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003;

struct UnitName {
  std::string_view name;
  std::uint16_t code;  ///< in EPSG's list
};
constexpr std::array<UnitName, 12> kUnitNames{{{"m", kMetre},
                                               {"metre", kMetre},
                                               {"metres", kMetre},
                                               {"meter", kMetre},
                                               {"meters", kMetre},
                                               {"ft", kFoot},
                                               {"foot", kFoot},
                                               {"feet", kFoot},
                                               {"us-ft", kSurveyFoot},
                                               {"ftus", kSurveyFoot},
                                               {"us survey foot", kSurveyFoot},
                                               {"foot_us", kSurveyFoot}}};

std::string_view without_blank_ends(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// Returns the text of <Item ... role="ROLE" ...> of the first band.
std::string_view item_of(std::string_view metadata, std::string_view role) {
  const std::string wanted = "role=\"" + std::string(role) + '"';
  for (std::size_t at = 0; (at = metadata.find("<Item", at)) != std::string_view::npos; ++at) {
    const std::size_t end = metadata.find('>', at);
    if (end == std::string_view::npos)
      return {};
    const std::string_view head = metadata.substr(at, end - at);
    const bool is_other_band = head.find("sample=") != std::string_view::npos &&
                               head.find("sample=\"0\"") == std::string_view::npos;
    if (head.find(wanted) == std::string_view::npos || is_other_band)
      continue;
    return without_blank_ends(metadata.substr(end + 1, metadata.find('<', end) - end - 1));
  }
  return {};
}

double number_of(std::string_view text, double otherwise) {
  const auto number = parse_real<double>(text);
  return number && std::isfinite(*number) ? *number : otherwise;
}

}  // namespace

GdalTags read_gdal_tags(std::string_view metadata, std::string_view nodata) {
  GdalTags tags;
  tags.absent = parse_real<double>(without_blank_ends(nodata));
  tags.scale = number_of(item_of(metadata, "scale"), 1);
  tags.offset = number_of(item_of(metadata, "offset"), 0);
  const std::string unit = small_letters(item_of(metadata, "unittype"));
  const auto known = std::ranges::find(kUnitNames, unit, &UnitName::name);
  if (known != kUnitNames.end())
    tags.metres = geodesy::metres_of_unit(known->code);
  else
    tags.unknown_unit = unit;
  return tags;
}

}  // namespace meshhier::mesh_io
