#include "config/input_frame.h"

#include "config/placement.h"
#include "mesh_io/formats.h"
#include "mesh_io/tileset.h"

#include <algorithm>
#include <utility>

namespace meshhier::config {
namespace {

/// Whether the file is a tileset. One that is not there is told when it is read; one with the name
/// of a mesh is not looked into.
bool is_tileset(storage::FileSystem& files, const std::filesystem::path& named) {
  const std::filesystem::path path = mesh_io::tileset_of(files, named);
  if (mesh_io::is_mesh_name(path.filename().string()) ||
      files.kind(path) != storage::FileKind::regular)
    return false;
  const auto format = mesh_io::find_format(*files.open(path));
  return format && format->kind == mesh_io::MeshKind::tileset;
}

bool is_placed(const PlacementConfig& place) {
  return place.longitude || place.crs || !place.metadata.empty() || place.transform;
}

}  // namespace

Config with_input_frame(storage::FileSystem& files, Config config) {
  storage::FileSystem& input = files.input();
  const auto tileset = std::ranges::find_if(
      config.input, [&](const std::filesystem::path& path) { return is_tileset(input, path); });
  const bool has_tileset = tileset != config.input.end();
  if (!config.up)
    config.up = has_tileset ? UpAxis::z : UpAxis::y;
  if (has_tileset && !is_placed(config.placement)) {
    if (const auto frame = mesh_io::globe_frame(input, mesh_io::tileset_of(input, *tileset),
                                                mesh_io::kTilesetBytes))
      config.placement.transform = frame->matrix();
  }
  return config;
}

Config with_files(storage::FileSystem& files, Config config) {
  return with_map(files, with_input_frame(files, std::move(config)));
}

}  // namespace meshhier::config
