// The picture of the whole model, of tiles that are published.
#pragma once

#include "hierarchy/published.h"
#include "pipeline/plan/job_size.h"
#include "pipeline/plan/stage_context.h"
#include "storage/format/manifest.h"
#include "storage/format/tile_glb.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace meshhier::pipeline {

/// What making it holds, of tiles as they are on average.
std::uint64_t preview_memory(const JobSize& job);

/// CPU seconds, of any model.
inline constexpr double kPreviewSeconds = 0.3;

struct PreviewInput {
  const std::filesystem::path& directory;  ///< that the tiles are in
  const storage::TileFormat& format;
  std::span<const TileRecord> records;  ///< of all tiles, ascending by node
};

struct MadePreview {
  storage::Preview facts;
  std::vector<std::byte> file;  ///< a WebP
};

/// Draws the finest level that is quick to draw, or the root. Throws Error(corrupt | io) if a tile
/// is not as it was published.
MadePreview make_preview(const PreviewInput& input, const StageContext& context);

}  // namespace meshhier::pipeline
