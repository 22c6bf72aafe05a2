#include "geodesy/map_projection.h"

#include "base/plain_text.h"
#include "geodesy/proj_objects.h"

#include <utility>

#include <fmt/format.h>

namespace meshhier::geodesy {

// Not in a nameless namespace: MapProjection::Parts is made of it.
namespace proj {

struct Axes {
  PJ_COORDINATE_SYSTEM_TYPE type = PJ_CS_TYPE_UNKNOWN;
  int count = 0;
  double metres = 1;  ///< metres of the first axis' unit
};

}  // namespace proj

namespace {

using proj::Axes;
using proj::Context;
using proj::horizontal_part;
using proj::in_quotes;
using proj::kLongestQuote;
using proj::library;
using proj::make_context;
using proj::make_crs;
using proj::Object;
using proj::refuse;

Axes axes_of(PJ_CONTEXT* context, const PJ* part) {
  const Object system(library().crs_get_coordinate_system(context, part));
  if (!system)
    return {};
  Axes axes{library().cs_get_type(context, system.get()),
            library().cs_get_axis_count(context, system.get())};
  library().cs_get_axis_info(context, system.get(), 0, nullptr, nullptr, nullptr, &axes.metres,
                             nullptr, nullptr, nullptr);
  return axes;
}

void check_axes(const Axes& axes, const std::string& text) {
  if (axes.type == PJ_CS_TYPE_ELLIPSOIDAL || axes.type == PJ_CS_TYPE_SPHERICAL) {
    refuse(in_quotes(text) +
           " has degrees as coordinates, and a model in degrees is no shape; export the model in "
           "a projected CRS, such as UTM (\"EPSG:32633\"), or in a local one");
  }
}

/// Returns null if PROJ has no change. `ballpark`: also changes that leave out a part that PROJ
/// does not know.
Object to_wgs84(PJ_CONTEXT* context, const PJ* crs, bool ballpark) {
  const Object target(library().create(context, "EPSG:4978"));
  const char* options[] = {ballpark ? "ALLOW_BALLPARK=YES" : "ALLOW_BALLPARK=NO", nullptr};
  const Object operation(
      library().create_crs_to_crs_from_pj(context, crs, target.get(), nullptr, options));
  return Object(operation ? library().normalize_for_visualization(context, operation.get())
                          : nullptr);
}

/// Without the grid for its heights PROJ would leave out the datum of a compound CRS, too, which
/// may be a hundred metres.
Object make_operation(PJ_CONTEXT* context, const PJ* crs, const std::string& text) {
  const bool has_heights = library().get_type(crs) == PJ_TYPE_COMPOUND_CRS;
  Object operation = to_wgs84(context, crs, false);
  if (!operation && has_heights) {
    refuse("PROJ has no grid for the heights of " + in_quotes(text) +
           "; put the grid into PROJ's folder (projsync gets them), or give the horizontal CRS "
           "alone and add the geoid's height to the third number of \"offset\"");
  }
  if (!operation)
    operation = to_wgs84(context, crs, true);
  if (!operation)
    refuse(in_quotes(text) + " is a CRS without places on the globe; PROJ cannot transform it");
  return operation;
}

Object make_geodetic(PJ_CONTEXT* context) {
  const Object operation(library().create_crs_to_crs(context, "EPSG:4978", "EPSG:4979", nullptr));
  return Object(library().normalize_for_visualization(context, operation.get()));
}

}  // namespace

struct MapProjection::Parts {
  Context context;
  Object crs;
  Axes axes;         ///< axes of its horizontal part
  Object operation;  ///< the way to geocentric coordinates
  Object geodetic;   ///< the way from these to degrees
  std::string name;

  /// Metres in a unit of height: without a vertical part PROJ takes metres, the map has its own
  /// unit.
  double height_metres() const {
    const bool is_flat = axes.type == PJ_CS_TYPE_CARTESIAN && axes.count == 2 &&
                         library().get_type(crs.get()) != PJ_TYPE_COMPOUND_CRS;
    return is_flat ? axes.metres : 1;
  }
};

MapProjection::MapProjection(const std::string& crs) : parts_(std::make_unique<Parts>()) {
  Parts& parts = *parts_;
  parts.context = make_context();
  PJ_CONTEXT* context = parts.context.get();
  parts.crs = make_crs(context, crs);
  parts.axes = axes_of(context, horizontal_part(context, parts.crs.get()).get());
  check_axes(parts.axes, crs);
  parts.operation = make_operation(context, parts.crs.get(), crs);
  parts.geodetic = make_geodetic(context);
  parts.name = plain_text(library().get_name(parts.crs.get()), kLongestQuote);
}

MapProjection::~MapProjection() = default;
MapProjection::MapProjection(MapProjection&&) noexcept = default;
MapProjection& MapProjection::operator=(MapProjection&&) noexcept = default;

void MapProjection::settle_at(Vec3d map) {
  to_geocentric(map);
  Object used(library().trans_get_last_used_operation(parts_->operation.get()));
  if (used)
    parts_->operation = std::move(used);
}

Vec3d MapProjection::to_geocentric(Vec3d map) const {
  PJ* operation = parts_->operation.get();
  library().errno_reset(operation);
  const PJ_COORD from = library().coord(map.x, map.y, map.z * parts_->height_metres(), 0);
  const PJ_COORD to = library().trans(operation, PJ_FWD, from);
  const Vec3d place{to.xyz.x, to.xyz.y, to.xyz.z};
  if (!is_finite(place)) {
    refuse(fmt::format(
        "the point {} {} {} of {} has no place on the globe, as far as PROJ can tell; is an "
        "\"offset\" missing, or \"up\": \"z\"?",
        map.x, map.y, map.z, parts_->name));
  }
  return place;
}

Geodetic MapProjection::to_geodetic(Vec3d p) const {
  const PJ_COORD to =
      library().trans(parts_->geodetic.get(), PJ_FWD, library().coord(p.x, p.y, p.z, 0));
  return {to.xyz.x, to.xyz.y, to.xyz.z};
}

double MapProjection::unit_metres() const {
  return parts_->axes.metres;
}

const std::string& MapProjection::name() const {
  return parts_->name;
}

std::string MapProjection::heights() const {
  const Object vertical = proj::vertical_part(parts_->context.get(), parts_->crs.get());
  if (vertical)
    return plain_text(library().get_name(vertical.get()), kLongestQuote);
  constexpr int kGeocentricAxes = 3;
  const bool is_geocentric = parts_->axes.count == kGeocentricAxes &&
                             library().get_type(parts_->crs.get()) == PJ_TYPE_GEOCENTRIC_CRS;
  return is_geocentric ? "" : std::string(kEllipsoid);
}

double MapProjection::accuracy() const {
  return library().pj_info(parts_->operation.get()).accuracy;
}

bool MapProjection::takes_datum_as_wgs84() const {
  return library().coordoperation_has_ballpark_transformation(parts_->context.get(),
                                                              parts_->operation.get()) != 0;
}

bool MapProjection::is_meant_for(const Geodetic& place) const {
  double west = 0, south = 0, east = 0, north = 0;
  const int known = library().get_area_of_use(parts_->context.get(), parts_->crs.get(), &west,
                                              &south, &east, &north, nullptr);
  if (known == 0 || west < -180)  // -1000: not known
    return true;
  const bool in_longitude = west <= east ? place.longitude >= west && place.longitude <= east
                                         : place.longitude >= west || place.longitude <= east;
  return in_longitude && place.latitude >= south && place.latitude <= north;
}

}  // namespace meshhier::geodesy
