#include "config/placement.h"

#include "base/error.h"
#include "config/map_file.h"
#include "storage/format/tileset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::config {
namespace {

/// These files say all that counts at their beginning; some list all pictures after it.
constexpr std::uint64_t kLookedAtBytes = std::uint64_t{1} << 16;

Vec3d to_vec(const std::array<double, 3>& p) {
  return {p[0], p[1], p[2]};
}

/// Does `work`; its failures are told with the key that they are about.
template <class Work>
auto about(const char* key, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw error.within(key);
  }
}

MapFile read_map_file(storage::FileSystem& files, const std::filesystem::path& path) {
  const std::unique_ptr<storage::File> file = files.open(path);
  std::string text(kLookedAtBytes, '\0');
  text.resize(file->read_at(0, std::as_writable_bytes(std::span(text))));
  return about(path.c_str(), [&] { return parse_map_file(text); });
}

/// Takes from a file what is not known yet.
void take_map_file(storage::FileSystem& files, const std::filesystem::path& path,
                   PlacementConfig& place) {
  MapFile file = read_map_file(files, path);
  if (!place.crs && !place.longitude) {
    place.crs = std::move(file.crs);
    if (file.place) {
      place.longitude = file.place->longitude;
      place.latitude = file.place->latitude;
      if (!place.height)
        place.height = file.place->height;
    }
  }
  if (file.is_local)
    place.unplaced_by = path;
  if (!place.offset)
    place.offset = file.offset;
}

void require_crs(const std::filesystem::path& file, const PlacementConfig& place) {
  if (!place.crs && !place.longitude) {
    throw Error(ErrorCode::usage,
                file.string() + ": has an offset, but no CRS; give it by \"crs\"");
  }
}

/// Makes of a place with an offset from there a place alone: of the point that stands there.
void settle_place(PlacementConfig& place, UpAxis up) {
  if (!place.longitude)
    return;
  const std::array<double, 3> from = place.offset.value_or(std::array<double, 3>{});
  if (up == UpAxis::z)
    place.anchor = {-from[0], -from[1], -from[2]};
  else
    place.anchor = {-from[0], -from[2], from[1]};
  place.offset.reset();
  place.metadata.clear();
}

geodesy::MapProjection projection_of(const PlacementConfig& place) {
  return about("placement.crs", [&] { return geodesy::MapProjection(*place.crs); });
}

/// Returns the box in z-up coordinates.
BoundsD z_up_box(const BoundsD& bounds, UpAxis up) {
  BoundsD box;
  box.add(to_z_up(bounds.min, up));
  box.add(to_z_up(bounds.max, up));
  return box;
}

/// Returns how many metres a unit of the input is, as the config says it.
double metres(const Config& config) {
  return config.units ? metres_of(*config.units) : 1;
}

/// A model on its map, and the projection as it is where the model lies.
struct Mapped {
  Mapped(const Config& config, const BoundsD& bounds)
      : projection(projection_of(config.placement)),
        model(mapped_model(config, bounds, projection)) {
    about("placement", [&] { projection.settle_at(model.to_map(model.anchor)); });
  }

  geodesy::MapProjection projection;
  geodesy::MappedModel model;
};

Transform map_transform(const Config& config, const BoundsD& bounds) {
  const Mapped mapped(config, bounds);
  return about("placement",
               [&] { return geodesy::map_transform(mapped.projection, mapped.model); });
}

/// Returns a length for people, rounded up.
std::string length_text(double metres) {
  return metres < 1 ? fmt::format("{:.0f} cm", std::max(1.0, std::ceil(metres * 100)))
                    : fmt::format("{:.1f} m", std::ceil(metres * 10) / 10);
}

std::string exactness_text(const geodesy::MapProjection& projection, double largest_error) {
  std::string text = "at most " + length_text(largest_error) + " off at the corners of its box";
  if (projection.takes_datum_as_wgs84())
    text += "; the datum of the CRS is not known and was taken as WGS 84";
  else if (projection.accuracy() > 0)
    text += fmt::format("; the change of datum is good to {}", length_text(projection.accuracy()));
  return text;
}

/// Returns a warning if no ground lies so low or so high: then the CRS or the units are others.
std::string height_warning(double height, bool is_geocentric) {
  constexpr double kLowest = -15'000, kHighest = 50'000;
  if (height >= kLowest && height <= kHighest)
    return "";
  return fmt::format(
      "warning: that is {:.0f} km {} the ground: {}look at \"crs\", \"offset\", \"height\", "
      "\"units\" and \"up\"\n",
      std::abs(height) / 1000, height < 0 ? "below" : "above",
      is_geocentric ? "the CRS has coordinates from the middle of the Earth, and those of a map "
                      "are none; "
                    : "");
}

/// Returns how the input's heights were taken, as the end of a line.
std::string heights_text(const geodesy::MapProjection& projection) {
  const std::string heights = projection.heights();
  if (heights.empty())
    return "above the ellipsoid";
  return heights == geodesy::kEllipsoid
             ? "above the ellipsoid, as the input's heights are taken"
             : "above the ellipsoid, the input's heights being " + heights;
}

