// The vertices of the mesh that a cut shows: all wedges of its places.
//
// Problem. A place may have several vertices, which differ in normal, colour or values. A tile's
// border triangle says which vertex of its own places a corner is; at a ghost it only has the
// attributes that the neighbour's vertex had when both were built.
//
// Idea. The corner is the vertex of the neighbour that is like it, bit for bit. Of several alike,
// it is one that the neighbour's triangles at this border use. If the neighbour is shown coarser,
// the ghost moves to a place there, and the corner is the vertex that nearest_vertex() finds at it.
#pragma once

#include "execution/cancel.h"
#include "export/cut_mesh.h"
#include "export/node_cache.h"
#include "hierarchy/attribute_rules.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <vector>

namespace meshhier::exporting {

/// Tells the vertices of a cut. For one thread.
class CutVertices {
 public:
  /// Reads the cut's tiles that have copies. `reader` and `numbered` must outlive it.
  /// `cache_bytes`: for neighbours. Throws Error(corrupt) if there are 2^32 vertices or more,
  /// Error(interrupted), and as HierarchyReader::read_tile.
  CutVertices(const storage::HierarchyReader& reader, const NumberedCut& numbered,
              std::uint64_t cache_bytes, const execution::CancelToken& cancel);

  /// Returns how many vertices there are. They are numbered tile by tile, from left to right: the
  /// first vertices of a tile's own places, then their copies.
  std::uint64_t count() const { return bases_.back(); }

  /// Returns the triangles that draw_tile() gives to a tile, with vertices for corners. `tile`: the
  /// one at `position` in the cut. Throws Error(corrupt) naming the tile if a ghost is no vertex of
  /// its neighbour.
  std::vector<CutTriangle> triangles(std::size_t position, const PublishedTile& tile,
                                     const DrawnTile& drawn);

 private:
  /// Says that triangles which touch `tile` have a corner at a copy of an own place.
  struct BorderUse {
    std::uint32_t tile, place, wedge;
    friend constexpr auto operator<=>(const BorderUse&, const BorderUse&) = default;
  };
  /// The facts that neighbours need of a tile's vertices.
  struct OwnVertices {
    VertexArray vertices;
    Copies copies;
    std::vector<BorderUse> uses;  ///< ascending, without repeats
  };
  class TileVertices;

  static std::vector<BorderUse> border_uses(const TileMesh& mesh);

  const storage::HierarchyReader& reader_;
  AttributeRules rules_;
  const NumberedCut& numbered_;
  std::vector<std::uint64_t> bases_;  ///< number of each tile's first vertex; then their count
  bool has_copies_ = false;
  NodeCache<OwnVertices> neighbours_;
};

}  // namespace meshhier::exporting
