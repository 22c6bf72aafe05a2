// The memory that a tileset may take while it is read.
#pragma once

#include "base/error.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>

namespace meshhier::mesh_io {

/// The most tiles and contents that are read, each counted as often as it is shown: documents that
/// name each other would else make any number. A mesh has up to 2^32 vertices: 4,096 for each tile.
inline constexpr std::uint64_t kMostTiles = std::uint64_t{1} << 20;

struct TilesetRoom {
  std::uint64_t json_bytes = std::uint64_t{256}
                             << 20;  ///< for a document: a hundred thousand tiles
  std::uint64_t tiles = kMostTiles;

  /// Returns the room within a memory budget: lists of tiles take up to half of it.
  static TilesetRoom of(std::uint64_t budget) {
    constexpr std::uint64_t kTileBytes = 1024;  // measured: 650, with short names
    const TilesetRoom most;
    return {std::min(most.json_bytes, budget / 4 * 3),
            std::min(most.tiles, budget / 2 / kTileBytes)};
  }
  /// Throws for more tiles than these: Error(budget) if more memory would do, else Error(input).
  [[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) const {
    if (tiles == kMostTiles)
      fail_file(path, what);
    throw Error(ErrorCode::budget, file_message(path, what + "; give a larger memory_budget"));
  }
};

}  // namespace meshhier::mesh_io
