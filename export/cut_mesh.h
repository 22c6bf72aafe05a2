// The mesh that a cut shows, tile by tile, by places: here a corner is a place, whichever of its
// vertices it is (cut_vertices.h tells).
//
// The places of the cut's tiles are numbered from left to right, each tile's own ones in their
// order. A border triangle reaches into other tiles: its ghosts are looked up where the cut shows
// their regions (chains, hierarchy/published.h). One tile draws it (hierarchy/drawing_rule.h), the
// same for all images of one triangle of the cut. Exact duplicates therefore meet within one tile,
// and dropping them tile by tile is dropping them all.
#pragma once

#include "hierarchy/cut.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "hierarchy/triangle.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::exporting {

/// A triangle whose corners are numbers of the cut's places.
using CutTriangle = Triangle<std::uint32_t>;

/// A cut whose places are numbered. A vertex here is the first one of its place.
struct NumberedCut {
  Cut cut;
  std::vector<std::uint64_t> bases;  ///< number of each node's first vertex; then the vertex count

  std::uint64_t vertex_count() const { return bases.back(); }
  std::uint32_t base(std::size_t position) const {
    return static_cast<std::uint32_t>(bases[position]);
  }
  /// Returns the position of the node that has a vertex. O(log nodes). Requires number <
  /// vertex_count().
  std::size_t position_of_vertex(std::uint32_t number) const;
};

/// Numbers the places of a cut. Throws Error(corrupt) if there are 2^32 vertices or more.
NumberedCut number_vertices(const storage::HierarchyReader& reader, Cut cut);

/// The place where a cut shows a ghost.
struct ShownGhost {
  std::size_t position = 0;  ///< in the cut
  Level level{};             ///< level of the node there
  std::uint32_t number = 0;  ///< number of the vertex
};

/// Finds where the cut shows a ghost; nothing if the ghost's region is shown finer than the tile
/// that has the ghost. Requires that numbered.cut shows `tile`, which is consistent by itself
/// (decode_tile). Throws Error(corrupt) naming the tile if the chain leads to a vertex that is not
/// there.
std::optional<ShownGhost> find_ghost(const Tree& tree, const NumberedCut& numbered,
                                     const PublishedTile& tile, std::size_t ghost);

/// The triangles that a tile contributes to its cut.
struct DrawnTile {
  std::vector<CutTriangle> triangles;  ///< the interior ones in the tile's order, then border ones
  /// For each border triangle drawn its index in tile.mesh.border.
  std::vector<std::uint32_t> border;
  /// Indices in tile.mesh.border of triangles that other tiles draw.
  std::vector<std::uint32_t> left_out;
};

/// Returns the triangles that a tile draws; `position`: the tile's, in the cut. Of equal border
/// triangles it draws the first, and none with a place twice, unless all corners are original:
/// these are the input's own, repeated and flat ones included. Thread-safe. O(t log t) in the
/// border triangles, linear in the interior ones. Deterministic. Throws as find_ghost().
DrawnTile draw_tile(const Tree& tree, const NumberedCut& numbered, std::size_t position,
                    const PublishedTile& tile);

}  // namespace meshhier::exporting
