// The surface of one level, tile by tile, as viewers draw it.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/published.h"
#include "inspection/cut_mesh.h"
#include "inspection/node_cache.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::bench {

/// A tile of a cut. Ghosts lie where the cut shows them; they keep their normals.
struct ShownTile {
  PublishedTile tile;
  std::vector<std::uint32_t> border;  ///< which of tile.mesh.border it draws
};

/// Not thread-safe.
class LevelSurface {
 public:
  /// `reader` must outlive it. Requires a level of the tree.
  LevelSurface(const storage::HierarchyReader& reader, Level level);

  /// How many tiles there are.
  std::size_t size() const { return numbered_.cut.size(); }
  /// Throws Error(io | corrupt).
  ShownTile load(std::size_t position);

 private:
  void move_ghosts(PublishedTile& tile);

  const storage::HierarchyReader& reader_;
  inspection::NumberedCut numbered_;
  inspection::NodeCache<std::vector<Vec3f>> positions_;  ///< of places, of coarser neighbours
};

}  // namespace meshhier::bench
