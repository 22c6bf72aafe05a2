#include "mesh_io/input_folder.h"

#include "base/error.h"
#include "mesh_io/formats.h"

#include <array>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Path = std::filesystem::path;

/// A folder that is looked at.
struct Place {
  storage::FileSystem& files;
  Path folder;

  bool has(const Path& name) const {
    return files.kind(folder / name) == storage::FileKind::regular;
  }
  /// Appends those of `names` that are there.
  template <class Names>
  void add_present(const Names& names, std::vector<Path>& to) const {
    for (const std::string_view name : names) {
      if (has(name))
        to.push_back(folder / name);
    }
  }
};

struct FolderRow {
  std::string_view sign;  ///< a file by which it is known
  std::string_view name;  ///< for people
  std::optional<FolderMesh> (*look)(const Place&);
};

/// An ODM project, or the folder of textured models in one. Coordinates of a model without "_geo"
/// are of no map.
std::optional<FolderMesh> look_for_odm(const Place& place) {
  constexpr auto kFolders =
      std::to_array<std::string_view>({"odm_texturing", "odm_texturing_25d", ""});
  constexpr auto kMaps = std::to_array<std::string_view>(
      {"coords.txt", "odm_georeferencing_model_geo.txt", "proj.txt"});
  for (const std::string_view folder : kFolders) {
    const Path project = folder.empty() ? place.folder / ".." : place.folder;
    for (const bool is_geo : {true, false}) {
      const Path name =
          Path(folder) / (is_geo ? "odm_textured_model_geo.obj" : "odm_textured_model.obj");
      if (!place.has(name))
        continue;
      FolderMesh found{.meshes = {place.folder / name}};
      if (is_geo)
        Place{place.files, project / "odm_georeferencing"}.add_present(kMaps, found.maps);
      return found;
    }
  }
  return std::nullopt;
}

/// A tileset, but not that of a hierarchy, whose folder is what commands for hierarchies take.
std::optional<FolderMesh> look_for_tileset(const Place& place) {
  if (!place.has("tileset.json") || place.has("hierarchy.json"))
    return std::nullopt;
  return FolderMesh{.meshes = {place.folder / "tileset.json"}};
}

constexpr auto kRows = std::to_array<FolderRow>({
    {"odm_texturing/odm_textured_model_geo.obj", "an ODM project", look_for_odm},
    {"tileset.json", "3D Tiles", look_for_tileset},
});

}  // namespace

std::optional<FolderMesh> find_folder_mesh(storage::FileSystem& files, const Path& path) {
  if (!files.is_directory(path))
    return std::nullopt;
  for (const FolderRow& row : kRows) {
    if (auto found = row.look({files, path}))
      return found;
  }
  throw Error(ErrorCode::io,
              fmt::format("{} is a folder; name the mesh in it ({}, or a tileset.json), or give a "
                          "folder that has {}",
                          path.string(), format_names(), folder_kinds()));
}

std::string folder_kinds() {
  std::string text;
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    text += i == 0 ? "" : i + 1 < kRows.size() ? ", " : " or ";
    text += fmt::format("{} ({})", kRows[i].sign, kRows[i].name);
  }
  return text;
}

}  // namespace meshhier::mesh_io
