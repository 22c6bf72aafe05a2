// Small files beside a raster that say where it lies: a world file has its grid, a .prj its CRS.
#pragma once

#include "geodesy/raster_map.h"
#include "mesh_io/height_raster.h"
#include "storage/io/file.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A CRS as WKT beside a raster.
struct CrsFile {
  std::filesystem::path path;
  geodesy::RasterMap keys;  ///< MapKind::unknown: it is no WKT of a map
};

/// Returns the file that would say in which CRS a raster lies: "heights.prj".
std::filesystem::path crs_file_of(const std::filesystem::path& raster);
/// Reads it; nothing if it is not there. Throws Error(io).
std::optional<CrsFile> read_crs_file(storage::FileSystem& files,
                                     const std::filesystem::path& raster);

/// The six numbers of a world file: the steps to the next column and row, and the middle of the
/// first pixel.
struct WorldFile {
  std::filesystem::path path;
  GridMap map;
};

/// Returns the names that the world file of a TIFF has: .tfw, .tifw, .wld, in small letters and in
/// capitals.
std::vector<std::filesystem::path> world_files_of(const std::filesystem::path& raster);
/// Reads the first one that is there; nothing if none is. Throws Error(input) naming it if it is
/// no six numbers; Error(io).
std::optional<WorldFile> read_world_file(storage::FileSystem& files,
                                         const std::filesystem::path& raster);

}  // namespace meshhier::mesh_io
