#include "pipeline/plan/tile_room.h"

#include "execution/allocator.h"
#include "execution/size_text.h"
#include "hierarchy/error.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::pipeline {

namespace {

// Some 3 MiB stay behind a usual tile, which has 10 MiB at work: every 64 tiles.
constexpr std::uint64_t kBytesBetweenReleases = std::uint64_t{640} << 20;
constexpr std::uint64_t kMostBetweenReleases = 64;

constexpr std::uint64_t kBudgetStep = std::uint64_t{1} << 20;

/// So much more budget has room for what lacks. Of more budget a part is the allocator's
/// (kAllocatorParts), which may lack its part of this one.
std::uint64_t more_budget(const MemoryPlan& plan, std::uint64_t lacking) {
  return ((lacking + plan.budget_bytes / kAllocatorParts) / (kAllocatorParts - 1) *
              kAllocatorParts / kBudgetStep +
          1) *
         kBudgetStep;
}

[[noreturn]] void refuse(const MemoryPlan& plan, const storage::MemoryPool& pool,
                         std::uint64_t needed_bytes) {
  const std::uint64_t lacking = needed_bytes - plan.work_bytes - pool.free_bytes();
  throw Error(
      ErrorCode::budget,
      fmt::format("a tile of the mesh has so many triangles or vertices at few places that it "
                  "takes "
                  "{}; it needs a memory_budget larger by {}",
                  execution::rounded_size_text(needed_bytes),
                  execution::exact_size_text(more_budget(plan, lacking))));
}

std::uint64_t most_triangle_bytes(const Forest& forest, std::span<const NodeId> nodes) {
  std::uint64_t most = 0;
  for (const NodeId node : nodes)
    most = std::max(most, forest.triangle_bytes(node));
  return most;
}

}  // namespace

TileRoom::TileRoom(const MemoryPlan& plan, storage::MemoryPool& pool, std::uint64_t heaviest_bytes)
    : pool_(pool),
      in_flight_(plan.tiles_in_flight),
      items_between_releases_(std::clamp<std::uint64_t>(
          kBytesBetweenReleases / std::max<std::uint64_t>(heaviest_bytes, 1), 1,
          kMostBetweenReleases)) {
  if (heaviest_bytes * in_flight_ <= plan.work_bytes)
    return;
  if (heaviest_bytes > plan.work_bytes) {
    const std::uint64_t lacking = heaviest_bytes - plan.work_bytes;
    if (!pool.try_take(lacking))
      refuse(plan, pool, heaviest_bytes);
    taken_ = lacking;
  }
  in_flight_ = std::clamp<std::uint64_t>(plan.work_bytes / heaviest_bytes, 1, in_flight_);
}

TileRoom room_for(Forest& forest, const MemoryPlan& plan, std::uint64_t heaviest_bytes) {
  if (heaviest_bytes > plan.work_bytes) {
    forest.drop_copies(heaviest_bytes - plan.work_bytes);
    execution::release_free_memory();
  }
  return {plan, forest.pool(), heaviest_bytes};
}

std::uint64_t heaviest_read(const Forest& forest, std::span<const NodeId> nodes) {
  return most_triangle_bytes(forest, nodes) * TileRoom::kRead;
}

std::uint64_t heaviest_packed(const Forest& forest, std::span<const NodeId> nodes) {
  return most_triangle_bytes(forest, nodes) * TileRoom::kPacked;
}

std::uint64_t heaviest_read(const Forest& forest, Level level) {
  std::uint64_t most = 0;
  for (std::uint32_t i = 0; i < forest.tree().node_count(level); ++i)
    most = std::max(most, forest.triangle_bytes({level, i}));
  return most * TileRoom::kRead;
}

std::uint64_t heaviest_contracted(const Forest& forest, std::span<const NodeId> nodes) {
  std::uint64_t most = 0;
  for (const NodeId node : nodes) {
    std::uint64_t bytes = 0;
    const Tree::Children children = forest.tree().children(node);
    for (const NodeId child : children.span())
      bytes += forest.triangle_bytes(child);
    most = std::max(most, bytes);
  }
  return most * TileRoom::kContracted;
}

std::uint64_t expected_contracted(const Chunks& chunks) {
  constexpr std::uint64_t kTiles = 3;  // each such triangle is in those of its corners
  std::uint64_t most = 0;
  for (int l = 1; l <= raw(chunks.level()); ++l) {
    const std::uint64_t parents = std::uint64_t{1} << (l - 1);
    const std::uint64_t triangles = kTiles * chunks.wide_triangles(static_cast<Level>(l)) / parents;
    most = std::max(most, triangles * sizeof(TileTriangle));
  }
  return most * TileRoom::kContracted;
}

std::uint64_t budget_for(const MemoryPlan& plan, std::uint64_t heaviest_bytes) {
  const std::uint64_t room = plan.work_bytes + plan.pool_bytes;
  return plan.budget_bytes + (heaviest_bytes > room ? more_budget(plan, heaviest_bytes - room) : 0);
}

}  // namespace meshhier::pipeline
