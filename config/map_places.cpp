#include "config/map_places.h"

#include "base/error.h"
#include "config/placement.h"

namespace meshhier::config {
namespace {

constexpr const char* kDegrees = "EPSG:4326";
constexpr const char* kDegreesAndHeight = "EPSG:4979";
constexpr const char* kGeocentric = "EPSG:4978";

Vec3d column_of(const Transform& m, std::size_t column) {
  return {m[4 * column], m[4 * column + 1], m[4 * column + 2]};
}

Vec3d to_globe(const Transform& m, Vec3d p) {
  return column_of(m, 0) * p.x + column_of(m, 1) * p.y + column_of(m, 2) * p.z + column_of(m, 3);
}

/// Inverts to_globe(), by Cramer's rule.
Vec3d from_globe(const Transform& m, Vec3d place) {
  const Vec3d x = column_of(m, 0), y = column_of(m, 1), z = column_of(m, 2);
  const Vec3d from = place - column_of(m, 3);
  const double determinant = dot(x, cross(y, z));
  return Vec3d{dot(from, cross(y, z)), dot(from, cross(z, x)), dot(from, cross(x, y))} *
         (1 / determinant);
}

}  // namespace

MapPlaces::MapPlaces(const Config& config, const BoundsD& bounds,
                     const std::optional<Transform>& transform, const std::string& crs)
    : change_(crs, config.placement.crs.value_or(kDegrees)) {
  const PlacementConfig& place = config.placement;
  if (place.crs) {
    model_ = mapped_model(config, bounds, geodesy::MapProjection(*place.crs));
    return;
  }
  if (!transform || dot(column_of(*transform, 0),
                        cross(column_of(*transform, 1), column_of(*transform, 2))) == 0) {
    throw Error(ErrorCode::usage,
                "the hierarchy stands on no map, so that a CRS says nothing; give coordinates of "
                "the input, without --crs");
  }
  const Vec3d middle = to_z_up((bounds.min + bounds.max) * 0.5, config.up_axis());
  const geodesy::MapChange to_degrees(kGeocentric, kDegreesAndHeight);
  globe_.emplace(OnGlobe{geodesy::MapChange(kDegreesAndHeight, kGeocentric),
                         to_degrees(to_globe(*transform, middle)).z, *transform});
}

Vec3d MapPlaces::to_input(double x, double y) const {
  const Vec3d place = change_({x, y, 0});
  if (!globe_)
    return model_.from_map(place);
  return from_globe(globe_->transform, globe_->to_geocentric({place.x, place.y, globe_->height}));
}

}  // namespace meshhier::config
