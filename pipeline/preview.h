// The view that a model is shown with first, and its picture, from tiles that are published.
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

/// These return the memory that choosing a first view and making a preview take, with tiles as they
/// are on average.
std::uint64_t first_view_memory(const JobSize& job);
std::uint64_t preview_memory(const JobSize& job);

/// CPU seconds, for any model.
inline constexpr double kFirstViewSeconds = 0.1;
inline constexpr double kPreviewSeconds = 0.2;

/// Returns the view in which a model with that root tile is recognised (render::portrait_from()).
Standpoint choose_first_view(const PublishedTile& root, const storage::TileFormat& format);

struct PreviewInput {
  const std::filesystem::path& directory;  ///< has the tiles
  const storage::TileFormat& format;
  std::span<const TileRecord> records;  ///< all tiles', ascending by node
  const SourceSummary& source;
  Vec3d origin;
};

struct MadePreview {
  storage::Preview facts;
  std::vector<std::byte> file;  ///< a WebP
};

/// Reads the root's tile. Throws as make_preview().
PublishedTile read_root(const PreviewInput& input, const StageContext& context);

/// Draws the finest level that is quick to draw, or the root, from its first view, and as the
/// config's view says; the vertices if the model has no triangles. Deterministic. Throws
/// Error(corrupt | io) if a tile is not as it was published. `root`: from read_root(). Requires
/// that the root has a first view.
MadePreview make_preview(const PreviewInput& input, PublishedTile root,
                         const StageContext& context);

}  // namespace meshhier::pipeline
