#include "export/piece_mesh.h"

#include "base/error.h"
#include "export/manifest_config.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <string>
#include <variant>
#include <vector>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;

void require_no_outline(const ExportOptions& options) {
  if (std::holds_alternative<OutlineSelection>(options.selection))
    throw Error(ErrorCode::usage, "the outline is lines, of which no hierarchy is made");
}

}  // namespace

bool is_hierarchy_name(const fs::path& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".hier" || ending == ".3tz";
}

config::Config config_like(storage::FileSystem& files, const fs::path& hierarchy,
                           const fs::path& output, bool replace, std::uint64_t memory_budget,
                           storage::FileSystem& local) {
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader whole(place.files(), hierarchy);
  config::Config config = config_of(whole.manifest());
  config.output = output;
  config.weld = false;
  config.crop.reset();
  config.memory_budget = memory_budget;
  config.storage.container = storage::lower_extension(output) == ".3tz"
                                 ? storage::Container::archive
                                 : storage::Container::files;
  if (config.partition.count) {  // tiles as large as the whole's
    config.partition.count.reset();
    const Tree& tree = whole.tree();
    config.partition.vertices = static_cast<std::uint32_t>(tree.ranks({tree.depth(), 0}).size());
  }
  if (!config.units)
    config.units = whole.manifest().units;
  storage::check_output(local, {config.output, config.storage.container}, replace);
  return config;
}

PieceMesh::PieceMesh(storage::FileSystem& files, const fs::path& hierarchy,
                     const ExportOptions& options, storage::FileSystem& local,
                     execution::Progress& progress, const execution::CancelToken& cancel) {
  require_no_outline(options);
  std::vector<fs::path> inputs = files_named(options);
  inputs.push_back(hierarchy);
  storage::require_apart(files, options.output, inputs);
  config_ =
      config_like(files, hierarchy, options.output, options.replace, options.memory_budget, local);
  const storage::HierarchyFiles place(files, hierarchy);
  const bool is_textured =
      storage::HierarchyReader(place.files(), hierarchy).manifest().textures.has_value();
  folder_.emplace(local, options.output);
  ExportOptions mesh = options;
  mesh.output = folder_->path() / (hierarchy.stem().string() + (is_textured ? ".obj" : ".ply"));
  config_.input = mesh.output;
  export_mesh(files, hierarchy, mesh, progress, cancel);
}

}  // namespace meshhier::exporting
