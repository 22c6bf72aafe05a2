#include "inspection/geojson.h"

#include "mesh_io/gltf_json.h"
#include "mesh_io/input_error.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::inspection {
namespace {

using GeoJson = nlohmann::json;

constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;
/// For the parser: a position takes some 200 bytes.
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
  const GeoJson document = mesh_io::parse_gltf_json(std::move(text), path, kMostMemory);
  return PolygonReader(path).read(document);
}

}  // namespace meshhier::inspection
