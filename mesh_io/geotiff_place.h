// Where the pixels of a GeoTIFF lie.
#pragma once

#include "geodesy/raster_map.h"
#include "images/tiff_file.h"
#include "mesh_io/height_raster.h"

namespace meshhier::mesh_io {

struct GeoTiffPlace {
  GridMap map;  ///< of the middles of pixels
  geodesy::RasterMap keys;
};

/// Reads tags and keys of the current image. Throws Error(input) naming the file if they give no
/// grid, or contradict each other.
GeoTiffPlace read_place(images::TiffFile& tiff);

}  // namespace meshhier::mesh_io
