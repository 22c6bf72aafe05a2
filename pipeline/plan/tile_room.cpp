#include "pipeline/plan/tile_room.h"

#include "base/error.h"
#include "execution/allocator.h"
#include "execution/size_text.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {

namespace {

// A usual tile has 10 MiB at work and leaves some 3 MiB behind: memory is given back every 64
// tiles.
constexpr std::uint64_t kBytesBetweenReleases = std::uint64_t{640} << 20;
constexpr std::uint64_t kMostBetweenReleases = 64;

constexpr std::uint64_t kBudgetStep = std::uint64_t{1} << 20;

/// Returns how much more budget has room for the lacking bytes. A part of it is the allocator's
/// (kAllocatorParts), which may lack its part of the present one, too.
std::uint64_t more_budget(const MemoryPlan& plan, std::uint64_t lacking) {
  return ((lacking + plan.budget_bytes / kAllocatorParts) / (kAllocatorParts - 1) *
              kAllocatorParts / kBudgetStep +
          1) *
         kBudgetStep;
}

[[noreturn]] void refuse(const MemoryPlan& plan, const storage::MemoryPool& pool,
                         const TileRoom::Heaviest& heaviest) {
  const std::uint64_t needed = std::max(heaviest.now, heaviest.ahead);
  const std::uint64_t lacking = needed - plan.work_bytes - pool.free_bytes();
  const std::string others =
      needed > heaviest.now
          ? fmt::format(", and others up to {}", execution::rounded_size_text(heaviest.ahead))
          : "";
  throw Error(
      ErrorCode::budget,
      fmt::format("a tile of the mesh has so many triangles or vertices at few places that it "
                  "takes {}{}; it needs a memory_budget larger by {}",
                  execution::rounded_size_text(heaviest.now), others,
                  execution::exact_size_text(more_budget(plan, lacking))));
}

std::uint64_t most_triangle_bytes(const Forest& forest, std::span<const NodeId> nodes) {
  std::uint64_t most = 0;
  for (const NodeId node : nodes)
    most = std::max(most, forest.triangle_bytes(node));
  return most;
}

}  // namespace

TileRoom::TileRoom(const MemoryPlan& plan, storage::MemoryPool& pool, const Heaviest& heaviest)
    : pool_(pool),
      in_flight_(plan.tiles_in_flight),
      items_between_releases_(std::clamp<std::uint64_t>(
          kBytesBetweenReleases / std::max<std::uint64_t>(heaviest.now, 1), 1,
          kMostBetweenReleases)) {
  if (heaviest.now * in_flight_ <= plan.work_bytes)
    return;
  if (heaviest.now > plan.work_bytes) {
    const std::uint64_t lacking = heaviest.now - plan.work_bytes;
    if (!pool.try_take(lacking))
      refuse(plan, pool, heaviest);
    taken_ = lacking;
  }
  in_flight_ = std::clamp<std::uint64_t>(plan.work_bytes / heaviest.now, 1, in_flight_);
}

TileRoom room_for(Forest& forest, const MemoryPlan& plan, const TileRoom::Heaviest& heaviest) {
  if (heaviest.now > plan.work_bytes) {
    forest.drop_copies(heaviest.now - plan.work_bytes);
    execution::release_free_memory();
  }
  return {plan, forest.pool(), heaviest};
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

namespace {

/// Returns the bytes of a tile's triangles, foreign corners and copies for each of its vertices:
/// tiles of surfaces have two triangles a vertex, some of which other tiles have too, and as many
/// copies as the mesh has on average.
std::uint64_t usual_bytes(const JobSize& job) {
  const std::uint64_t triangles = 4 * sizeof(TileTriangle) + 2 * sizeof(GhostRef);
  if (!job.has_copies())
    return triangles;
  const std::uint64_t copies = (job.vertex_count - job.place_count) / job.place_count + 1;
  return triangles + 4 * sizeof(CornerWedges) +
         2 * copies * job.vertex_bytes() / Forest::kCopyShare;
}

}  // namespace

std::uint64_t heaviest_contracted_above(const Forest& forest, Level made, Level top,
                                        const JobSize& job) {
  const std::uint64_t usual_share = usual_bytes(job);
  const Tree& tree = forest.tree();
  // Triangles of a surface go with the vertices that go: above, tiles have the usual ones again.
  // The surplus around a few vertices may all stay, so it is added up towards the root.
  std::vector<std::uint64_t> surplus(tree.node_count(made));
  std::uint64_t usual = job.largest_tile * usual_share;
  for (std::uint32_t i = 0; i < surplus.size(); ++i) {
    const NodeId node{made, i};
    if (forest.own_count(node) == 0)
      continue;  // another task's
    const std::uint64_t own = forest.own_count(node) * usual_share;
    const std::uint64_t bytes = forest.triangle_bytes(node);
    surplus[i] = bytes - std::min(bytes, own);
    usual = std::max(usual, own);
  }
  std::uint64_t most = 0;
  for (Level level = made; level > top; level = coarser(level)) {
    // A tile has each of the mesh's triangles once; copies are not counted by the header.
    const std::uint64_t corners = std::uint64_t{tree.node_count(level)} * job.largest_tile;
    const std::uint64_t all =
        job.has_copies() ? UINT64_MAX
                         : job.face_count * sizeof(TileTriangle) + corners * sizeof(GhostRef);
    std::vector<std::uint64_t> joined(tree.node_count(coarser(level)));
    for (std::uint32_t i = 0; i < joined.size(); ++i) {
      std::uint64_t bytes = 0;
      const Tree::Children children = tree.children({coarser(level), i});
      for (const NodeId child : children.span()) {
        bytes += std::min(surplus[child.index], all) + usual;
        joined[i] += surplus[child.index];
      }
      most = std::max(most, bytes);
    }
    surplus = std::move(joined);
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
