// The surface of a cut, tile by tile, as viewers draw it.
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

/// A tile of a cut. Ghosts lie where the cut shows them; they keep their normals.
struct ShownTile {
  PublishedTile tile;
  std::vector<std::uint32_t> border;  ///< which of tile.mesh.border it draws
};

/// Not thread-safe.
class ShownTiles {
 public:
  /// `reader` must outlive it; `cache_bytes`: for neighbours.
  ShownTiles(const storage::HierarchyReader& reader, Cut cut,
             std::uint64_t cache_bytes = kCacheBytes);

  /// How many tiles there are.
  std::size_t size() const { return numbered_.cut.size(); }
  const Cut& cut() const { return numbered_.cut; }
  /// Which will be loaded soon, in that order: a hint.
  void will_load(std::span<const std::size_t> positions) const;
  /// Throws Error(io | corrupt).
  ShownTile load(std::size_t position);

 private:
  static constexpr std::uint64_t kCacheBytes = std::uint64_t{16} << 20;

  void move_ghosts(PublishedTile& tile);

  const storage::HierarchyReader& reader_;
  exporting::NumberedCut numbered_;
  exporting::NodeCache<std::vector<Vec3f>> positions_;  ///< of places, of coarser neighbours
};

}  // namespace meshhier::inspection
