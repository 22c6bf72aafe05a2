// The table from ids to provisional ranks (partition/rank_table.h), made by slices of the input.
//
// A slice does not know how many vertices of a chunk the slices before it have. So it gives ranks
// as if it were the first, and the counts of all slices tell later by how much they are off.
#pragma once

#include "partition/chunk.h"
#include "pipeline/plan/share.h"
#include "storage/io/blob_store.h"

#include <cstdint>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// The ids [first, end).
struct IdRange {
  std::uint64_t first = 0, end = 0;
};

class SlicedRanks {
 public:
  /// Stands in the place of a copy's rank, which is that of its place.
  static constexpr std::uint32_t kCopy = UINT32_MAX;

  /// `blocks`: their number, in the order of ids; a slice has a Share of them. Refers to `map`.
  SlicedRanks(const partition::ChunkMap& map, std::uint64_t vertices, std::uint64_t blocks,
              storage::ScratchFile& scratch)
      : map_(&map),
        vertex_count_(vertices),
        blobs_(scratch, blocks),
        before_{std::vector<std::uint32_t>(map.count())} {}

  /// Notes the ranks of the vertices of a block, counted within its slice.
  void put(std::uint64_t block, std::span<const std::uint32_t> ranks) {
    blobs_.put(block, std::as_bytes(ranks));
  }

  /// Returns where the scratch file holds the blocks of a slice. `counts`: its places, by chunk.
  nlohmann::json store(const Share& slice, std::span<const std::uint32_t> counts) const;
  /// Takes that of the next slice, from the first on. Returns false if it contradicts the map.
  /// Throws nlohmann::json::exception if `stored` is nothing of the kind.
  bool restore(const Share& slice, const nlohmann::json& stored);

  /// Whether the slices that were restored are all vertices of the mesh.
  bool is_whole() const;
  /// Returns the vertices of a slice that was restored.
  IdRange ids_of(const Share& slice) const;
  /// Reads the final ranks of the vertices from `id` on. Requires is_whole(). Thread-safe. Throws
  /// Error(corrupt) that names the file if it does not hold what was stored.
  void read(std::uint64_t id, std::span<std::uint32_t> ranks) const;

 private:
  bool add_counts(const nlohmann::json& counts);
  void correct(std::uint32_t slice, std::span<std::uint32_t> ranks) const;

  const partition::ChunkMap* map_;
  std::uint64_t vertex_count_;
  storage::BlobStore blobs_;
  std::vector<std::uint64_t> vertices_{0};  ///< in all blocks before each that was restored
  std::vector<std::uint32_t> slices_;       ///< the slice of each of these blocks
  std::vector<std::vector<std::uint32_t>>
      before_;  ///< for each slice, and behind the last: the places before it, by chunk
};

}  // namespace meshhier::pipeline