/// Returns a warning if the middle of the model is far from its anchor, as that of a model in map
/// coordinates is from the point 0 0 0.
std::string anchor_warning(const BoundsD& box, Vec3d anchor, double metres) {
  constexpr double kFar = 100'000;
  const double away = length((box.min + box.max) * 0.5 - anchor) * metres;
  if (away <= kFar || away <= length(box.max - box.min) * metres)
    return "";
  return fmt::format(
      "warning: the middle of the model is {:.0f} km from that place: \"anchor\" "
      "names the point of the model that stands there\n",
      away / 1000);
}

/// Returns the text for a model that the config puts on the globe itself.
std::string globe_text(const Config& config, const BoundsD& bounds) {
  const PlacementConfig& place = config.placement;
  const BoundsD box = z_up_box(bounds, config.up_axis());
  const Vec3d size = (box.max - box.min) * metres(config);
  const double height = place.height.value_or(0);
  const Vec3d anchor =
      to_z_up(to_vec(place.anchor.value_or(std::array<double, 3>{})), config.up_axis());
  return fmt::format(
             "placed at longitude {:.6f}, latitude {:.6f}, height {:.1f} m above the ellipsoid: "
             "{:.4g} m from west to east, {:.4g} m from south to north, {:.4g} m high{}\n",
             *place.longitude, *place.latitude, height, size.x, size.y, size.z,
             config.units ? "" : " (taken to be in metres: \"units\" says others)") +
         height_warning(height, false) + anchor_warning(box, anchor, metres(config));
}

}  // namespace

geodesy::MappedModel mapped_model(const Config& config, const BoundsD& bounds,
                                  const geodesy::MapProjection& projection) {
  const PlacementConfig& place = config.placement;
  const Vec3d anchor =
      place.anchor ? to_vec(*place.anchor) : bounds.min + (bounds.max - bounds.min) * 0.5;
  const double scale = config.units ? metres(config) / projection.unit_metres() : 1;
  return {to_vec(place.offset.value_or(std::array<double, 3>{})), to_z_up(anchor, config.up_axis()),
          scale};
}

Config with_map(storage::FileSystem& files, Config config) {
  PlacementConfig& place = config.placement;
  if (!place.metadata.empty()) {
    about("placement.metadata", [&] {
      take_map_file(files, place.metadata, place);
      require_crs(place.metadata, place);
    });
    settle_place(place, config.up_axis());
  }
  if (place.crs)
    projection_of(place);
  return config;
}

Config with_maps(storage::FileSystem& files, Config config,
                 const std::vector<std::filesystem::path>& maps) {
  for (const std::filesystem::path& map : maps)
    take_map_file(files, map, config.placement);
  if (!config.placement.crs && !config.placement.unplaced_by.empty()) {
    config.placement.offset.reset();
    return config;
  }
  config.placement.unplaced_by.clear();
  require_crs(maps.front(), config.placement);
  settle_place(config.placement, config.up_axis());
  return config;
}

std::optional<Transform> tileset_transform(const Config& config, const BoundsD& bounds) {
  const PlacementConfig& place = config.placement;
  if (place.crs)
    return map_transform(config, bounds);
  const double scale = metres(config);
  if (!place.longitude)
    return place.transform ? std::optional(scaled(*place.transform, scale)) : std::nullopt;
  const Vec3d anchor = to_vec(place.anchor.value_or(std::array<double, 3>{})) * scale;
  return scaled(storage::globe_transform(*place.longitude, *place.latitude,
                                         place.height.value_or(0), anchor, config.up_axis()),
                scale);
}

bool fits_map(const Config& config, const BoundsD& bounds, const Transform& transform) try {
  constexpr double kVersionsApart = 10;
  const auto [projection, model] = Mapped(config, bounds);
  const auto error_of = [&, &projection = projection, &model = model](const Transform& one) {
    return geodesy::largest_error(projection, model, one, z_up_box(bounds, config.up_axis()));
  };
  return error_of(transform) <=
         error_of(geodesy::map_transform(projection, model)) + kVersionsApart;
} catch (const Error&) {
  return true;
}

std::string placement_text(const Config& config, const BoundsD& bounds,
                           const Transform& transform) {
  if (config.placement.longitude)
    return globe_text(config, bounds);
  if (!config.placement.crs)
    return "";
  const auto [projection, model] = Mapped(config, bounds);
  const geodesy::Geodetic place =
      projection.to_geodetic(projection.to_geocentric(model.to_map(model.anchor)));
  const double off =
      geodesy::largest_error(projection, model, transform, z_up_box(bounds, config.up_axis()));
  std::string text =
      fmt::format("placed by {} at longitude {:.6f}, latitude {:.6f}, height {:.1f} m {}: {}\n",
                  projection.name(), place.longitude, place.latitude, place.height,
                  heights_text(projection), exactness_text(projection, off));
  text += height_warning(place.height, projection.heights().empty());
  if (!projection.is_meant_for(place)) {
    text += fmt::format(
        "warning: the model lies outside the area that {} is meant for; look at "
        "\"crs\", \"offset\" and \"up\"\n",
        projection.name());
  }
  return text;
}

}  // namespace meshhier::config
