// An orthophoto on a grid of heights.
#pragma once

#include "images/material_list.h"
#include "mesh_io/mosaic.h"
#include "storage/io/file.h"

#include <filesystem>

namespace meshhier::importing {

/// A picture, and where the cells of a grid lie in it.
struct TerrainDrape {
  images::MaterialList materials;  ///< one, that shows the picture
  /// From a cell's column and row to texture coordinates, those of the picture with its frame.
  mesh_io::GridMap texcoords;
  bool lies_beside = false;  ///< it covers none of the heights
};

/// Looks at the head of an orthophoto. Throws Error(input) naming the file if it is no GeoTIFF with
/// a place, or lies in another CRS than the heights; Error(io).
TerrainDrape open_drape(storage::FileSystem& files, const std::filesystem::path& path,
                        const mesh_io::Mosaic& heights);

}  // namespace meshhier::importing
