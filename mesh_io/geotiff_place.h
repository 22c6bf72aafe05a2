// Where the pixels of a GeoTIFF lie.
#pragma once

#include "geodesy/raster_map.h"
#include "images/tiff_file.h"
#include "mesh_io/height_raster.h"
#include "storage/io/file.h"

#include <filesystem>
#include <vector>

namespace meshhier::mesh_io {

struct GeoTiffPlace {
  GridMap map;  ///< of the middles of pixels
  geodesy::RasterMap keys;
  std::vector<std::filesystem::path> beside{};  ///< files that said a part of it
};

/// Reads tags and keys of the current image, and what they lack from a world file and a .prj beside
/// it. Throws Error(input) naming the file if they give no grid, or contradict each other.
GeoTiffPlace read_place(images::TiffFile& tiff, storage::FileSystem& files);

/// Returns the files beside a TIFF that read_place() would look for. Throws as images::TiffFile.
std::vector<std::filesystem::path> place_files_of(const storage::File& file);

}  // namespace meshhier::mesh_io
