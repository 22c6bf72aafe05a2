// The vertices of the mesh that a cut shows: all wedges of its places.
//
// A corner beside a neighbour of the tile's own level is the vertex there that is like it, bit for
// bit; of several alike, one that the neighbour's triangles at this border use. Beside a neighbour
// that is shown coarser it is the vertex of the place that it moves to that nearest_vertex() finds.
#pragma once

#include "execution/cancel.h"
#include "export/cut_mesh.h"
#include "export/node_cache.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <vector>

namespace meshhier::exporting {

class CutVertices {
 public:
  /// Reads those of the cut's tiles that have copies. `reader` and `numbered` must outlive it.
  /// `cache_bytes`: for neighbours. Throws Error(corrupt) if there are 2^32 vertices or more,
  /// Error(interrupted), and as HierarchyReader::read_tile.
  CutVertices(const storage::HierarchyReader& reader, const NumberedCut& numbered,
              std::uint64_t cache_bytes, const execution::CancelToken& cancel);

  /// Of each tile, from left to right: the first vertices of its own places, then their copies.
  std::uint64_t count() const { return bases_.back(); }

  /// What draw_tile() says that a tile draws, with vertices for corners. `tile`: at `position` in
  /// the cut. Throws Error(corrupt) naming the tile if a ghost is no vertex of its neighbour.
  std::vector<CutTriangle> triangles(std::size_t position, const PublishedTile& tile,
                                     const DrawnTile& drawn);

 private:
  /// That triangles which touch `tile` have a corner at a copy of an own place.
  struct BorderUse {
    std::uint32_t tile, place, wedge;
    friend constexpr auto operator<=>(const BorderUse&, const BorderUse&) = default;
  };
  /// What neighbours need to know of a tile's vertices.
  struct OwnVertices {
    VertexArray vertices;
    Copies copies;
    std::vector<BorderUse> uses;  ///< ascending, without repeats
  };
  class TileVertices;

  static std::vector<BorderUse> border_uses(const TileMesh& mesh);

  const storage::HierarchyReader& reader_;
  const NumberedCut& numbered_;
  std::vector<std::uint64_t> bases_;  ///< number of each tile's first vertex; then their count
  bool has_copies_ = false;
  NodeCache<OwnVertices> neighbours_;
};

}  // namespace meshhier::exporting
