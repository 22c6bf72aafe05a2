// Loads the surface of a cut, tile by tile, as viewers draw it.
#pragma once

#include "export/cut_mesh.h"
#include "export/node_cache.h"
#include "hierarchy/cut.h"
#include "hierarchy/published.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::inspection {

/// A tile of a cut. Its ghosts are moved to where the cut shows them; they keep their normals.
struct ShownTile {
  PublishedTile tile;
  /// Indices in tile.mesh.border of the triangles that it draws.
  std::vector<std::uint32_t> border;
};

/// The tiles of a cut. For one thread.
class ShownTiles {
 public:
  /// `reader` must outlive it; `cache_bytes`: memory for neighbours.
  ShownTiles(const storage::HierarchyReader& reader, Cut cut,
             std::uint64_t cache_bytes = kCacheBytes);

  std::size_t size() const { return numbered_.cut.size(); }
  const Cut& cut() const { return numbered_.cut; }
  /// Tells which tiles will be loaded soon, in that order: a hint.
  void will_load(std::span<const std::size_t> positions) const;
  /// Reads the tile at a position of the cut. Throws Error(io | corrupt).
  ShownTile load(std::size_t position);

 private:
  static constexpr std::uint64_t kCacheBytes = std::uint64_t{16} << 20;

  void move_ghosts(PublishedTile& tile);

  const storage::HierarchyReader& reader_;
  exporting::NumberedCut numbered_;
  /// Positions of places of coarser neighbours.
  exporting::NodeCache<std::vector<Vec3f>> positions_;
};

}  // namespace meshhier::inspection
