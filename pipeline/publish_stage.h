// The stage `publish`: tiles as GLB, the index, the outline and the manifest.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/published.h"
#include "hierarchy/target_vertex_counts.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/outline_stage.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/tiles/forest.h"
#include "storage/format/tile_glb.h"
#include "storage/io/file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::pipeline {

/// What the manifest is made of, besides the files.
struct PublishInput {
  SourceSummary source;
  storage::TileFormat format;
  OutlineStageResult outline;
  nlohmann::ordered_json config;
  std::optional<std::uint32_t> position_bits;  ///< of the lattice; none: positions stay exact
  std::optional<Transform> transform;          ///< of the tileset
  std::string licence;
  TargetVertexCounts target_vertex_counts;  ///< of simplified tiles
  bool is_temporary = false;  ///< the files become an archive: they need not reach the disk
};

/// Writes the whole hierarchy into `directory`, but for tiles that the journal has there.
void publish(Forest& forest, BuildJournal& journal, const PublishInput& input,
             const std::filesystem::path& directory, const MemoryPlan& plan,
             storage::FileSystem& files, execution::Progress& progress,
             const execution::CancelToken& cancel);

}  // namespace meshhier::pipeline
