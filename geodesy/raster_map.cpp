#include "geodesy/raster_map.h"

#include "base/error.h"
#include "geodesy/geo_key_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <fmt/format.h>

namespace meshhier::geodesy {
namespace {

/// Codes from here on are of nobody.
constexpr std::uint16_t kMostCode = 32766;
constexpr std::uint16_t kModelProjected = 1, kModelDegrees = 2, kModelGeocentric = 3;
constexpr std::uint16_t kIsPoint = 2;

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorCode::input, what);
}

struct UnitRow {
  std::uint16_t code;
  double size;
};

/// Lengths: metre, foot, US survey foot, Clarke's foot, fathom, nautical mile, kilometre, Indian
/// foot.
constexpr std::array<UnitRow, 8> kLengths{{{9001, 1},
                                           {9002, 0.3048},
                                           {9003, 1200.0 / 3937},
                                           {9005, 0.3047972654},
                                           {9014, 1.8288},
                                           {9030, 1852},
                                           {9036, 1000},
                                           {9080, 0.3047995102481469}}};
/// Angles in degrees: radian, degree, minute, second, gon (two codes).
constexpr std::array<UnitRow, 6> kAngles{{{9101, 180 / std::numbers::pi},
                                          {9102, 1},
                                          {9103, 1.0 / 60},
                                          {9104, 1.0 / 3600},
                                          {9105, 0.9},
                                          {9106, 0.9}}};

template <std::size_t count>
std::optional<double> size_of(const std::array<UnitRow, count>& rows, std::uint16_t code) {
  const auto found = std::ranges::find(rows, code, &UnitRow::code);
  return found == rows.end() ? std::nullopt : std::optional(found->size);
}

/// Reads keys by their numbers.
class Keys {
 public:
  explicit Keys(const GeoKeyTags& tags) : tags_(tags) {
    if (tags.directory.empty())
      return;
    if (tags.directory.size() < kEntry || tags.directory[0] != 1)
      fail("its GeoKeyDirectory has no head of version 1");
    count_ = tags.directory[kEntry - 1];
    if (tags.directory.size() < kEntry * (count_ + 1)) {
      fail(fmt::format("its GeoKeyDirectory would have {} keys, but ends before (truncated?)",
                       count_));
    }
  }

  std::optional<std::uint16_t> number(GeoKey key) const {
    const auto entry = find(key);
    return entry && (*entry)[1] == 0 ? std::optional((*entry)[3]) : std::nullopt;
  }

  std::optional<double> real(GeoKey key) const {
    const auto entry = find(key);
    if (!entry || (*entry)[1] != kGeoDoublesTag)
      return std::nullopt;
    if ((*entry)[3] >= tags_.doubles.size())
      fail(fmt::format("its key {} names a number that is not there", static_cast<int>(key)));
    return tags_.doubles[(*entry)[3]];
  }

  std::string_view text(GeoKey key) const {
    const auto entry = find(key);
    if (!entry || (*entry)[1] != kGeoTextTag)
      return {};
    const std::size_t count = (*entry)[2], first = (*entry)[3];
    if (first > tags_.text.size() || count > tags_.text.size() - first + 1)
      fail(fmt::format("its key {} names a text that is not there", static_cast<int>(key)));
    std::string_view text = tags_.text.substr(first, count);
    return text.substr(0, text.find_last_not_of(std::string_view("|\0", 2)) + 1);
  }

 private:
  static constexpr std::size_t kEntry = 4;  ///< number, tag, count, value or place

  std::optional<std::span<const std::uint16_t>> find(GeoKey key) const {
    for (std::size_t i = 1; i <= count_; ++i) {
      const auto entry = tags_.directory.subspan(i * kEntry, kEntry);
      if (entry[0] == key)
        return entry;
    }
    return std::nullopt;
  }

  const GeoKeyTags& tags_;
  std::size_t count_ = 0;
};

/// Returns the WKT that ESRI's programs write behind a mark of theirs.
std::string wkt_of(const Keys& keys) {
  constexpr std::string_view kMark = "ESRI PE String = ";
  for (const GeoKey key : {kProjectedCitation, kCitation}) {
    const std::string_view text = keys.text(key);
    const std::size_t at = text.find(kMark);
    if (at != std::string_view::npos)
      return std::string(text.substr(at + kMark.size()));
  }
  return {};
}

