// Tells what a hierarchy is made of, from its manifest and index alone.
#pragma once

#include "hierarchy/ids.h"
#include "storage/io/file.h"

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace meshhier::inspection {

/// The part that is told. Both unset: everything.
struct InspectOptions {
  std::optional<Level> level;  ///< this level, tile by tile
  std::optional<NodeId> node;  ///< the tile that stands for this node
};

/// Returns a text for people: source, parameters, a table per level, compactness, outline, totals.
/// Reads manifest and index, no tile; time and memory O(tiles). Deterministic. Throws Error(io |
/// corrupt) if they cannot be read, Error(usage) if the tree has no such level or node.
std::string inspect_text(storage::FileSystem& files, const std::filesystem::path& directory,
                         const InspectOptions& options);

/// Returns the same for scripts: one object with source, parameters, partitions, levels, outline,
/// totals, total_bytes, objects if there are any; with options.level also `tiles` (an array), with
/// options.node also `tile`.
nlohmann::ordered_json inspect_json(storage::FileSystem& files,
                                    const std::filesystem::path& directory,
                                    const InspectOptions& options);

}  // namespace meshhier::inspection
