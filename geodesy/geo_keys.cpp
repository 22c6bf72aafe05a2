#include "geodesy/geo_keys.h"

#include "geodesy/geo_key_numbers.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace meshhier::geodesy {
namespace {

// Values of keys.
constexpr std::uint16_t kProjected = 1, kPixelIsArea = 1, kWgs84 = 4326, kMetreUnit = 9001,
                        kDegreeUnit = 9102;

/// What EPSG's code is in GeoTIFF: of methods the value, of parameters the key.
struct CodePair {
  int epsg = 0;
  std::uint16_t geotiff = 0;
};
constexpr int kTransverseMercator = 9807, kLatitudeOfOrigin = 8801, kLongitudeOfOrigin = 8802,
              kScaleAtOrigin = 8805, kFalseEasting = 8806, kFalseNorthing = 8807;
constexpr auto kMethods = std::to_array<CodePair>({
    {kTransverseMercator, 1},
    {9804, 7},   // Mercator (variant A)
    {9802, 8},   // Lambert Conic Conformal (2SP)
    {9801, 9},   // Lambert Conic Conformal (1SP)
    {9820, 10},  // Lambert Azimuthal Equal Area
    {9822, 11},  // Albers Equal Area
    {9810, 15},  // Polar Stereographic (variant A)
    {9809, 16},  // Oblique Stereographic
});
constexpr auto kParameters = std::to_array<CodePair>({
    {8823, 3078},  // latitude of the first standard parallel
    {8824, 3079},  // of the second one
    {kLongitudeOfOrigin, 3080},
    {kLatitudeOfOrigin, 3081},
    {kFalseEasting, 3082},
    {kFalseNorthing, 3083},
    {8822, 3084},  // longitude of the false origin
    {8821, 3085},  // its latitude
    {8826, 3086},  // easting there
    {8827, 3087},  // northing
    {kScaleAtOrigin, 3092},
});
static_assert(std::ranges::is_sorted(kParameters, {}, &CodePair::geotiff));

/// Returns 0 if there is none.
std::uint16_t geotiff_method(int epsg) {
  const auto* const found = std::ranges::find(kMethods, epsg, &CodePair::epsg);
  return found == kMethods.end() ? std::uint16_t{0} : found->geotiff;
}

/// Collects keys; they must come ascending.
class KeyWriter {
 public:
  void add(std::uint16_t key, std::uint16_t value) { add(key, 0, 1, value); }
  void add(std::uint16_t key, double value) {
    add(key, kGeoDoublesTag, 1, static_cast<std::uint16_t>(keys_.doubles.size()));
    keys_.doubles.push_back(value);
  }
  /// Texts end with "|", which none may hold.
  void add(std::uint16_t key, std::string text) {
    std::ranges::replace(text, '|', ' ');
    add(key, kGeoTextTag, static_cast<std::uint16_t>(text.size() + 1),
        static_cast<std::uint16_t>(keys_.text.size()));
    keys_.text += text + '|';
  }
  GeoKeys finish() {
    constexpr std::uint16_t kVersion = 1, kRevision = 1, kMinor = 1;
    keys_.directory.insert(
        keys_.directory.begin(),
        {kVersion, kRevision, kMinor, static_cast<std::uint16_t>(keys_.directory.size() / 4)});
    return std::move(keys_);
  }

 private:
  void add(std::uint16_t key, std::uint16_t place, std::uint16_t count, std::uint16_t value) {
    keys_.directory.insert(keys_.directory.end(), {key, place, count, value});
  }

  GeoKeys keys_;
};

void add_geodetic(KeyWriter& keys, const MapMethod& map) {
  keys.add(kGeodeticCrs, map.geodetic == 0 ? std::uint16_t{kUserDefined} : map.geodetic);
  if (map.geodetic == 0)
    keys.add(kDatum, kUserDefined);
  keys.add(kAngularUnit, kDegreeUnit);
  if (map.geodetic != 0)
    return;
  keys.add(kOwnEllipsoid, kUserDefined);
  keys.add(kSemiMajorAxis, map.equator);
  keys.add(kInverseFlattening, map.inverse_flattening);
}

/// Adds a map by its method; requires that GeoTIFF knows that.
void add_method(KeyWriter& keys, const MapMethod& map) {
  add_geodetic(keys, map);
  keys.add(kProjectedCrs, kUserDefined);
  keys.add(kProjection, kUserDefined);
  keys.add(kProjectionMethod, geotiff_method(map.method));
  keys.add(kLinearUnit, map.unit_metres == 1 ? kMetreUnit : kUserDefined);
  if (map.unit_metres != 1)
    keys.add(kLinearUnitSize, map.unit_metres);
  for (const CodePair& row : kParameters) {
    const auto found = std::ranges::find(map.parameters, row.epsg, &MapMethod::Parameter::code);
    if (found != map.parameters.end())
      keys.add(row.geotiff, found->value);
  }
}

KeyWriter begun(const std::string& name) {
  KeyWriter keys;
  keys.add(kModelType, kProjected);
  keys.add(kRasterType, kPixelIsArea);
  keys.add(kCitation, name);
  return keys;
}

}  // namespace

GeoKeys keys_of_map(const MapCode& code, bool has_heights) {
  KeyWriter keys = begun(code.name);
  if (code.horizontal != 0)
    keys.add(kProjectedCrs, code.horizontal);
  else if (geotiff_method(code.method.method) != 0)
    add_method(keys, code.method);
  else
    return {};
  if (has_heights && code.vertical != 0)
    keys.add(kVerticalCrs, code.vertical);
  return keys.finish();
}

GeoKeys keys_of_plane(const LevelPlane& plane) {
  KeyWriter keys = begun("local plane");
  add_method(keys, {.method = kTransverseMercator,
                    .parameters = {{kLongitudeOfOrigin, plane.longitude},
                                   {kLatitudeOfOrigin, plane.latitude},
                                   {kFalseEasting, 0},
                                   {kFalseNorthing, 0},
                                   {kScaleAtOrigin, plane.scale}},
                    .geodetic = kWgs84});
  return keys.finish();
}

}  // namespace meshhier::geodesy
