#include "inspection/piece_mesh.h"

#include "hierarchy/error.h"
#include "inspection/manifest_config.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <random>
#include <string>
#include <variant>

namespace meshhier::inspection {
namespace {

namespace fs = std::filesystem;

/// That of the whole, but for the files.
config::Config config_for(const storage::HierarchyReader& whole, const ExportOptions& options) {
  config::Config config = config_of(whole.manifest());
  config.output = options.output;
  config.weld = false;
  config.memory_budget = options.memory_budget;
  config.storage.container = storage::lower_extension(options.output) == ".3tz"
                                 ? storage::Container::archive
                                 : storage::Container::files;
  if (config.partition.count) {  // tiles as large as the whole's
    config.partition.count.reset();
    const Tree& tree = whole.tree();
    config.partition.vertices = static_cast<std::uint32_t>(tree.ranks({tree.depth(), 0}).size());
  }
  if (!config.units)
    config.units = whole.manifest().units;
  return config;
}

void require_apart(storage::FileSystem& files, const fs::path& hierarchy,
                   const ExportOptions& options, const storage::FileSystem& local) {
  if (std::holds_alternative<OutlineSelection>(options.selection))
    throw Error(ErrorCode::usage, "the outline is lines, of which no hierarchy is made");
  if (&files == &local)
    storage::require_apart(files, options.output, {&hierarchy, 1});
}

}  // namespace

bool is_hierarchy_name(const fs::path& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".hier" || ending == ".3tz";
}

PieceMesh::PieceMesh(storage::FileSystem& files, const fs::path& hierarchy,
                     const ExportOptions& options, storage::FileSystem& local,
                     execution::Progress& progress, const execution::CancelToken& cancel)
    : local_(local), folder_(storage::verify_scratch_path(options.output, std::random_device()())) {
  require_apart(files, hierarchy, options, local);
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader whole(place.files(), hierarchy);
  config_ = config_for(whole, options);
  config_.input =
      folder_ / (hierarchy.stem().string() + (whole.manifest().textures ? ".obj" : ".ply"));
  storage::check_output(local_, {config_.output, config_.storage.container}, options.replace);
  ExportOptions mesh = options;
  mesh.output = config_.input[0];
  local_.make_directories(folder_);
  try {
    export_mesh(files, hierarchy, mesh, progress, cancel);
  } catch (...) {
    local_.remove_all(folder_);
    throw;
  }
}

PieceMesh::~PieceMesh() {
  try {
    local_.remove_all(folder_);
  } catch (const Error&) {  // `clean` finds it
  }
}

}  // namespace meshhier::inspection
