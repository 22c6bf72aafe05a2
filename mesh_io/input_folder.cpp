#include "mesh_io/input_folder.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "mesh_io/formats.h"
#include "mesh_io/osgb_folder.h"
#include "mesh_io/tileset_archive.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Path = std::filesystem::path;

constexpr const char* kMetadata = "metadata.xml";

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
  std::optional<InputMeshes> (*look)(const Place&);
};

/// An ODM project, or the folder of textured models in one. Coordinates of a model without "_geo"
/// are of no map.
std::optional<InputMeshes> look_for_odm(const Place& place) {
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
      InputMeshes found{.meshes = {place.folder / name}};
      if (is_geo)
        Place{place.files, project / "odm_georeferencing"}.add_present(kMaps, found.maps);
      return found;
    }
  }
  return std::nullopt;
}

/// A tileset, in the folder or in the one folder there that has one; but not that of a hierarchy,
/// whose folder is what commands for hierarchies take.
std::optional<InputMeshes> look_for_tileset(const Place& place) {
  if (place.has("hierarchy.json"))
    return std::nullopt;
  std::vector<Path> found = tilesets_in(place.files, place.folder);
  if (found.size() > 1)
    throw Error(ErrorCode::io,
                fmt::format("{} holds several tilesets, the first are {} and {}; name those to "
                            "build",
                            place.folder.string(), found[0].string(), found[1].string()));
  return found.empty() ? std::nullopt : std::optional(InputMeshes{.meshes = std::move(found)});
}

/// Returns what OSGB tiles stand for, if there are any.
std::optional<InputMeshes> mesh_of_tiles(storage::FileSystem& files, std::vector<Path> tiles) {
  if (tiles.empty())
    return std::nullopt;
  InputMeshes found{.meshes = std::move(tiles)};
  found.maps = osgb_maps(files, found.meshes.front());
  return found;
}

std::optional<InputMeshes> look_for_osgb(const Place& place) {
  return mesh_of_tiles(place.files, find_osgb_tiles(place.files, place.folder));
}

constexpr auto kRows = std::to_array<FolderRow>({
    {"Data/NAME/NAME.osgb", "OSGB tiles", look_for_osgb},
    {"odm_texturing/odm_textured_model_geo.obj", "an ODM project", look_for_odm},
    {"tileset.json", "3D Tiles", look_for_tileset},
});

/// Returns a text of each row: "a, b or c".
template <class Text>
std::string listed(const Text& text_of) {
  std::string text;
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    text += i == 0 ? "" : i + 1 < kRows.size() ? ", " : " or ";
    text += text_of(kRows[i]);
  }
  return text;
}

/// Returns the meshes that lie with a metadata.xml, which places them.
InputMeshes meshes_of_metadata(storage::FileSystem& files, const Path& path) {
  const Path folder = path.parent_path().empty() ? Path(".") : path.parent_path();
  auto found = look_for_osgb({files, folder});
  if (!found) {
    throw Error(ErrorCode::input,
                fmt::format("{} places a model, and no tiles lie with it (Data/NAME/NAME.osgb); "
                            "build the mesh, and give this file as placement.metadata",
                            path.string()));
  }
  found->maps = {path};
  return *found;
}

}  // namespace

bool is_model_metadata(const Path& path) {
  return small_letters(path.filename().string()) == kMetadata;
}

bool is_container(storage::FileSystem& files, const Path& path) {
  return files.is_directory(path) || is_tileset_archive(files, path) ||
         (is_model_metadata(path) && files.kind(path) == storage::FileKind::regular);
}

InputMeshes meshes_of(storage::FileSystem& files, const Path& path) {
  if (!is_container(files, path))
    return {.meshes = {path}, .is_z_up = false};
  if (!files.is_directory(path))
    return is_model_metadata(path) ? meshes_of_metadata(files, path)
                                   : InputMeshes{.meshes = {tileset_of_archive(files, path)}};
  for (const FolderRow& row : kRows) {
    if (auto found = row.look({files, path}))
      return *found;
  }
  if (auto found = mesh_of_tiles(files, osgb_tiles_below(files, path)))
    return *found;
  throw Error(ErrorCode::io,
              fmt::format("{} is a folder; name the mesh in it ({}, or a tileset.json), or give a "
                          "folder that has {}",
                          path.string(), format_names(), listed([](const FolderRow& row) {
                            return fmt::format("{} ({})", row.sign, row.name);
                          })));
}

std::string folder_names() {
  return listed([](const FolderRow& row) { return std::string(row.name); });
}

}  // namespace meshhier::mesh_io
