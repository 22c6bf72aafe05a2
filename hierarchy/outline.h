// The shape-outline: a thumbnail of the model made of lines.
#pragma once

#include "base/vec.h"
#include "hierarchy/standpoint.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier {

/// Polyline i has the vertices [starts[i], starts[i + 1]); a closed one repeats its first vertex as
/// its last.
struct Outline {
  std::vector<Vec3f> vertices;  ///< relative to the hierarchy's origin
  std::vector<std::uint32_t> starts{
      0};  ///< ascending; starts.size() - 1 polylines; every one has 2 vertices or more
  /// The last so many polylines draw the form: creases, ridges and valleys. The others are borders,
  /// and where sectors meet.
  std::size_t form_lines = 0;
  std::optional<Standpoint> first_view{};  ///< as PublishedTile's

  std::size_t polyline_count() const { return starts.size() - 1; }
};

/// How many sectors the tiles of a level make, if about `wanted` are to: a tile is one, or, of a
/// few tiles, each is divided into equally many.
constexpr std::uint32_t outline_sectors(std::uint32_t tiles, std::uint32_t wanted) {
  constexpr std::uint32_t kMostDivided = 128;  // what each vertex belongs to is in memory
  const std::uint32_t parts = tiles <= kMostDivided ? (wanted + tiles / 2) / tiles : 1;
  return tiles * (parts > 0 ? parts : 1);
}

/// How the outline came about, for the manifest.
struct OutlineReport {
  std::uint32_t sector_level = 0;  ///< level whose nodes are the sectors, or divided into them
  std::uint32_t sector_count = 0;
  double tolerance = 0;  ///< used, as a part of the bounding-box diagonal
  std::uint64_t polylines_found = 0;
  std::uint64_t polylines_dropped = 0;  ///< to fit the budget
};

}  // namespace meshhier
