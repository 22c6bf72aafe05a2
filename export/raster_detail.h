// How fine a raster of a hierarchy is, and the tiles that are as fine.
#pragma once

#include "export/map_frame.h"
#include "export/named_cut.h"
#include "storage/format/hierarchy_reader.h"

namespace meshhier::exporting {

/// Returns whether a tile has the input's own vertices.
bool is_of_input(const storage::HierarchyReader& reader, const TileRecord& record);

/// Returns a pixel's side, in units of the frame: about as large as the texels of the input, or
/// else as its vertices are apart, seen from above; 1, 2 or 5 times a power of 10. O(tiles).
double finest_detail(const storage::HierarchyReader& reader, const MapFrame& frame);

/// The purpose for which a tile's vertices must be as dense as pixels.
enum class VertexUse {
  picture,             ///< for colours, if it has no picture
  picture_and_heights  ///< for heights: a grid of them comes out as it is
};

/// Returns the coarsest tiles that are at most half a pixel off, and whose vertices are at most a
/// pixel apart where they have to be. O(tiles of the cut).
NamedCut cut_for_pixels(const storage::HierarchyReader& reader, const MapFrame& frame, double pixel,
                        VertexUse use);

}  // namespace meshhier::exporting
