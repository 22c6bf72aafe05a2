// From where the model is looked at first, and its picture, of tiles that are published.
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

/// What choosing a first view and making a preview hold, of tiles as they are on average.
std::uint64_t first_view_memory(const JobSize& job);
std::uint64_t preview_memory(const JobSize& job);

/// CPU seconds, of any model.
inline constexpr double kFirstViewSeconds = 0.1;
inline constexpr double kPreviewSeconds = 0.2;

/// From where a model with that root tile is recognised (render::portrait_from()).
Standpoint choose_first_view(const PublishedTile& root, const storage::TileFormat& format);

struct PreviewInput {
  const std::filesystem::path& directory;  ///< that the tiles are in
  const storage::TileFormat& format;
  std::span<const TileRecord> records;  ///< of all tiles, ascending by node
};

struct MadePreview {
  storage::Preview facts;
  std::vector<std::byte> file;  ///< a WebP
};

/// Throws as make_preview().
PublishedTile read_root(const PreviewInput& input, const StageContext& context);

/// Draws the finest level that is quick to draw, or the root, from its first view. Of a model
/// without triangles its vertices are drawn. Throws Error(corrupt | io) if a tile is not as it was
/// published. `root`: as read_root() returns it. Requires that the root has a first view.
MadePreview make_preview(const PreviewInput& input, PublishedTile root,
                         const StageContext& context);

}  // namespace meshhier::pipeline
