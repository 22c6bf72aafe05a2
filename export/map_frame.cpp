#include "export/map_frame.h"

#include "base/angle.h"
#include "base/wgs84.h"
#include "config/placement.h"
#include "export/manifest_config.h"
#include "geodesy/map_code.h"
#include "geodesy/map_projection.h"
#include "hierarchy/frame.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

using storage::Manifest;

/// The input's axes, z-up.
std::array<Vec3d, 3> z_up_axes(UpAxis up) {
  return {to_z_up({1, 0, 0}, up), to_z_up({0, 1, 0}, up), to_z_up({0, 0, 1}, up)};
}

/// Rows of the matrix that has these images of the axes as its columns.
std::array<Vec3d, 3> transposed(const std::array<Vec3d, 3>& columns) {
  const auto& [a, b, c] = columns;
  return {Vec3d{a.x, b.x, c.x}, Vec3d{a.y, b.y, c.y}, Vec3d{a.z, b.z, c.z}};
}

MapFrame frame_of_input(const Manifest& manifest) {
  return {.rows = transposed(z_up_axes(manifest.up)), .origin = manifest.origin};
}

std::string name_of(const geodesy::MapCode& code) {
  if (code.horizontal == 0) {
    const bool is_told = !keys_of_map(code, false).directory.empty();
    return (code.name == "unknown" ? "the map of its \"placement\"" : code.name) +
           (is_told ? "" : " (GeoTIFF cannot name it, so the files have no map)");
  }
  const std::string heights = code.vertical == 0 ? "" : fmt::format("+{}", code.vertical);
  return fmt::format("EPSG:{}{} ({})", code.horizontal, heights, code.name);
}

MapFrame frame_of_map(const Manifest& manifest, const std::string& crs,
                      const geodesy::MappedModel& model) {
  MapFrame frame = frame_of_input(manifest);
  for (Vec3d& row : frame.rows)
    row = row * model.scale;
  frame.shift = model.offset;
  const geodesy::MapCode code = geodesy::map_code(crs);
  frame.picture_keys = keys_of_map(code, false);
  frame.height_keys = keys_of_map(code, true);
  frame.name = name_of(code);
  return frame;
}

/// A point on the ellipsoid, with what is level there.
struct GroundPoint {
  double longitude = 0, latitude = 0;  ///< degrees
  Vec3d east{}, north{}, up{};
  Vec3d foot{};                              ///< geocentric
  double radius_east = 0, radius_north = 0;  ///< of curvature
};

GroundPoint point_at(double longitude, double latitude) {
  constexpr double kRadians = std::numbers::pi / 180;
  const UnitTurn l = turn_by(longitude * kRadians), f = turn_by(latitude * kRadians);
  GroundPoint level{longitude, latitude, {}, {}, {}, {}};
  level.east = {-l.sine, l.cosine, 0};
  level.up = wgs84::up_at(l, f);
  level.north = cross(level.up, level.east);
  level.foot = wgs84::geocentric(l, f, 0);
  const double rest = 1 - wgs84::kEccentricity2 * f.sine * f.sine;
  level.radius_east = wgs84::kEquator / std::sqrt(rest);
  level.radius_north = level.radius_east * (1 - wgs84::kEccentricity2) / rest;
  return level;
}

/// Rounded to a centimetre: whole numbers for the file.
double rounded_degrees(double radians) {
  constexpr double kParts = 1e7;
  return std::round(radians * 180 / std::numbers::pi * kParts) / kParts;
}

/// The angle of a direction, -pi to pi.
double signed_angle(double x, double y) {
  return y < 0 ? -angle_of(x, -y) : angle_of(x, y);
}

