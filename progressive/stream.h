// Makes a progressive stream of a finished hierarchy: a base and its details.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/ids.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::progressive {

struct ProgressiveOptions {
  std::optional<NodeId> node;  ///< a sector on its own; not set: the whole model
  std::optional<std::uint32_t>
      steps;                     ///< details, 1 to the levels below the node; not set: as many
  std::filesystem::path output;  ///< a directory
  bool replace = false;          ///< a stream that is there
  std::uint64_t memory_budget = 1U << 30;  ///< bytes
};

/// Writes the stream. With each file it shows a level of the hierarchy exactly: the same triangles
/// as sets of places. With the last it is the original mesh bit for bit: vertices by rank,
/// triangles in the order of progressive/traced_tile.h; a sector also has the corners of its border
/// that belong to others, behind its own. The output appears complete or not at all. Returns a line
/// for people. Deterministic: the bytes do not depend on threads or budget. Throws Error(usage) if
/// the hierarchy was not made by half_edge, has copies (hierarchy/tile_mesh.h), or has no such node
/// or so many levels; Error(exists | io | corrupt), Error(budget) for memory or disk.
std::string write_progressive(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                              const ProgressiveOptions& options, execution::Progress& progress,
                              const execution::CancelToken& cancel);

}  // namespace meshhier::progressive
