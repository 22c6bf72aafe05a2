#include "geodesy/geo_keys.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace meshhier::geodesy {
namespace {

// Keys (GeoTIFF 1.1, annex B) and their values.
enum : std::uint16_t {
  kModelType = 1024,
  kRasterType = 1025,
  kCitation = 1026,
  kGeodeticCrs = 2048,
  kAngularUnits = 2054,
  kProjectedCrs = 3072,
  kProjectedCitation = 3073,
  kProjection = 3074,
  kProjectionMethod = 3075,
  kLinearUnits = 3076,
  kNaturalOriginLongitude = 3080,
  kNaturalOriginLatitude = 3081,
  kFalseEasting = 3082,
  kFalseNorthing = 3083,
  kScaleAtNaturalOrigin = 3092,
  kVerticalCrs = 4096
};
enum : std::uint16_t {
  kProjected = 1,
  kPixelIsArea = 1,
  kTransverseMercator = 1,
  kWgs84 = 4326,
  kMetre = 9001,
  kDegree = 9102,
  kUserDefined = 32767
};

/// Collects keys; they must come ascending.
class KeyWriter {
 public:
  void add(std::uint16_t key, std::uint16_t value) { add(key, 0, 1, value); }
  void add(std::uint16_t key, double value) {
    constexpr std::uint16_t kDoubles = 34736;
    add(key, kDoubles, 1, static_cast<std::uint16_t>(keys_.doubles.size()));
    keys_.doubles.push_back(value);
  }
  /// Texts end with "|", which none may hold.
  void add(std::uint16_t key, std::string text) {
    constexpr std::uint16_t kText = 34737;
    std::ranges::replace(text, '|', ' ');
    add(key, kText, static_cast<std::uint16_t>(text.size() + 1),
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

/// The length of a text that readers take; a longer WKT would be cut off.
constexpr std::size_t kLongestText = 2000;

}  // namespace

GeoKeys keys_of_map(const MapCode& code, bool has_heights) {
  KeyWriter keys;
  keys.add(kModelType, kProjected);
  keys.add(kRasterType, kPixelIsArea);
  keys.add(kCitation, code.name);
  keys.add(kProjectedCrs, code.horizontal == 0 ? std::uint16_t{kUserDefined} : code.horizontal);
  if (code.horizontal == 0 && code.wkt.size() <= kLongestText)
    keys.add(kProjectedCitation, "ESRI PE String = " + code.wkt);
  if (has_heights && code.vertical != 0)
    keys.add(kVerticalCrs, code.vertical);
  return keys.finish();
}

GeoKeys keys_of_plane(const LevelPlane& plane) {
  KeyWriter keys;
  keys.add(kModelType, kProjected);
  keys.add(kRasterType, kPixelIsArea);
  keys.add(kCitation, std::string("local plane"));
  keys.add(kGeodeticCrs, kWgs84);
  keys.add(kAngularUnits, kDegree);
  keys.add(kProjectedCrs, kUserDefined);
  keys.add(kProjection, kUserDefined);
  keys.add(kProjectionMethod, kTransverseMercator);
  keys.add(kLinearUnits, kMetre);
  keys.add(kNaturalOriginLongitude, plane.longitude);
  keys.add(kNaturalOriginLatitude, plane.latitude);
  keys.add(kFalseEasting, 0.0);
  keys.add(kFalseNorthing, 0.0);
  keys.add(kScaleAtNaturalOrigin, plane.scale);
  return keys.finish();
}

}  // namespace meshhier::geodesy
