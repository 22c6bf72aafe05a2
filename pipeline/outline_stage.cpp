#include "pipeline/outline_stage.h"

#include "execution/parallel.h"
#include "outline/crest_lines.h"
#include "outline/outline_builder.h"
#include "outline/subdivision.h"
#include "pipeline/plan/tile_room.h"
#include "storage/format/outline_glb.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::pipeline {
namespace {

// The file has at most 32 kB for any model (docs/architecture.md, Outline).
constexpr std::size_t kOutlineBytes = 32000;

// So many border triangles and border edges, then segments, are held at a time, whatever the
// budget, as the result may not depend on it. The file has room for 2000 points; a mesh with more
// edges than this (open patches, soup) is outlined on a coarser level, where they are fewer. Level
// 0 is outlined anyhow.
constexpr std::size_t kMostEdges = 131072;
constexpr std::size_t kMostSegments = 2 * kMostEdges;
constexpr std::uint64_t kEdgeBytes = 100;
constexpr std::uint64_t kSegmentBytes = 45;

/// A tile has vertices enough for so many sectors; finer tiles cost more and show no more.
constexpr std::uint32_t kTileSectors = 32;

/// Returns the finest level with no more nodes than the sectors need.
Level sector_level(const Tree& tree, std::uint32_t sectors) {
  Level level{0};
  while (level < tree.depth() && tree.node_count(finer(level)) <= sectors / kTileSectors)
    level = finer(level);
  return level;
}

/// Divides the level's tiles into sectors; returns none if each tile is one sector.
outline::Sectors divide(Forest& forest, Level level, std::uint32_t parts, const TileRoom& room,
                        const StageContext& context) {
  outline::Sectors sectors;
  if (parts == 1)
    return sectors;
  execution::ordered_for(
      forest.tree().node_count(level), room.in_flight(), context.cancel,
      [&](std::size_t i) {
        const NodeId node{level, static_cast<std::uint32_t>(i)};
        return outline::divide(forest.load(node).mesh, parts);
      },
      [&](std::size_t, outline::Sectors::value_type sector) {
        sectors.push_back(std::move(sector));
      });
  return sectors;
}

/// Adds all sectors of a level; returns false if their lines are too many and there is a coarser
/// level.
bool collect(Forest& forest, Level level, outline::OutlineBuilder& builder, std::uint32_t parts,
             const StageContext& context) {
  using Collected = std::optional<outline::OutlineBuilder::Sector>;
  const std::uint32_t count = forest.tree().node_count(level);
  context.progress.stage("outline", count, "sectors");
  std::atomic<bool> too_many{false};
  const TileRoom room = room_for(forest, context.memory(), {heaviest_read(forest, level)});
  const outline::Sectors sectors = divide(forest, level, parts, room, context);
  execution::ordered_for(
      count, room.in_flight(), context.cancel,
      [&](std::size_t i) -> Collected {
        if (too_many)
          return std::nullopt;
        const auto index = static_cast<std::uint32_t>(i);
        return Collected(std::in_place, index, forest.load({level, index}).mesh, sectors);
      },
      [&](std::size_t, Collected sector) {
        if (too_many)
          return;
        builder.add(std::move(*sector));
        too_many = builder.edge_count() > kMostEdges && level > Level{0};
        context.progress.advance(1);
      });
  return !too_many;
}

std::size_t join(Forest& forest, outline::OutlineBuilder& builder, const StageContext& context) {
  const TileRoom room = room_for(forest, context.memory(), {builder.edge_count() * kEdgeBytes});
  return builder.join();
}

/// Returns the crest lines of the coarsest level, which is one tile: the whole model at the scale
/// of a thumbnail.
std::vector<outline::CrestLine> crest_lines(Forest& forest) {
  return outline::crest_lines(forest.load({Level{0}, 0}).mesh);
}

}  // namespace

StageTimes outline_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kVertexSeconds = 0.1e-6;  // a vertex of the tiles of one level
  const double sectors = std::min<double>(job.outline_sectors, tiles.simplified.count);
  const double vertices = tiles.simplified.count > 0
                              ? tiles.simplified.vertices / tiles.simplified.count
                              : tiles.partitions.vertices;
  return {{"outline", "sectors", 0, std::max(sectors, 1.0) * vertices * kVertexSeconds}};
}

OutlineStageResult make_outline(Forest& forest, double diagonal, const StageContext& context) {
  const config::OutlineConfig& config = context.config.outline;
  outline::OutlineOptions options;
  options.tolerance = config.tolerance;
  options.diagonal = std::max(diagonal, 1e-30);
  options.max_bytes = kOutlineBytes;
  options.file_bytes = storage::outline_bytes;
  const std::vector<outline::CrestLine> crests = crest_lines(forest);
  for (Level level = sector_level(forest.tree(), config.sectors);; level = coarser(level)) {
    const std::uint32_t tiles = forest.tree().node_count(level);
    const std::uint32_t sectors = outline_sectors(tiles, config.sectors);
    outline::OutlineBuilder builder;
    if (!collect(forest, level, builder, sectors / tiles, context))
      continue;
    builder.add(crests);
    const std::size_t segments = join(forest, builder, context);
    if (segments > kMostSegments && level > Level{0})
      continue;
    const TileRoom room = room_for(forest, context.memory(), {segments * kSegmentBytes});
    outline::OutlineResult result = builder.finish(options);
    return {
        std::move(result.outline),
        {raw(level), sectors, result.tolerance, result.polylines_found, result.polylines_dropped}};
  }
}

}  // namespace meshhier::pipeline
