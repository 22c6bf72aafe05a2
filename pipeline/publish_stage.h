// The stage `publish`: tiles as GLB, the index, the outline and the manifest.
#pragma once

#include "hierarchy/asked_vertices.h"
#include "hierarchy/published.h"
#include "pipeline/build_journal.h"
#include "pipeline/cancel.h"
#include "pipeline/config.h"
#include "pipeline/forest.h"
#include "pipeline/memory_plan.h"
#include "pipeline/outline_stage.h"
#include "pipeline/progress.h"
#include "storage/file.h"
#include "storage/tile_glb.h"

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
  AskedVertices asked_vertices = 8192;  ///< of simplified tiles
  bool is_temporary = false;  ///< the files become an archive: they need not reach the disk
};

/// Writes the whole hierarchy into `directory`, but for tiles that the journal has there.
void publish(Forest& forest, BuildJournal& journal, const PublishInput& input,
             const std::filesystem::path& directory, const MemoryPlan& plan,
             storage::FileSystem& files, Progress& progress, const CancelToken& cancel);

}  // namespace meshhier::pipeline
