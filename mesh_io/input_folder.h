// What an input stands for: a mesh, or the meshes of an archive or of a folder. Folders are a row
// each, as programs of photogrammetry leave them.
//
//   project/odm_texturing/odm_textured_model_geo.obj     the mesh
//          /odm_georeferencing/coords.txt                the map that its coordinates belong to
//
//   site/Data/Tile_+000_+001/Tile_+000_+001.osgb         a tile, which names finer ones beside it
//       /metadata.xml                                    the map
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// The meshes that an input stands for.
struct InputMeshes {
  std::vector<std::filesystem::path> meshes;  ///< joined in this order; at least one
  /// Files with the map's CRS and the offset to it: a file says what those before it do not.
  std::vector<std::filesystem::path> maps{};
  bool is_z_up = true;  ///< their coordinates are those of a map
};

/// Returns whether a file has the name of those that place tiles: metadata.xml.
bool is_model_metadata(const std::filesystem::path& path);

/// Returns whether a path is a mesh because of what it is, whatever its content: a folder, an
/// archive of a tileset, a metadata.xml.
bool is_container(storage::FileSystem& files, const std::filesystem::path& path);

/// Returns the meshes of a folder, of an archive, or of a metadata.xml that lies with them; of any
/// other path the mesh itself, z-up only if its format says so elsewhere. Throws Error(io) if the
/// folder is of no kind that is known, or cannot be read; Error(input) as tileset_of_archive(); as
/// osgb_tiles_below().
InputMeshes meshes_of(storage::FileSystem& files, const std::filesystem::path& path);

/// Returns the kinds of folders, for sentences: "OSGB tiles, an ODM project or …".
std::string folder_names();

}  // namespace meshhier::mesh_io