/// Returns the point below or above a geocentric place (Bowring 1976, near the ground exact to less
/// than the rounding).
GroundPoint point_below(Vec3d place) {
  constexpr double kSecond = wgs84::kEccentricity2 / (1 - wgs84::kEccentricity2);
  const double across = std::sqrt(place.x * place.x + place.y * place.y);
  const double x = across * wgs84::kPole, y = place.z * wgs84::kEquator;
  const double size = std::sqrt(x * x + y * y), cosine = x / size, sine = y / size;
  const double latitude =
      signed_angle(across - wgs84::kEccentricity2 * wgs84::kEquator * cosine * cosine * cosine,
                   place.z + kSecond * wgs84::kPole * sine * sine * sine);
  return point_at(rounded_degrees(signed_angle(place.x, place.y)), rounded_degrees(latitude));
}

/// A transform from z-up coordinates of the input to geocentric ones.
struct OnGlobe {
  std::array<Vec3d, 3> axes{};
  Vec3d shift{};

  explicit OnGlobe(const Transform& m) {
    for (std::size_t i = 0; i < 3; ++i)
      axes[i] = {m[4 * i], m[4 * i + 1], m[4 * i + 2]};
    shift = {m[12], m[13], m[14]};
  }
  Vec3d turned(Vec3d z_up) const { return axes[0] * z_up.x + axes[1] * z_up.y + axes[2] * z_up.z; }
  /// Whether it puts a place near the ground.
  bool is_at_ground(Vec3d place) const {
    constexpr double kLowest = 6.3e6, kHighest = 6.45e6;
    const double away = length(place);
    return away > kLowest && away < kHighest && dot(axes[0], cross(axes[1], axes[2])) != 0;
  }
};

/// Returns nothing if the transform leads to no place on the globe.
std::optional<MapFrame> frame_on_globe(const Manifest& manifest, const Transform& transform) {
  const OnGlobe globe(transform);
  const BoundsD& box = manifest.source.bounds;
  const Vec3d middle = globe.turned(to_z_up((box.min + box.max) * 0.5, manifest.up)) + globe.shift;
  if (!globe.is_at_ground(middle))
    return std::nullopt;
  const GroundPoint level = point_below(middle);
  const double height = dot(level.up, middle - level.foot);
  const auto in_plane = [&](Vec3d v) {
    return Vec3d{dot(level.east, v), dot(level.north, v), dot(level.up, v)};
  };
  std::array<Vec3d, 3> axes = z_up_axes(manifest.up);
  for (Vec3d& axis : axes)
    axis = in_plane(globe.turned(axis));
  MapFrame frame{.rows = transposed(axes),
                 .shift = in_plane(globe.shift - level.foot),
                 .origin = manifest.origin,
                 .curve_east = 1 / (2 * (level.radius_east + height)),
                 .curve_north = 1 / (2 * (level.radius_north + height))};
  const double radius = std::sqrt(level.radius_east * level.radius_north);
  frame.picture_keys = frame.height_keys =
      geodesy::keys_of_plane({level.longitude, level.latitude, (radius + height) / radius});
  frame.name = fmt::format("a plane that is level at longitude {:.7f}, latitude {:.7f}",
                           level.longitude, level.latitude);
  frame.is_on_globe = true;
  return frame;
}

}  // namespace

BoundsD MapFrame::around(const BoundsD& box) const {
  BoundsD all;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d place{corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                      corner & 4 ? box.max.z : box.min.z};
    all.add(of_input(place + origin));
  }
  return all;
}

MapFrame map_frame(const Manifest& manifest) {
  const config::Config config = config_of(manifest);
  if (const auto& crs = config.placement.crs) {
    const geodesy::MapProjection projection(*crs);
    if (!projection.heights().empty())  // else its coordinates are those of the globe
      return frame_of_map(manifest, *crs,
                          config::mapped_model(config, manifest.source.bounds, projection));
  }
  if (manifest.transform) {
    if (const auto frame = frame_on_globe(manifest, *manifest.transform))
      return *frame;
  }
  return frame_of_input(manifest);
}

}  // namespace meshhier::exporting
