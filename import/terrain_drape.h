// An orthophoto on a grid of heights.
#pragma once

#include "images/material_list.h"
#include "mesh_io/cell_places.h"
#include "mesh_io/mosaic.h"
#include "storage/io/file.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::importing {

/// A picture, and where the cells of a grid lie in it.
struct TerrainDrape {
  images::MaterialList materials{};  ///< one, that shows the picture
  /// Texture coordinates of cells, those of the picture with its frame.
  std::shared_ptr<const mesh_io::CellPlaces> texcoords{};
  std::vector<std::filesystem::path> beside{};  ///< files beside it that say where it lies
  std::vector<std::string> warnings{};          ///< a line each
};

/// Looks at the head of an orthophoto, and finds where the cells of the heights lie in it; by PROJ,
/// if its CRS is another one than theirs. `crs`: the CRS of the heights if it is another one than
/// they say; else empty. Throws Error(input) naming the file if the picture is no GeoTIFF with a
/// place, or if one of both needs a CRS and has none; Error(usage) if PROJ knows one of them not;
/// Error(io).
TerrainDrape open_drape(storage::FileSystem& files, const std::filesystem::path& path,
                        const mesh_io::Mosaic& heights, const std::string& crs);

}  // namespace meshhier::importing
