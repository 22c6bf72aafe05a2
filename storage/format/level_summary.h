// What the index says of a hierarchy as a whole: how uniform its levels are.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/tile_glb.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

/// The range of a count over the tiles of a level.
struct CountRange {
  std::uint64_t min = 0;
  std::uint64_t max = 0;
  double mean = 0;
  double deviation = 0;  ///< standard deviation

  /// (max - min) / mean: 0 if all are equal.
  double spread() const { return mean > 0 ? static_cast<double>(max - min) / mean : 0; }
  /// deviation / mean
  double variation() const { return mean > 0 ? deviation / mean : 0; }
};

/// The pictures of tiles.
struct PictureSummary {
  std::uint32_t tiles = 0;       ///< that have one
  std::uint64_t texels = 0;      ///< of them together
  double width = 0, height = 0;  ///< mean
  double texel = 0;  ///< mean size of their texels on the surface, input units, of those with area

  double texels_mean() const;
};

/// The tiles of one level: simplified ones, or on the last level all partitions.
struct LevelSummary {
  Level level{};
  std::uint32_t tiles = 0;
  CountRange vertices;   ///< own; of those at one place one
  CountRange triangles;  ///< interior and border
  CountRange bytes;      ///< of the files
  std::uint64_t vertices_total = 0;
  std::uint64_t copies_total = 0;  ///< further vertices at places, those of ghosts included
  std::uint64_t splits_total = 0;  ///< further normals and texture coordinates of vertices, those
                                   ///< of ghosts included
  std::uint64_t triangles_total = 0;  ///< each once: interior, and border ones where they are drawn
  std::uint64_t bytes_total = 0;
  double border_ratio = 0;         ///< border triangles of all triangles, summed over the tiles
  float error_max = 0;             ///< input units
  float bound_max = 0;             ///< input units
  std::uint64_t torn_total = 0;    ///< vertices that went by changing topology
  std::uint64_t forced_total = 0;  ///< vertices that went without care for the surface
  std::uint32_t off_target = 0;    ///< simplified tiles whose vertex count is not the one asked for
  PictureSummary pictures;

  // What the cut of this level shows (Cut::of_level).
  std::uint32_t shown_tiles = 0;
  std::uint64_t shown_triangles = 0;
  /// False: an upper bound. What a partition among coarser tiles draws is not in the index.
  bool shown_exact = true;
};

/// One summary per level, from level 0 on. `records`: all tiles of `tree` (storage/format/index.h).
/// O(tiles).
std::vector<LevelSummary> summarize_levels(const Tree& tree, std::span<const TileRecord> records);

/// What tiles take, against floats and indices as they are.
struct SizeSummary {
  std::uint64_t bytes = 0;      ///< of the files
  CountRange tile_bytes;        ///< of one
  std::uint64_t raw_bytes = 0;  ///< positions as f32, attributes, computed normals, texture
                                ///< coordinates, indices of 16 or 32 bits, pictures of 24 bits a
                                ///< texel, plain
  std::uint64_t vertices = 0;   ///< own, without copies
  std::uint64_t triangles = 0;  ///< each once

  double bytes_per_vertex() const;
  double bytes_per_triangle() const;
  double raw_ratio() const;  ///< bytes / raw_bytes
};

/// Of these tiles together. Ghosts, and border triangles that other tiles draw, are in both numbers
/// of bytes. O(tiles).
SizeSummary summarize_sizes(std::span<const TileRecord> records, const TileFormat& format);

/// Of these tiles together. O(tiles).
PictureSummary summarize_pictures(std::span<const TileRecord> records);

/// How compact the partitions are: p^2 / (4 pi w), 1 for a flat disc, more for ragged borders.
struct CompactnessSummary {
  std::uint32_t count = 0;  ///< partitions that have an area; the others have no compactness
  double mean = 0;
  double median = 0;
  double p95 = 0;  ///< 95 of 100 partitions have at most this
};

CompactnessSummary summarize_compactness(const Tree& tree, std::span<const TileRecord> records);

/// How many vertices went, on all levels together, by changing the surface's topology or beyond any
/// error limit, because their tiles would not have reached their targets otherwise.
struct ForcedCollapses {
  std::uint64_t vertices = 0;
  double share = 0;  ///< of the places where the input has vertices

  /// Coarse levels show little of the input. Raw range images come to half of this.
  bool is_many() const { return share > 0.01; }
};

ForcedCollapses summarize_forced_collapses(std::span<const TileRecord> records,
                                           std::uint64_t source_places);

/// For people: a warning line if is_many(), "" otherwise.
std::string forced_collapses_text(const ForcedCollapses& forced);

/// One object per level; the keys are those of `inspect --json` (docs/command_line.md).
nlohmann::ordered_json to_json(const LevelSummary& summary);

nlohmann::ordered_json to_json(const SizeSummary& summary);

nlohmann::ordered_json to_json(const PictureSummary& summary);

nlohmann::ordered_json to_json(const ForcedCollapses& forced);

/// One object per tile.
nlohmann::ordered_json to_json(const TileRecord& record);

}  // namespace meshhier::storage
