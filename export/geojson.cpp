#include "export/geojson.h"

#include "base/text_mark.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/input_error.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

using GeoJson = nlohmann::json;

constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;
/// The parser's memory: a position takes some 200 bytes.
constexpr std::uint64_t kMostMemory = std::uint64_t{1} << 30;

class PolygonReader {
 public:
  explicit PolygonReader(const std::filesystem::path& path) : path_(path) {}

  std::vector<PlanPolygon> read(const GeoJson& document) {
    add(document);
    if (polygons_.empty())
      fail("has no polygon");
    return std::move(polygons_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { mesh_io::fail_file(path_, what); }

  /// The parser has a limit for depth.
  void add(const GeoJson& object) {
    if (!object.is_object())
      fail("is no GeoJSON: expected an object, found " + std::string(object.type_name()));
    const auto type = object.find("type");
    if (type == object.end() || !type->is_string())
      fail("is no GeoJSON: an object has no \"type\"");
    if (*type == "FeatureCollection")
      add_all(list_of(object, "features"));
    else if (*type == "GeometryCollection")
      add_all(list_of(object, "geometries"));
    else if (*type == "Feature" && object.contains("geometry") && !object["geometry"].is_null())
      add(object["geometry"]);
    else if (*type == "Polygon")
      add_polygon(list_of(object, "coordinates"));
    else if (*type == "MultiPolygon") {
      for (const GeoJson& polygon : list_of(object, "coordinates"))
        add_polygon(polygon);
    }
  }
  void add_all(const GeoJson& objects) {
    for (const GeoJson& object : objects)
      add(object);
  }

  const GeoJson& list_of(const GeoJson& object, const char* key) const {
    const auto list = object.find(key);
    if (list == object.end() || !list->is_array())
      fail(fmt::format("is no GeoJSON: {} has no list \"{}\"",
                       object["type"].get_ref<const std::string&>().substr(0, 40), key));
    return *list;
  }

  void add_polygon(const GeoJson& rings) {
    if (!rings.is_array())
      fail("is no GeoJSON: a polygon is no list of rings");
    PlanPolygon polygon;
    for (const GeoJson& ring : rings)
      polygon.push_back(ring_of(ring));
    if (!polygon.empty())
      polygons_.push_back(std::move(polygon));
  }

  PlanRing ring_of(const GeoJson& positions) const {
    PlanRing ring;
    if (positions.is_array()) {
      for (const GeoJson& position : positions)
        ring.push_back(position_of(position));
    }
    if (ring.size() > 1 && ring.front() == ring.back())
      ring.pop_back();
    if (ring.size() < 3)
      fail("has a ring of a polygon with fewer than three corners");
    return ring;
  }

  PlanPoint position_of(const GeoJson& position) const {
    if (!position.is_array() || position.size() < 2 || !position[0].is_number() ||
        !position[1].is_number())
      fail("has a position that is no list of numbers");
    const PlanPoint place{position[0].get<double>(), position[1].get<double>()};
    if (!std::isfinite(place.x) || !std::isfinite(place.y))
      fail("has a position that is not finite");
    return place;
  }

  const std::filesystem::path& path_;
  std::vector<PlanPolygon> polygons_;
};

/// Throws if it is one GeoJSON text a line, as GeoJSONSeq and the exports of databases are: the
/// first line is whole, and so is what begins the next one.
void refuse_lines(std::string_view text, const std::filesystem::path& path) {
  constexpr char kRecord = '\x1e';
  if (text.starts_with(kRecord))
    text.remove_prefix(1);
  const std::string_view first = text.substr(0, text.find('\n'));
  text.remove_prefix(first.size());
  const std::size_t next = text.find_first_not_of(" \t\r\n\x1e");
  if (next == std::string_view::npos || text[next] != '{' || !storage::is_json(first))
    return;
  mesh_io::fail_file(path,
                     "has one GeoJSON text a line, expected one for all; join them: ogr2ogr -f "
                     "GeoJSON new.geojson FILE, or jq -s "
                     "'{type: \"FeatureCollection\", features: .}' FILE");
}

/// Other formats, told by how a text in capitals begins.
struct OtherFormat {
  std::string_view begins, what;
};
constexpr std::string_view kConvert = "; convert it: ogr2ogr -f GeoJSON new.geojson FILE";
constexpr auto kOtherFormats = std::to_array<OtherFormat>({
    {"POLYGON", "is WKT"},
    {"MULTIPOLYGON", "is WKT"},
    {"GEOMETRYCOLLECTION", "is WKT"},
    {"CURVEPOLYGON", "is WKT"},
    {"MULTISURFACE", "is WKT"},
    {"LINESTRING", "is WKT, and a line"},
    {"MULTILINESTRING", "is WKT, and lines"},
    {"POINT", "is WKT, and a point"},
    {"MULTIPOINT", "is WKT, and points"},
    {"SRID=", "is WKT"},
    {"SQLITE FORMAT 3", "is a GeoPackage, or another database of SQLite"},
    {std::string_view("\0\0\x27\x0a", 4), "is a shapefile"},
    {"PK\x03\x04", "is a zip archive (perhaps KMZ, or a shapefile)"},
    {"<", "is XML (perhaps KML or GML)"},
});

/// The length of the longest of these.
constexpr std::size_t kLookedAt = 32;

[[noreturn]] void fail_other(const std::filesystem::path& path, std::string_view what) {
  const bool is_wkt = what.starts_with("is WKT");
  mesh_io::fail_file(
      path,
      fmt::format("{}, expected GeoJSON{}", what,
                  is_wkt ? R"(: {"type": "Polygon", "coordinates": [[[X, Y], ...]]})" : kConvert));
}

/// Throws if the text is something else that has polygons.
void refuse_other(std::string_view text, const std::filesystem::path& path) {
  text = without_mark(text);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  std::string start(text.substr(0, kLookedAt));
  for (char& c : start)
    c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  for (const OtherFormat& other : kOtherFormats) {
    if (start.starts_with(other.begins))
      fail_other(path, other.what);
  }
  if (text.starts_with('{') || text.starts_with('\x1e'))
    refuse_lines(text, path);
}

}  // namespace

std::vector<PlanPolygon> read_polygons(storage::FileSystem& files,
                                       const std::filesystem::path& path) {
  const auto file = files.open(path);
  const std::uint64_t bytes = file->size();
  if (bytes > kMostBytes)
    mesh_io::fail_file(
        path, fmt::format("has {} bytes, expected a GeoJSON of at most {}", bytes, kMostBytes));
  std::string text(bytes, '\0');
  file->read_exact(0, std::as_writable_bytes(std::span(text)));
  refuse_other(text, path);
  const GeoJson document = mesh_io::parse_gltf_json(std::move(text), path, kMostMemory);
  return PolygonReader(path).read(document);
}

}  // namespace meshhier::exporting
