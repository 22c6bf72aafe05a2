// The tiles that a job will have, estimated before there are any: their number, and their size all
// together.
#pragma once

#include "pipeline/plan/job_size.h"
#include "storage/format/tile_sums.h"

#include <cstdint>

namespace meshhier::pipeline {

/// The part of a tile's vertices that is its boundary, times the root of their number. Measured on
/// scans of one to eight hundred pieces, a terrain and open patches, with tiles of 64 to 32768
/// vertices: 3.6 to 4.7; on nested shells 4.2 to 6.9.
inline constexpr double kBoundaryShare = 5;

/// Tiles as the forest holds them: it counts early ones among the simplified.
struct TilePopulation {
  storage::TileSums partitions;
  storage::TileSums simplified;
  storage::TileSums early;    ///< those among the simplified ones
  double steep_boundary = 0;  ///< boundary vertices of the joined children of simplified tiles,
                              ///< beyond those that a tile of twice their parent's size has
  int levels = 0;
  bool counted = false;  ///< the partitions are, and the others follow from them

  /// Returns the number of files: partitions and simplified tiles, manifest, index and outline.
  double files() const { return partitions.count + simplified.count + 3; }
};

/// Returns the tiles that a surface will have, with borders as scans have them.
TilePopulation expected_tiles(const JobSize& job);

/// Returns the tiles to expect above partitions that were counted: they have borders and triangles
/// in proportion.
TilePopulation with_counted(const TilePopulation& expected, const storage::TileSums& partitions);

/// The numbers of a hierarchy's tiles, by arithmetic alone.
struct TileCounts {
  int levels = 0;
  std::uint64_t partitions = 0;
  std::uint64_t simplified = 0;  ///< published ones
  std::uint64_t tiles() const { return partitions + simplified; }
};

TileCounts count_tiles(const TilePopulation& tiles);

}  // namespace meshhier::pipeline
