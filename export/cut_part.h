// The triangles that one tile of a cut draws, as a mesh of its own: for files in which each tile
// has a picture.
#pragma once

#include "export/cut_mesh.h"
#include "export/node_cache.h"
#include "hierarchy/cut.h"
#include "hierarchy/published.h"
#include "hierarchy/triangle.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::exporting {

/// A part of a cut. Its vertices are those that the triangles use, splits among them, in the order
/// of the tile's file.
struct CutPart {
  VertexArray vertices;               ///< at their places in the cut, relative to the origin
  std::vector<Vec3f> normals;         ///< computed ones, of unit length; empty: there are none
  std::vector<Vec2f> texcoords;       ///< in the picture; empty: there is none
  std::vector<std::uint32_t> places;  ///< per vertex: the number of its place in the cut
  std::vector<Triangle<std::uint32_t>> triangles;  ///< corners are indices of vertices
  TileImage image;
};

/// Returns all triangles of a tile with its border, as the tile has them; places have the tile's
/// numbers.
CutPart part_of_tile(PublishedTile tile);

/// The parts of a cut, one for each of its tiles: together they have each triangle of the cut once.
/// Beside a neighbour that is shown coarser, a ghost moves to a place there and becomes the vertex
/// that nearest_vertex() finds at it; it keeps its texture coordinate. For one thread.
class CutParts {
 public:
  /// `cache_bytes`: for neighbours. `reader` must outlive it. Throws Error(corrupt) if there are
  /// 2^32 places or more.
  CutParts(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes);

  std::size_t size() const { return numbered_.cut.size(); }
  const Cut& cut() const { return numbered_.cut; }

  /// Returns whether a place of a part may be in other parts, too: it is another tile's, or at the
  /// border of the tile at `position`.
  bool is_at_border(std::size_t position, std::uint32_t place) const;
  /// Reads a tile, and its neighbours that are shown coarser. The result depends on `position`
  /// alone. Throws as HierarchyReader::read_tile and find_ghost().
  CutPart load(std::size_t position);

 private:
  const storage::HierarchyReader& reader_;
  NumberedCut numbered_;
  NodeCache<PublishedTile> neighbours_;  ///< without pictures
};

}  // namespace meshhier::exporting
