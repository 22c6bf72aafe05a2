// Proves that a hierarchy on disk keeps its promises.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "mesh_io/input_paths.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::verifying {

struct VerifyOptions {
  mesh_io::InputPaths input;  ///< the mesh it was made from, in the same order: proves it lossless
  std::uint32_t cuts = 20;    ///< random cuts whose seams are checked
  std::uint64_t seed = 1;     ///< seed of the random cuts
  /// If given, only the manifest and the tiles that may have something there are checked. Not with
  /// input.
  exporting::RegionRequest region{};
  std::uint64_t memory_budget = 1U << 30;  ///< bytes
  /// The folder of temporary files; if not given, they lie beside the hierarchy.
  std::optional<std::filesystem::path> scratch_folder{};
};

struct VerifyReport {
  std::vector<std::string> problems;  ///< each names its tile or file; empty: all is well
  std::vector<std::string> checks;    ///< what was checked and found, for people
};

/// Checks, in this order: sizes and checksums of all files, none missing, none extra; the structure
/// (counts, bounds, parent maps, ghosts, border lists, chains, errors); that every simplified tile
/// is the image of its children, which proves every cut seamless; the seams of random cuts; and,
/// given the input, that the partitions are exactly the input. Goes on after a problem and lists up
/// to a hundred: a defect of the hierarchy is a problem in the report, not an exception. Memory
/// stays about `memory_budget`; temporary files are removed. Throws Error(io) if
/// there is no hierarchy, Error(input) if the input mesh is broken, Error(usage) if a region comes
/// with an input, and as exporting::region_of(), Error(interrupted).
VerifyReport verify_hierarchy(storage::FileSystem& files, const std::filesystem::path& directory,
                              const VerifyOptions& options, execution::Progress& progress,
                              const execution::CancelToken& cancel);

}  // namespace meshhier::verifying
