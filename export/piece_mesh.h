// A piece of a hierarchy, as the input of a hierarchy of its own.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/export.h"
#include "storage/format/work_folder.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace meshhier::exporting {

/// Beside a hierarchy, for the mesh that it is made of.
using MeshFolder = storage::WorkFolder;

/// Returns whether an output of export is a hierarchy: NAME.hier or NAME.3tz.
bool is_hierarchy_name(const std::filesystem::path& output);

/// Returns the config by which a hierarchy was built, for another one like it that becomes
/// `output`; without input and crop. Throws as HierarchyReader, and as storage::check_output().
config::Config config_like(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                           const std::filesystem::path& output, bool replace,
                           std::uint64_t memory_budget, storage::FileSystem& local);

/// A temporary mesh beside the output, with the config by which the whole was built. It goes with
/// the object.
///
/// A piece has another tree than the whole, as partitions have equal vertex counts: all of its
/// simplified levels are made anew. Coordinates are the whole's, and vertices and triangles of the
/// original partitions come bit for bit; those of a textured hierarchy come through the text of an
/// OBJ. Its objects keep their names and properties.
class PieceMesh {
 public:
  /// Exports the piece. `files` has the hierarchy, `local` the output. Throws as export_mesh(),
  /// Error(usage) if the output is the hierarchy, or the outline is asked for.
  PieceMesh(storage::FileSystem& files, const std::filesystem::path& hierarchy,
            const ExportOptions& options, storage::FileSystem& local, execution::Progress& progress,
            const execution::CancelToken& cancel);

  const config::Config& config() const { return config_; }

 private:
  std::optional<MeshFolder> folder_;
  config::Config config_;
};

}  // namespace meshhier::exporting
