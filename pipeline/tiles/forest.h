// The hierarchy under construction: every level's tiles, boundaries and parent maps, in scratch
// space.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/build_tile.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "partition/leaf_tiles.h"
#include "storage/format/tile_sums.h"
#include "storage/io/blob_store.h"

#include <cstdint>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// The vertices that the contraction of a tile had to force away. See TileRecord.
struct Fallbacks {
  std::uint32_t torn_count = 0;
  std::uint32_t forced_count = 0;
};

struct LoadedTile {
  BuildTile tile;  ///< with its ghosts at its own level, positions and all
  /// The ghosts at its own level that foreign corners of the tile as it was just made
  /// (WorkTile::foreign) have become.
  std::vector<GhostRef> mapped;
};

/// Tiles are put level by level, finest first. A level's tiles can be loaded once all tiles of that
/// level are there (and, of a simplified level, all parent maps that lead to it). Loading and
/// putting are thread-safe for different nodes. Failures of the scratch file throw Error(io), and
/// Error(corrupt) if another process's file is not as it was.
///
/// An early node has a tile here too: its partition's, kept as it is.
class Forest {
 public:
  /// `layout`: that of partitions; tiles above them have no texture coordinates if those name
  /// materials. `chunks`: the level of the chunks.
  Forest(const Tree& tree, Level chunks, const AttributeLayout& layout,
         storage::ScratchFile& scratch, bool computes_normals = false);

  const Tree& tree() const { return tree_; }
  /// The layout of the tiles of a level.
  const AttributeLayout& layout(Level level) const {
    return level == tree_.depth() ? layout_ : layout_above_;
  }
  bool computes_normals() const { return computes_normals_; }

  void put_places(std::uint32_t chunk, std::span<const partition::LeafPlace> places);
  void put_tile(NodeId node, const LeafTile& tile) { put_work_tile(node, tile); }
  void put_tile(NodeId node, const SimplifiedTile& tile) { put_work_tile(node, tile); }
  /// Whether a tile gets normals of its own: an early node has its partition's.
  bool has_normals(NodeId node) const { return computes_normals_ && !tree_.is_early(node); }
  /// Puts the normals of such a tile, which `mesh` is.
  void put_normals(NodeId node, const OwnShading& normals, const TileMesh& mesh);
  /// Puts the part of a simplified tile that its neighbours may see.
  void put_seam_strip(NodeId node, const SeamStrip& seam_strip);
  /// Puts the map from `child` to its parent's tile.
  void put_parent_map(NodeId child, std::span<const std::uint16_t> parent_map);
  /// Puts the map for its wedges; not needed if all keep their numbers.
  void put_wedge_map(NodeId child, const WedgeMap& wedge_map);

  void put_fallbacks(NodeId node, const Fallbacks& fallbacks) {
    levels_[raw(node.level)].fallbacks[node.index] = fallbacks;
  }
  const Fallbacks& fallbacks(NodeId node) const {
    return levels_[raw(node.level)].fallbacks[node.index];
  }
  std::uint32_t own_count(NodeId node) const {
    return levels_[raw(node.level)].own_counts[node.index];
  }

  /// Returns the bytes of a tile's triangles and foreign corners, and a part of those of its
  /// copies.
  std::uint64_t triangle_bytes(NodeId node) const;
  /// For each byte of a triangle four times as many are at work as for one of a copy (TileRoom):
  /// five with a million vertices at one place.
  static constexpr std::uint64_t kCopyShare = 4;
  /// Returns the sums of all partitions, which must be there.
  storage::TileSums partition_sums() const;
  /// Returns the number of splits of the own vertices of all tiles that will be published. Requires
  /// that all have normals.
  std::uint64_t split_count() const;
  /// The pool that tiles in memory count against.
  storage::MemoryPool& pool() const { return pool_; }

  /// Takes tiles out of memory, which are on disk too, the finest first, until the pool has so much
  /// free. Nothing may be loaded meanwhile.
  void drop_copies(std::uint64_t free_bytes);

  LoadedTile load_with_mapped(NodeId node) const;
  BuildTile load(NodeId node) const { return load_with_mapped(node).tile; }
  OwnShading normals(NodeId node) const;
  /// Returns the part of a tile's normals that neighbours see; for an early node, of its
  /// partition's.
  BoundaryShading boundary_normals(NodeId node) const;
  SeamStrip seam_strip(NodeId node) const;
  /// Returns the map from `child` to its parent's tile.
  std::vector<std::uint16_t> parent_map(NodeId child) const;
  /// Returns the map from `node` to the nearest ancestor that is published; empty for the root.
  std::vector<std::uint16_t> published_parent_map(NodeId node) const;
  /// Returns the map from the tile of `node`, which may stand for its parent, to that of its
  /// ancestor of a level above, which is not early.
  std::vector<std::uint16_t> map_up(NodeId node, Level level) const;
  /// Returns the GhostChain of each ghost of the node's tile, one after another.
  std::vector<std::uint16_t> chains(NodeId node, std::span<const GhostRef> ghosts) const;

  // These return, for the journal, where the scratch file holds what was put, to be restored in
  // another process.

  /// Returns the places of a chunk, and all its partitions.
  nlohmann::json stored_chunk(std::uint32_t chunk) const;
  /// Returns all that was put when a simplified tile was made, the maps to it and the normals of
  /// its children included.
  nlohmann::json stored_tile(NodeId node) const;
  /// Returns the normals of the root, when they are there.
  nlohmann::json stored_root() const;
  /// These return false if the scratch file does not hold it as it was. They throw
  /// nlohmann::json::exception if `stored` is nothing of the kind.
  bool restore_chunk(std::uint32_t chunk, const nlohmann::json& stored);
  bool restore_tile(NodeId node, const nlohmann::json& stored);
  bool restore_root(const nlohmann::json& stored);

 private:
  struct LevelStore {
    storage::BlobStore tiles, boundaries, seam_strips, parent_maps, wedge_maps, normals,
        boundary_normals;
    std::vector<Fallbacks> fallbacks;
    std::vector<std::uint32_t> own_counts;
  };
  nlohmann::json stored_normals(NodeId node) const;
  bool restore_normals(NodeId node, const nlohmann::json& stored);
  template <class Corner>
  void put_work_tile(NodeId node, const WorkTile<Corner>& tile);
  template <class Corner>
  LoadedTile resolved(NodeId node) const;
  std::vector<GhostRef> mapped(NodeId node, std::span<const FinerGhost> foreign) const;
  std::vector<GhostRef> mapped(NodeId partition, std::span<const ChunkVertex> foreign) const;
  /// Gives the foreign corners of the border the wedges that stand for theirs, one level up.
  void map_wedges(NodeId node, SimplifiedTile& tile) const;
  void map_wedges(NodeId, const LeafTile&) const {}  // they are at their own level
  WedgeMap wedge_map(NodeId child) const;
  std::vector<std::uint16_t> parent_map(NodeId child, std::size_t count) const;

  int channels(NodeId node) const { return layout(node.level).channels(); }

  Tree tree_;
  Level chunks_;
  AttributeLayout layout_, layout_above_;
  bool computes_normals_;
  storage::MemoryPool& pool_;
  storage::BlobStore places_;
  std::vector<LevelStore> levels_;
};

}  // namespace meshhier::pipeline
