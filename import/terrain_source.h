// A grid of heights as a mesh: vertices and triangles come by formula, nothing of them is stored.
//
// A cell is a vertex, in the middle of the cell; four neighbours are two triangles. Their common
// edge is the diagonal whose middle lies nearer to the surface, as a cubic through the sixteen
// cells around has it (Catmull & Rom's weights in the middle, -1 9 9 -1 on each axis); at borders
// and voids it is the diagonal whose ends differ less. Faces look up.
#pragma once

#include "images/material_list.h"
#include "import/terrain_cells.h"
#include "mesh_io/cell_places.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/mosaic.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace meshhier::importing {

/// What a terrain's mesh is made from.
struct Terrain {
  std::shared_ptr<const mesh_io::Mosaic> mosaic;
  std::shared_ptr<const TerrainCells> cells;
  /// The places of cells on a map that was asked for, in metres; null: their own, or their frame.
  std::shared_ptr<const mesh_io::CellPlaces> map{};
  /// The coordinates of cells in their picture; null: there is no picture.
  std::shared_ptr<const mesh_io::CellPlaces> drape{};
  images::MaterialList materials{};             ///< one, with the picture, or none
  std::vector<std::filesystem::path> beside{};  ///< files that say where the picture lies
};

/// Opens the mesh. Its vertices are in place, its checksum is of no file and means nothing.
std::unique_ptr<mesh_io::MeshSource> open_terrain(const Terrain& terrain);

}  // namespace meshhier::importing
