#include "config/input_frame.h"

#include "base/error.h"
#include "config/placement.h"
#include "geodesy/map_change.h"
#include "geodesy/map_projection.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_folder.h"
#include "mesh_io/mosaic.h"
#include "mesh_io/osgb_folder.h"
#include "mesh_io/terrain_frame.h"
#include "mesh_io/tileset.h"
#include "storage/io/paths.h"
#include "storage/io/process.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::config {
namespace {

/// Whether a file of that name may have a place of its own: it is named so, or as no mesh.
bool may_have_place(const std::filesystem::path& named) {
  const std::filesystem::path path =
      storage::lower_extension(named) == ".gz" ? named.stem() : named.filename();
  return !mesh_io::is_mesh_name(path.filename().string()) ||
         std::ranges::any_of(mesh_io::format_rows(), [&](const mesh_io::FormatRow& row) {
           return row.ending == storage::lower_extension(path) &&
                  mesh_io::row_of(row.kind).has_place;
         });
}

/// Returns the kind of a file that may have a place of its own. One that is not there is told when
/// it is read; one with the name of another kind of mesh is not looked into.
std::optional<mesh_io::MeshKind> placing_kind(storage::FileSystem& files,
                                              const std::filesystem::path& path) {
  if (!may_have_place(path) || files.kind(path) != storage::FileKind::regular)
    return std::nullopt;
  const auto format = mesh_io::find_format(*files.open(path));
  return format ? std::optional(format->kind) : std::nullopt;
}

bool is_placed(const PlacementConfig& place) {
  return place.longitude || place.crs || !place.metadata.empty() || place.transform;
}

/// What the inputs say of their place together.
struct Sources {
  bool is_z_up = false;                          ///< one of them is
  std::optional<std::filesystem::path> tileset;  ///< the first one
  std::vector<std::filesystem::path> maps;       ///< of the first folder that has any
  std::vector<std::filesystem::path> rasters;    ///< all
};

void look_at_mesh(storage::FileSystem& files, const std::filesystem::path& path, Sources& found) {
  const auto kind = placing_kind(files, path);
  if (!kind)
    return;
  const mesh_io::FormatRow& row = mesh_io::row_of(*kind);
  found.is_z_up = found.is_z_up || row.has_place;
  if (row.is_raster)
    found.rasters.push_back(path);
  else if (kind == mesh_io::MeshKind::tileset)
    found.tileset = found.tileset.value_or(path);
  else if (row.has_place && found.maps.empty())
    found.maps = mesh_io::osgb_maps(files, path);
}

Sources look_at(storage::FileSystem& files, const mesh_io::InputPaths& paths) {
  Sources found;
  for (const std::filesystem::path& named : paths) {
    const mesh_io::InputMeshes input = mesh_io::meshes_of(files, named);
    found.is_z_up = found.is_z_up || input.is_z_up;
    if (found.maps.empty())
      found.maps = input.maps;
    look_at_mesh(files, input.meshes[0], found);
  }
  return found;
}

/// Does `work` with the CRS of a raster; tells if PROJ knows none of that name.
template <class Work>
auto about_crs(const std::filesystem::path& raster, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw error.within(raster.string() + ": its CRS (\"placement\" in the config says another)");
  }
}

/// Returns the CRS of a map, without its heights if PROJ lacks the grid for these: then they count
/// as above the ellipsoid, as those of degrees do.
std::string usable_crs(const std::filesystem::path& raster, const std::string& crs) {
  const std::string horizontal = geodesy::horizontal_code(crs);
  if (horizontal != crs) {
    try {
      geodesy::MapProjection{crs};
      return crs;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::usage)
        throw;
    }
  }
  about_crs(raster, [&] { return geodesy::MapProjection(horizontal).unit_metres(); });
  return horizontal;
}

/// Returns a place on WGS 84, as PROJ changes the datum of a map in degrees.
mesh_io::GlobePlace on_wgs84(mesh_io::GlobePlace place, const std::string& crs) {
  constexpr std::string_view kWgs84 = "EPSG:4326";
  if (crs.empty() || crs.starts_with(kWgs84))
    return place;
  const Vec3d there =
      geodesy::MapChange(crs, std::string(kWgs84))({place.longitude, place.latitude, 0});
  return mesh_io::rounded({there.x, there.y});
}

/// Takes the place from rasters: their map, or the middle of a grid in degrees.
void place_terrain(storage::FileSystem& files, const std::vector<std::filesystem::path>& rasters,
                   Config& config) {
  storage::allow_many_open_files();  // each raster stays open
  const mesh_io::Mosaic mosaic(files, rasters);
  const std::string& crs = mosaic.keys().crs;
  PlacementConfig& place = config.placement;
  if (mosaic.is_in_metres() && !config.units)
    config.units = Unit::m;
  const auto middle = mesh_io::middle_of(mosaic);
  if (middle && !place.metadata.empty()) {
    throw Error(ErrorCode::usage, rasters[0].string() +
                                      " lies in degrees: it stands on the globe by itself, or on "
                                      "the map of placement.crs, without placement.metadata");
  }
  if (is_placed(place))
    return;
  if (middle) {
    const auto there = about_crs(rasters[0], [&] { return on_wgs84(*middle, crs); });
    place.longitude = there.longitude;
    place.latitude = there.latitude;
  } else if (!crs.empty()) {
    place.crs = usable_crs(rasters[0], crs);
  }
}

}  // namespace

Config with_input_frame(storage::FileSystem& files, Config config) {
  const Sources sources = look_at(files.input(), config.input);
  if (!config.up)
    config.up = sources.is_z_up ? UpAxis::z : UpAxis::y;
  if (!sources.rasters.empty())
    place_terrain(files.input(), sources.rasters, config);
  if (is_placed(config.placement))
    return config;
  if (!sources.maps.empty())
    return with_maps(files.input(), std::move(config), sources.maps);
  if (sources.tileset) {
    const mesh_io::TilesetRoom room = config.memory_budget
                                          ? mesh_io::TilesetRoom::of(*config.memory_budget)
                                          : mesh_io::TilesetRoom{};
    if (const auto frame = mesh_io::globe_frame(files.input(), *sources.tileset, room))
      config.placement.transform = frame->matrix();
  }
  return config;
}

Config with_files(storage::FileSystem& files, Config config) {
  return with_map(files, with_input_frame(files, std::move(config)));
}

}  // namespace meshhier::config