/// A code for heights that are not in metres, or that is none of a CRS.
struct VerticalRow {
  std::uint16_t code = 0;
  std::uint16_t in_metres = 0;  ///< the CRS of the same heights in metres; 0: there is none
  std::uint16_t unit = 0;       ///< its code; 0: not told
};
constexpr std::uint16_t kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003;
constexpr std::array<VerticalRow, 10> kVerticals{{{5102, 7968, 0},  // the datum of NGVD 29
                                                  {5103, 5703, 0},  // the datum of NAVD 88
                                                  {5702, 7968, kSurveyFoot},  // NGVD 29
                                                  {6130, 0, kFoot},           // the Caymans' three
                                                  {6131, 0, kFoot},
                                                  {6132, 0, kFoot},
                                                  {6360, 5703, kSurveyFoot},  // NAVD 88
                                                  {8050, 5714, kFoot},        // mean sea level
                                                  {8052, 5714, kSurveyFoot},
                                                  {8228, 5703, kFoot}}};  // NAVD 88

/// Returns what a key of heights stands for. Code 0: above the ellipsoid, or nobody knows above
/// what. Old files have codes of ellipsoids and of datums.
VerticalRow vertical_of(std::uint16_t code) {
  constexpr std::uint16_t kFirstEllipsoid = 5001, kLastDatum = 5106;
  const auto known = std::ranges::find(kVerticals, code, &VerticalRow::code);
  if (known != kVerticals.end())
    return *known;
  const bool is_none = code > kMostCode || (code >= kFirstEllipsoid && code <= kLastDatum);
  return is_none || code == 0 ? VerticalRow{} : VerticalRow{code, code, kMetre};
}

double unit_of(const Keys& keys, MapKind kind) {
  const bool is_length = kind == MapKind::lengths;
  const auto code = keys.number(is_length ? kLinearUnit : kAngularUnit);
  if (!code)
    return 1;
  if (*code == kUserDefined) {
    const auto size = keys.real(is_length ? kLinearUnitSize : kAngularUnitSize);
    if (!size || !std::isfinite(*size) || *size <= 0)
      fail("its keys define a unit without a size");
    return is_length ? *size : *size * 180 / std::numbers::pi;
  }
  const auto size = is_length ? metres_of_unit(*code) : size_of(kAngles, *code);
  if (!size)
    fail(fmt::format("its coordinates are in a unit that is not known (EPSG:{})", *code));
  return *size;
}

MapKind kind_of(const Keys& keys) {
  const std::uint16_t model = keys.number(kModelType).value_or(0);
  if (model == kModelGeocentric)
    fail("its cells lie in geocentric coordinates, which is no map");
  if (model == kModelProjected || (model == 0 && keys.number(kProjectedCrs)) ||
      wkt_of(keys).starts_with("PROJCS"))  // ESRI's programs tell no model beside it
    return MapKind::lengths;
  return model == kModelDegrees || keys.number(kGeodeticCrs) ? MapKind::degrees : MapKind::unknown;
}

void take_heights(const Keys& keys, RasterMap& found) {
  const VerticalRow vertical = vertical_of(keys.number(kVerticalCrs).value_or(0));
  if (const auto unit = keys.number(kVerticalUnit).value_or(vertical.unit); unit != 0)
    found.height_unit = metres_of_unit(unit);
  if (vertical.in_metres != 0 && found.crs.starts_with("EPSG:"))
    found.crs += fmt::format("+{}", vertical.in_metres);
}

}  // namespace

std::optional<double> metres_of_unit(std::uint16_t code) {
  return size_of(kLengths, code);
}

std::string horizontal_code(const std::string& crs) {
  return crs.starts_with("EPSG:") ? crs.substr(0, crs.find('+')) : crs;
}

RasterMap raster_map_of(const GeoKeyTags& tags) {
  const Keys keys(tags);
  RasterMap found;
  found.is_point = keys.number(kRasterType) == kIsPoint;
  found.kind = kind_of(keys);
  if (found.kind == MapKind::unknown)
    return found;
  found.unit = unit_of(keys, found.kind);
  const std::uint16_t code =
      keys.number(found.kind == MapKind::lengths ? kProjectedCrs : kGeodeticCrs).value_or(0);
  const std::string wkt = wkt_of(keys);
  found.is_user_defined = code == kUserDefined;
  if (code > 0 && code <= kMostCode)
    found.crs = fmt::format("EPSG:{}", code);
  else if (found.is_user_defined || !wkt.empty())
    found.crs = wkt;
  take_heights(keys, found);
  return found;
}

}  // namespace meshhier::geodesy
