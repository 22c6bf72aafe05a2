// One HTML file with the viewer and as much of a hierarchy as fits.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace meshhier::inspection {

struct PageOptions {
  std::filesystem::path output;
  bool replace = false;             ///< a file that is there
  std::uint64_t size = 20'000'000;  ///< bytes of the file, at the most
  std::string link;                 ///< where all of the hierarchy is; empty: nowhere
  std::string name;                 ///< of the model
  bool looks_for_story = false;     ///< beside the hierarchy: then the page tells it
};

/// Writes `viewer` (viewer/vite.single.config.ts) with the manifest, the root and more tiles:
/// always both children of the node with the largest error, as long as they fit. Tiles that are not
/// compressed are packed as gzip. Holds a tile. Deterministic. The output appears complete or not
/// at all. Returns a line for people. Throws Error(usage) if not even the root fits, Error(exists |
/// io | corrupt), the last for a story that is no JSON object, too.
std::string write_page(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                       const std::string& viewer, const PageOptions& options,
                       execution::Progress& progress, const execution::CancelToken& cancel);

}  // namespace meshhier::inspection
