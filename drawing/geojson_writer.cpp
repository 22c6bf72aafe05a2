#include "base/error.h"
#include "drawing/line_formats.h"
#include "export/manifest_config.h"
#include "geodesy/map_change.h"
#include "geodesy/map_projection.h"

#include <functional>
#include <optional>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

/// A place as it is written: longitude, latitude and metres, or the model's own coordinates.
/// `height`: what the level says that it has, if it does.
using PlaceOf = std::function<std::string(Vec3d place, std::optional<double> height)>;

/// A tenth of a millimetre.
constexpr const char* kDegrees = "{:.9f},{:.9f},{:.4f}";

PlaceOf places_on_map(const LineDrawing& drawing, const std::string& crs) {
  const auto change = std::make_shared<geodesy::MapChange>(crs, "EPSG:4326");
  change->settle_at(drawing.sheet.map.of_input(
      (drawing.manifest.source.bounds.min + drawing.manifest.source.bounds.max) * 0.5));
  return [&drawing, change](Vec3d place, std::optional<double> height) {
    const Vec3d map = drawing.sheet.map.of_input(place);
    const Vec3d globe = (*change)(map);
    return fmt::format(fmt::runtime(kDegrees), globe.x, globe.y,
                       height.value_or(map.z) * drawing.unit.metres);
  };
}

PlaceOf places_on_globe(const LineDrawing& drawing, const Transform& m) {
  const auto geocentric = std::make_shared<geodesy::MapProjection>("EPSG:4978");
  const UpAxis up = drawing.manifest.up;
  return [geocentric, m, up](Vec3d place, std::optional<double>) {
    const Vec3d p = to_z_up(place, up);
    const geodesy::Geodetic at = geocentric->to_geodetic(
        {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12], m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
         m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]});
    return fmt::format(fmt::runtime(kDegrees), at.longitude, at.latitude, at.height);
  };
}

PlaceOf places_of(const LineDrawing& drawing) {
  if (const auto crs = exporting::config_of(drawing.manifest).placement.crs)
    return places_on_map(drawing, *crs);
  if (drawing.sheet.map.is_on_globe)
    return places_on_globe(drawing, *drawing.manifest.transform);
  return [&drawing](Vec3d place, std::optional<double> height) {
    const Vec3d p = drawing.sheet.map.of_input(place);
    return fmt::format("{},{},{}", p.x, p.y, height.value_or(p.z));
  };
}

class GeoJsonWriter final : public LineWriter {
 public:
  GeoJsonWriter(const LineDrawing& drawing, exporting::ByteStream& out)
      : drawing_(drawing), out_(out), place_of_(places_of(drawing)) {
    out_.put("{\"type\":\"FeatureCollection\",");
    if (!has_place_on_globe(drawing.manifest))
      out_.put("\"coordinates_of\":\"the model, as it has no place on the globe\",");
    out_.put("\"features\":[");
  }

  void begin(const JoinedLine& line) override {
    const CutLevel& level = drawing_.levels[line.level];
    const char* name = drawing_.sheet.is_plan ? "elevation" : "distance";
    out_.put(fmt::format(
        "{}\n{{\"type\":\"Feature\",\"properties\":{{\"{}\":{},\"index\":{},\"closed\":{}}},"
        "\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[",
        is_first_ ? "" : ",", name, level_text(level.height), level.is_index, line.is_closed));
    is_first_ = false;
    is_closed_ = line.is_closed;
    first_.clear();
    if (drawing_.sheet.is_plan)
      height_ = level.height;
  }
  void point(Vec3d place) override {
    const std::string text = place_of_(place, height_);
    out_.put(fmt::format("{}[{}]", first_.empty() ? "" : ",", text));
    if (first_.empty())
      first_ = text;
  }
  void end() override {
    if (is_closed_)
      out_.put(fmt::format(",[{}]", first_));
    out_.put("]}}");
  }
  void finish() override { out_.put("\n]}\n"); }

 private:
  const LineDrawing& drawing_;
  exporting::ByteStream& out_;
  PlaceOf place_of_;
  std::string first_{};
  std::optional<double> height_{};
  bool is_first_ = true, is_closed_ = false;
};

}  // namespace

std::unique_ptr<LineWriter> geojson_writer(const LineDrawing& drawing, exporting::ByteStream& out) {
  return std::make_unique<GeoJsonWriter>(drawing, out);
}

}  // namespace meshhier::drawing
