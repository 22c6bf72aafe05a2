// Counts the triangles at the edges of a cut's mesh, by place, tile by tile, out of core.
//
// Triangles with a place twice do not count: they have no area, and close no gap.
#pragma once

#include "export/cut_mesh.h"
#include "partition/external_sort.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace meshhier::verifying {

/// An edge between two places of a cut; low < high.
struct CutEdge {
  std::uint32_t low = 0;
  std::uint32_t high = 0;

  constexpr std::uint64_t key() const { return std::uint64_t{low} << 32 | high; }
  friend constexpr bool operator==(const CutEdge&, const CutEdge&) = default;
};

struct CutEdgeKey {
  std::uint64_t operator()(const CutEdge& edge) const { return edge.key(); }
};

/// The triangles that meet at an edge.
struct EdgeCount {
  CutEdge edge;
  std::uint64_t triangles = 0;
  std::int64_t net = 0;  ///< triangles that run from low to high, less those that run back

  /// An edge that is neither has no gap: a closed, oriented surface has no such edges.
  bool is_border() const { return triangles == 1; }
  bool is_unbalanced() const { return net != 0; }
};

/// Counts edges. Those whose triangles are all drawn by one tile are counted there; only the
/// others, along the seams, go through an external sort. For one thread.
class EdgeCensus {
 public:
  /// Visits every edge that is a border or unbalanced, once, in a deterministic order.
  using Visit = std::function<void(const EdgeCount&)>;

  /// `memory_bytes`: those of the sort.
  EdgeCensus(storage::ScratchFile& scratch, std::uint64_t memory_bytes, Visit visit)
      : seams_(scratch, memory_bytes), visit_(std::move(visit)) {}

  /// Adds the triangles that a tile draws (exporting::draw_tile()); `base`: number of its first
  /// place. O(t log t).
  void add(const PublishedTile& tile, std::uint32_t base, const exporting::DrawnTile& drawn);

  /// Counts the edges along the seams. Called once, after all tiles.
  void finish();

 private:
  /// An edge of one triangle.
  struct Use {
    CutEdge edge;
    std::int32_t direction = 0;  ///< 1 from low to high, -1 back
  };
  struct UseKey {
    std::uint64_t operator()(const Use& use) const { return use.edge.key(); }
  };
  static_assert(sizeof(Use) == 12, "sorted by bytes: no padding");

  static Use use_of(std::uint32_t from, std::uint32_t to);
  void count(const Use& use);
  void close();

  partition::ExternalSort<Use, UseKey> seams_;
  Visit visit_;
  EdgeCount current_;  ///< being counted; no triangles: none
};

}  // namespace meshhier::verifying
