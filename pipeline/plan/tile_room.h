// Memory for tiles with far more triangles than vertices.
#pragma once

#include "pipeline/plan/job_size.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace meshhier::pipeline {

/// The memory plan counts with the triangles that vertices of the mesh have on average. Around a
/// vertex of a million triangles, or in a soup, a tile has many times as many: then fewer are at
/// work at a time, and bytes that one alone needs beyond the plan are taken from the pool, until
/// this object goes.
class TileRoom {
 public:
  /// So many bytes are at work for each that Forest::triangle_bytes() tells. Fans, books and soups
  /// took 19 to 22, and half of it where tiles are only read.
  static constexpr std::uint64_t kContracted = 24;
  static constexpr std::uint64_t kRead = 12;
  /// The same for tiles that are read and compressed: the plain file, corners in two orders, the
  /// search for the orders and the results take 80 to 90 bytes a triangle more, of which
  /// triangle_bytes() tells 12.
  static constexpr std::uint64_t kPacked = kRead + 8;

  /// The bytes that the heaviest item takes at work.
  struct Heaviest {
    std::uint64_t now = 0;
    std::uint64_t ahead = 0;  ///< among those to come in the same stage, as far as they are known
  };
  /// Throws Error(budget) if there is no room for the items of now; names a budget that would do
  /// for all.
  TileRoom(const MemoryPlan& plan, storage::MemoryPool& pool, const Heaviest& heaviest);
  TileRoom(const TileRoom&) = delete;
  TileRoom& operator=(const TileRoom&) = delete;
  ~TileRoom() { pool_.give_back(taken_); }

  /// The number of items at a time.
  std::size_t in_flight() const { return in_flight_; }
  /// After so many items free memory should go back to the system (release_free_memory()): each
  /// leaves some behind between the blobs that stay, and that adds up.
  std::size_t items_between_releases() const { return items_between_releases_; }

 private:
  storage::MemoryPool& pool_;
  std::uint64_t taken_ = 0;
  std::size_t in_flight_;
  std::size_t items_between_releases_;
};

/// Returns a TileRoom in the forest's pool. Tiles that are kept in memory make way for it; their
/// memory goes back to the system.
TileRoom room_for(Forest& forest, const MemoryPlan& plan, const TileRoom::Heaviest& heaviest);

/// These return the bytes that the heaviest tile of these nodes takes while it is read, and while
/// it is also compressed.
std::uint64_t heaviest_read(const Forest& forest, std::span<const NodeId> nodes);
std::uint64_t heaviest_packed(const Forest& forest, std::span<const NodeId> nodes);
/// Returns the same for a whole level.
std::uint64_t heaviest_read(const Forest& forest, Level level);
/// Returns the bytes that the heaviest node takes while its tile is made of its children's.
std::uint64_t heaviest_contracted(const Forest& forest, std::span<const NodeId> nodes);
/// Returns the same for coarser levels down to `top`, while the tiles of `made` are there and no
/// coarser ones: with all triangles that are too many for a tile's vertices now, wherever they meet
/// again.
std::uint64_t heaviest_contracted_above(const Forest& forest, Level made, Level top,
                                        const JobSize& job);

/// Returns a budget with room for such an item, if the pool is empty then.
std::uint64_t budget_for(const MemoryPlan& plan, std::uint64_t heaviest_bytes);

/// Returns about the same for the heaviest node of all levels above the chunks, before there are
/// tiles: from triangles that reach across the mesh, and so stay in the tiles of many nodes. The
/// truth is far less where vertices join so that many of these become one: it may warn, not refuse.
/// Returns 0 if there are none.
std::uint64_t expected_contracted(const Chunks& chunks);

}  // namespace meshhier::pipeline
