// A hierarchy of a piece of another one.
#pragma once

#include "app/command.h"
#include "execution/progress.h"
#include "inspection/export.h"
#include "storage/io/file.h"

#include <filesystem>
#include <string>

namespace meshhier::app {

/// Whether an output is one: NAME.hier or NAME.3tz.
bool is_hierarchy_name(const std::filesystem::path& output);

/// Exports the piece to a temporary mesh beside the output, and builds that as the hierarchy was
/// built. A piece has another tree than the whole, as partitions have equal vertex counts: all of
/// its simplified levels are made anew. Coordinates are the whole's, and vertices and triangles of
/// the original partitions come bit for bit (of a textured hierarchy through text that says the
/// same). Returns what was made, for people. Throws as inspection::export_mesh and
/// pipeline::build_hierarchy; nothing is left behind then.
std::string make_piece_hierarchy(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                                 const inspection::ExportOptions& options,
                                 execution::Progress& progress, const Environment& environment);

}  // namespace meshhier::app
