// A piece of a hierarchy on its way to become one of its own.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "inspection/export.h"
#include "storage/io/file.h"

#include <filesystem>

namespace meshhier::inspection {

/// Whether an output of export is a hierarchy: NAME.hier or NAME.3tz.
bool is_hierarchy_name(const std::filesystem::path& output);

/// A temporary mesh beside the output, with the config by which the whole was built. It goes with
/// the object.
///
/// A piece has another tree than the whole, as partitions have equal vertex counts: all of its
/// simplified levels are to be made. Coordinates are the whole's, and vertices and triangles of the
/// original partitions come bit for bit; of a textured hierarchy through the text of an OBJ.
class PieceMesh {
 public:
  /// Exports it. `files`: where the hierarchy lies; `local`: where the output does. Throws as
  /// export_mesh(), Error(usage) if the output is the hierarchy, or the outline is asked for.
  PieceMesh(storage::FileSystem& files, const std::filesystem::path& hierarchy,
            const ExportOptions& options, storage::FileSystem& local, execution::Progress& progress,
            const execution::CancelToken& cancel);
  PieceMesh(const PieceMesh&) = delete;
  PieceMesh& operator=(const PieceMesh&) = delete;
  ~PieceMesh();

  const config::Config& config() const { return config_; }

 private:
  storage::FileSystem& local_;
  std::filesystem::path folder_;
  config::Config config_;
};

}  // namespace meshhier::inspection
