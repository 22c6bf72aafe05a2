// 3D Tiles archives (.3tz), which FileSystem::input() shows as folders.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the tileset.json in a folder; if it has none, those in the folders in it, but for
/// hierarchies'. None if the folder cannot be listed.
std::vector<std::filesystem::path> tilesets_in(storage::FileSystem& files,
                                               const std::filesystem::path& folder);

/// Returns whether a file has the name and the beginning of a 3D Tiles archive.
bool is_tileset_archive(storage::FileSystem& files, const std::filesystem::path& path);

/// Returns the tileset.json of an archive, at its top or in the one folder there that has one.
/// Throws Error(input) naming the archive if it is broken, or has none or several; Error(io).
std::filesystem::path tileset_of_archive(storage::FileSystem& files,
                                         const std::filesystem::path& archive);

}  // namespace meshhier::mesh_io
