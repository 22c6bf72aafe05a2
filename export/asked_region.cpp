#include "export/asked_region.h"

#include "base/error.h"
#include "config/config.h"
#include "config/map_places.h"
#include "export/geojson.h"
#include "export/manifest_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::exporting {
namespace {

using storage::HierarchyReader;

void require_box(const BoundsD& box) {
  const auto is_range = [](double a, double b) {
    return std::isfinite(a) && std::isfinite(b) && a <= b;
  };
  if (!is_range(box.min.x, box.max.x) || !is_range(box.min.y, box.max.y) ||
      !is_range(box.min.z, box.max.z))
    throw Error(ErrorCode::usage,
                "the box is none: each number of its first corner is at most that "
                "of the second one");
}

/// Moves polygons from places of the map, or of the input, to those of the region.
void move(std::vector<PlanPolygon>& polygons, const HierarchyReader& reader,
          const std::optional<config::MapPlaces>& map) {
  const PlanPoint origin = plan_of(reader.manifest().origin, reader.manifest().up);
  for (PlanPolygon& polygon : polygons) {
    for (PlanRing& ring : polygon) {
      for (PlanPoint& p : ring) {
        if (map) {
          const Vec3d found = map->to_input(p.x, p.y);
          p = {found.x, found.y};
        }
        p = {p.x - origin.x, p.y - origin.y};
      }
    }
  }
}

/// Returns the part of space between two heights.
ConvexRegion layer_of(const BoundsD& box, const storage::Manifest& manifest) {
  const Vec3d up = direction_of(manifest.up);
  const double below = dot(up, manifest.origin);
  return ConvexRegion({{up * -1.0, below - box.min.z}, {up, box.max.z - below}});
}

PlanPolygon rectangle_of(const BoundsD& box) {
  return {{{box.min.x, box.min.y},
           {box.max.x, box.min.y},
           {box.max.x, box.max.y},
           {box.min.x, box.max.y}}};
}

}  // namespace

std::string RegionRequest::name() const {
  std::vector<std::string_view> parts;
  if (box)
    parts.emplace_back("box");
  if (!polygon.empty())
    parts.emplace_back("polygon");
  if (objects.is_any())
    parts.emplace_back("objects");
  return fmt::format("{}", fmt::join(parts, " and "));
}

Region region_of(storage::FileSystem& files, const HierarchyReader& reader,
                 const RegionRequest& request, const execution::CancelToken& cancel) {
  const storage::Manifest& manifest = reader.manifest();
  if (request.box)
    require_box(*request.box);
  std::optional<config::MapPlaces> map;
  if (!request.crs.empty()) {
    map.emplace(config_of(manifest), manifest.source.bounds, manifest.transform, request.crs);
  }
  Region region;
  if (request.objects.is_any())
    region.objects = std::make_shared<const AskedObjects>(reader, request.objects, cancel);
  std::vector<PlanPolygon> polygons;
  if (!request.polygon.empty())
    polygons = read_polygons(files, request.polygon);
  if (request.box && map) {
    if (!polygons.empty())
      throw Error(ErrorCode::usage, "give a box or a polygon of a map, not both");
    polygons.push_back(rectangle_of(*request.box));
    region.box = layer_of(*request.box, manifest);
  } else if (request.box) {
    region.box = ConvexRegion::of_box(
        {request.box->min - manifest.origin, request.box->max - manifest.origin});
  }
  if (!polygons.empty()) {
    move(polygons, reader, map);
    region.plan =
        std::make_shared<const PlanRegion>(polygons, manifest.up, [&cancel] { cancel.check(); });
  }
  return region;
}

void fail_empty(const HierarchyReader& reader, const RegionRequest& request) {
  const BoundsD& all = reader.manifest().source.bounds;
  if (!request.has_border()) {
    throw Error(ErrorCode::usage,
                "these objects have no triangle there: coarse levels do not show small ones");
  }
  std::string text =
      fmt::format("no triangle lies in the {}; the mesh reaches from {},{},{} to {},{},{}",
                  request.name(), all.min.x, all.min.y, all.min.z, all.max.x, all.max.y, all.max.z);
  if (!request.polygon.empty() && request.crs.empty())
    text += "; for a polygon in coordinates of a map give its --crs (of degrees \"EPSG:4326\")";
  throw Error(ErrorCode::usage, text);
}

}  // namespace meshhier::exporting
