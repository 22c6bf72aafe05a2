// A grid of heights as a mesh: vertices and triangles come by formula, nothing of them is stored.
//
// A cell is a vertex, in the middle of the cell; four neighbours are two triangles. Their common
// edge is the diagonal whose middle lies nearer to the surface, as a cubic through the sixteen
// cells around has it (Catmull & Rom's weights in the middle, -1 9 9 -1 on each axis); at borders
// and voids it is the diagonal whose ends differ less. Faces look up.
#pragma once

#include "images/material_list.h"
#include "import/terrain_cells.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/mosaic.h"

#include <memory>
#include <optional>

namespace meshhier::importing {

/// What a terrain's mesh is made from.
struct Terrain {
  std::shared_ptr<const mesh_io::Mosaic> mosaic;
  std::shared_ptr<const TerrainCells> cells;
  /// From a cell's column and row to the coordinates in its picture; none: there is no picture.
  std::optional<mesh_io::GridMap> drape{};
  images::MaterialList materials{};  ///< one, with the picture, or none
};

/// Opens the mesh. Its vertices are in place, its checksum is of no file and means nothing.
std::unique_ptr<mesh_io::MeshSource> open_terrain(const Terrain& terrain);

}  // namespace meshhier::importing
