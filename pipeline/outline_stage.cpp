#include "pipeline/outline_stage.h"

#include "outline/outline_builder.h"
#include "storage/outline_glb.h"

#include <algorithm>

namespace meshhier::pipeline {
namespace {

// At most 32 kB for any model (docs/architecture.md, Outline).
constexpr std::size_t kOutlineBytes = 32000;

/// The finest level with no more than `sectors` nodes.
Level sector_level(const Tree& tree, std::uint32_t sectors) {
  Level level{0};
  while (level < tree.depth() && tree.node_count(finer(level)) <= sectors)
    level = finer(level);
  return level;
}

}  // namespace

OutlineStageResult make_outline(const Forest& forest, const OutlineConfig& config, double diagonal,
                                Progress& progress, const CancelToken& cancel) {
  const Level level = sector_level(forest.tree(), config.sectors);
  const std::uint32_t count = forest.tree().node_count(level);
  progress.stage("outline", count, "sectors");
  outline::OutlineBuilder builder;
  for (std::uint32_t index = 0; index < count; ++index) {
    cancel.check();
    builder.add(index, forest.load({level, index}).mesh);
    progress.advance(1);
  }
  outline::OutlineOptions options;
  options.tolerance = config.tolerance;
  options.diagonal = std::max(diagonal, 1e-30);
  options.max_bytes = kOutlineBytes;
  options.file_bytes = storage::outline_bytes;
  outline::OutlineResult result = builder.finish(options);
  return {std::move(result.outline),
          {raw(level), count, result.tolerance, result.polylines_found, result.polylines_dropped}};
}

}  // namespace meshhier::pipeline
