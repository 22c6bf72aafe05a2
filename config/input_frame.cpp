#include "config/input_frame.h"

#include "config/placement.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_folder.h"
#include "mesh_io/tileset.h"
#include "storage/io/paths.h"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::config {
namespace {

/// Returns the kind of a file that has a place of its own. One that is not there is told when it is
/// read; one with the name of another kind of mesh is not looked into.
std::optional<mesh_io::MeshKind> placing_kind(storage::FileSystem& files,
                                              const std::filesystem::path& path) {
  const bool is_other =
      mesh_io::is_mesh_name(path.filename().string()) &&
      storage::lower_extension(path) != mesh_io::row_of(mesh_io::MeshKind::osgb).ending;
  if (is_other || files.kind(path) != storage::FileKind::regular)
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
};

void look_at_mesh(storage::FileSystem& files, const std::filesystem::path& path, Sources& found) {
  const auto kind = placing_kind(files, path);
  if (kind == mesh_io::MeshKind::osgb) {
    found.is_z_up = true;
    if (found.maps.empty())
      found.maps = mesh_io::osgb_maps(files, path);
  } else if (kind == mesh_io::MeshKind::tileset) {
    found.is_z_up = true;
    if (!found.tileset)
      found.tileset = path;
  }
}

Sources look_at(storage::FileSystem& files, const mesh_io::InputPaths& paths) {
  Sources found;
  for (const std::filesystem::path& named : paths) {
    const std::filesystem::path path = mesh_io::tileset_of(files, named);
    const auto folder = mesh_io::find_folder_mesh(files, path);
    if (!folder) {
      look_at_mesh(files, path, found);
      continue;
    }
    found.is_z_up = found.is_z_up || folder->is_z_up;
    if (found.maps.empty())
      found.maps = folder->maps;
    look_at_mesh(files, folder->meshes[0], found);
  }
  return found;
}

}  // namespace

Config with_input_frame(storage::FileSystem& files, Config config) {
  const Sources sources = look_at(files.input(), config.input);
  if (!config.up)
    config.up = sources.is_z_up ? UpAxis::z : UpAxis::y;
  if (is_placed(config.placement))
    return config;
  if (!sources.maps.empty())
    return with_maps(files.input(), std::move(config), sources.maps);
  if (sources.tileset) {
    if (const auto frame =
            mesh_io::globe_frame(files.input(), *sources.tileset, mesh_io::kTilesetBytes))
      config.placement.transform = frame->matrix();
  }
  return config;
}

Config with_files(storage::FileSystem& files, Config config) {
  return with_map(files, with_input_frame(files, std::move(config)));
}

}  // namespace meshhier::config
