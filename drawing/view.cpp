#include "drawing/view.h"

#include "base/error.h"

#include <cmath>

namespace meshhier::drawing {
namespace {

using exporting::MapFrame;

constexpr Vec3d kUp{0, 0, 1};

/// Returns the map turned so that `right` is u, `up` v, and what both make w. Unit axes change
/// nothing but the order of coordinates, which stay exact.
MapFrame turned(const MapFrame& map, Vec3d right, Vec3d up) {
  const std::array<Vec3d, 3> axes{right, up, cross(right, up)};
  MapFrame view = map;
  view.curve_east = view.curve_north = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    view.rows[i] = map.rows[0] * axes[i].x + map.rows[1] * axes[i].y + map.rows[2] * axes[i].z;
    (i == 0 ? view.shift.x : i == 1 ? view.shift.y : view.shift.z) = dot(axes[i], map.shift);
  }
  return view;
}

Vec3d unit_of(Vec3d vector, const char* fault) {
  const double size = length(vector);
  if (!(size > 0) || !std::isfinite(size))
    throw Error(ErrorCode::usage, fault);
  return vector * (1 / size);
}

Vec3d right_of(Side side) {
  constexpr std::array<Vec3d, 4> kRights{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}};
  return kRights[static_cast<std::size_t>(side)];
}

Sheet sheet_of_line(const MapFrame& map, const SectionLine& line) {
  const Vec3d from{line.from.x, line.from.y, 0}, to{line.to.x, line.to.y, 0};
  const Vec3d along =
      unit_of(to - from, "--section: its two points are one; give two that are apart");
  Sheet sheet{map, turned(map, along, kUp)};
  sheet.view.shift.x -= dot(along, from);
  sheet.plane = dot(cross(along, kUp), from);
  return sheet;
}

Sheet sheet_of_plane(const MapFrame& map, const SectionPlane& plane) {
  const Vec3d n =
      unit_of(plane.normal, "--plane: NX, NY and NZ are its direction, and must not all be 0");
  const Vec3d away = unit_of({dot(map.rows[0], n), dot(map.rows[1], n), dot(map.rows[2], n)},
                             "--plane: it has no direction on the map");
  const Vec3d towards{-away.x, -away.y, -away.z};
  // Seen from above or below the north is up.
  constexpr double kLevel = 1 - 1e-12;
  const bool is_level = std::abs(towards.z) > kLevel;
  const Vec3d upward = is_level ? Vec3d{0, 1, 0} : kUp - towards * towards.z;
  const Vec3d up = unit_of(upward, "--plane: it has no direction on the map");
  Sheet sheet{map, turned(map, cross(up, towards), up)};
  const Vec3d foot = n * (-plane.offset / length(plane.normal));
  sheet.plane = sheet.view.of_input(foot).z;
  return sheet;
}

}  // namespace

Sheet sheet_of(const storage::Manifest& manifest, const View& view) {
  const MapFrame map = exporting::map_frame(manifest);
  if (const auto* side = std::get_if<Side>(&view))
    return {map, turned(map, right_of(*side), kUp)};
  if (const auto* line = std::get_if<SectionLine>(&view))
    return sheet_of_line(map, *line);
  if (const auto* plane = std::get_if<SectionPlane>(&view))
    return sheet_of_plane(map, *plane);
  return {.map = map, .view = map, .is_plan = true};
}

}  // namespace meshhier::drawing
