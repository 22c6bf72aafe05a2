// Summaries of a hierarchy from its index: how uniform and how large its levels are.
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
  std::uint32_t tiles = 0;       ///< those that have one
  std::uint64_t texels = 0;      ///< all pictures together
  double width = 0, height = 0;  ///< mean
  double texel = 0;  ///< mean size of their texels on the surface, input units, of those with area

  double texels_mean() const;
};

/// The tiles of one level: simplified ones, or on the last level all partitions.
struct LevelSummary {
  Level level{};
  std::uint32_t tiles = 0;
  CountRange vertices;   ///< own ones; those at one place count once
  CountRange triangles;  ///< interior and border
  CountRange bytes;      ///< sizes of the files
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

  // The cut of this level (Cut::of_level) shows so many.
  std::uint32_t shown_tiles = 0;
  std::uint64_t shown_triangles = 0;
  /// If not, shown_triangles is an upper bound: the index does not say how many triangles a
  /// partition draws among coarser tiles.
  bool shown_exact = true;
};

/// Returns one summary per level, from level 0 on. `records`: all tiles of `tree`
/// (storage/format/index.h). O(tiles).
std::vector<LevelSummary> summarize_levels(const Tree& tree, std::span<const TileRecord> records);

/// The bytes of tiles, beside those of floats and indices as they are.
struct SizeSummary {
  std::uint64_t bytes = 0;      ///< all files together
  CountRange tile_bytes;        ///< sizes of the files
  std::uint64_t raw_bytes = 0;  ///< positions as f32, attributes, computed normals, texture
                                ///< coordinates, indices of 16 or 32 bits, pictures of 24 bits a
                                ///< texel, plain
  std::uint64_t vertices = 0;   ///< own, without copies
  std::uint64_t triangles = 0;  ///< each once

  double bytes_per_vertex() const;
  double bytes_per_triangle() const;
  double raw_ratio() const;  ///< bytes / raw_bytes
};

/// Sums up the sizes of these tiles. Ghosts, and border triangles that other tiles draw, are in
/// both numbers of bytes. O(tiles).
SizeSummary summarize_sizes(std::span<const TileRecord> records, const TileFormat& format);

/// Sums up the pictures of these tiles. O(tiles).
PictureSummary summarize_pictures(std::span<const TileRecord> records);

/// The compactness of partitions: p^2 / (4 pi w), 1 for a flat disc, more for ragged borders.
struct CompactnessSummary {
  std::uint32_t count = 0;  ///< partitions that have an area; the others have no compactness
  double mean = 0;
  double median = 0;
  double p95 = 0;  ///< 95 of 100 partitions have at most this
};

CompactnessSummary summarize_compactness(const Tree& tree, std::span<const TileRecord> records);

/// The vertices that went, on all levels together, by changing the surface's topology or beyond any
/// error limit, because their tiles would not have reached their targets otherwise.
struct ForcedCollapses {
  std::uint64_t vertices = 0;
  double share = 0;  ///< vertices / places where the input has any

  /// Coarse levels show little of the input. Raw range images come to half of this.
  bool is_many() const { return share > 0.01; }
};

ForcedCollapses summarize_forced_collapses(std::span<const TileRecord> records,
                                           std::uint64_t source_places);

/// Returns a warning line for people if is_many(), "" otherwise.
std::string forced_collapses_text(const ForcedCollapses& forced);

/// Returns the object of a level; the keys here are those of `inspect --json`
/// (docs/command_line.md).
nlohmann::ordered_json to_json(const LevelSummary& summary);

nlohmann::ordered_json to_json(const SizeSummary& summary);

nlohmann::ordered_json to_json(const PictureSummary& summary);

nlohmann::ordered_json to_json(const ForcedCollapses& forced);

/// Returns the object of a tile.
nlohmann::ordered_json to_json(const TileRecord& record);

}  // namespace meshhier::storage
