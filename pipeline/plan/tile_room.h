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
/// work at a time, and what one alone needs beyond the plan is taken from the pool, until this
/// object goes.
class TileRoom {
 public:
  /// How many bytes are at work for each that Forest::triangle_bytes() tells. Measured with
  /// fans, books and soups: 19 to 22, and half of it where tiles are only read.
  static constexpr std::uint64_t kContracted = 24;
  static constexpr std::uint64_t kRead = 12;
  /// Read and compressed: the plain file, corners in two orders, what finds the orders and the
  /// results take 80 to 90 bytes a triangle more, of which triangle_bytes() tells 12.
  static constexpr std::uint64_t kPacked = kRead + 8;

  /// What items take at work, in bytes.
  struct Heaviest {
    std::uint64_t now = 0;
    std::uint64_t ahead = 0;  ///< of those that come in the same stage, as far as it is known
  };
  /// Throws Error(budget) if there is no room for what is to be done now, naming what would do for
  /// all.
  TileRoom(const MemoryPlan& plan, storage::MemoryPool& pool, const Heaviest& heaviest);
  TileRoom(const TileRoom&) = delete;
  TileRoom& operator=(const TileRoom&) = delete;
  ~TileRoom() { pool_.give_back(taken_); }

  /// Items at a time.
  std::size_t in_flight() const { return in_flight_; }
  /// After so many items free memory should go back to the system (release_free_memory()): what
  /// they leave behind between the blobs that stay adds up.
  std::size_t items_between_releases() const { return items_between_releases_; }

 private:
  storage::MemoryPool& pool_;
  std::uint64_t taken_ = 0;
  std::size_t in_flight_;
  std::size_t items_between_releases_;
};

/// A TileRoom in the forest's pool, of which tiles kept in memory make way; the memory they had
/// goes back to the system.
TileRoom room_for(Forest& forest, const MemoryPlan& plan, const TileRoom::Heaviest& heaviest);

/// Of the tiles of these nodes, what the heaviest takes while it is read, or also compressed.
std::uint64_t heaviest_read(const Forest& forest, std::span<const NodeId> nodes);
std::uint64_t heaviest_packed(const Forest& forest, std::span<const NodeId> nodes);
/// Of a whole level.
std::uint64_t heaviest_read(const Forest& forest, Level level);
/// What the heaviest takes while its tile is made of its children's.
std::uint64_t heaviest_contracted(const Forest& forest, std::span<const NodeId> nodes);
/// The same of coarser levels down to `top`, while the tiles of `made` are there and no coarser
/// ones: with all triangles that are too many for a tile's vertices now, wherever they meet again.
std::uint64_t heaviest_contracted_above(const Forest& forest, Level made, Level top,
                                        const JobSize& job);

/// A budget with room for such an item, if the pool is empty then.
std::uint64_t budget_for(const MemoryPlan& plan, std::uint64_t heaviest_bytes);

/// About the same for the heaviest node of all levels above the chunks, before there are tiles:
/// from triangles that reach across the mesh, and so stay in the tiles of many nodes. Far less
/// where vertices join so that many of these become one, and 0 if there are none: it may warn, not
/// refuse.
std::uint64_t expected_contracted(const Chunks& chunks);

}  // namespace meshhier::pipeline
