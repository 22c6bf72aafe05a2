#include "app/piece_hierarchy.h"

#include "hierarchy/error.h"
#include "inspection/manifest_config.h"
#include "pipeline/build.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <random>
#include <variant>

namespace meshhier::app {
namespace {

namespace fs = std::filesystem;

/// A folder beside the output that goes with its object.
class TemporaryFolder {
 public:
  TemporaryFolder(storage::FileSystem& files, const fs::path& output)
      : files_(files), path_(storage::verify_scratch_path(output, std::random_device()())) {
    files_.make_directories(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    try {
      files_.remove_all(path_);
    } catch (const Error&) {  // `clean` finds it
    }
  }
  const fs::path& path() const { return path_; }

 private:
  storage::FileSystem& files_;
  fs::path path_;
};

/// That of the whole, for the piece.
config::Config config_for(const storage::HierarchyReader& whole, const fs::path& mesh,
                          const inspection::ExportOptions& options) {
  config::Config config = inspection::config_of(whole.manifest());
  config.input = mesh;
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

}  // namespace

bool is_hierarchy_name(const fs::path& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".hier" || ending == ".3tz";
}

std::string make_piece_hierarchy(storage::FileSystem& files, const fs::path& hierarchy,
                                 const inspection::ExportOptions& options,
                                 execution::Progress& progress, const Environment& environment) {
  if (std::holds_alternative<inspection::OutlineSelection>(options.selection))
    throw Error(ErrorCode::usage, "the outline is lines, of which no hierarchy is made");
  const bool is_on_disk = &files == &environment.files;
  if (is_on_disk)
    storage::require_apart(files, options.output, {&hierarchy, 1});
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader whole(place.files(), hierarchy);
  storage::FileSystem& local = environment.files;
  const bool is_textured = whole.manifest().textures.has_value();
  const TemporaryFolder folder(local, options.output);
  const std::string name = hierarchy.stem().string() + (is_textured ? ".obj" : ".ply");
  const config::Config config = config_for(whole, folder.path() / name, options);
  storage::check_output(local, {config.output, config.storage.container}, options.replace);
  inspection::ExportOptions mesh = options;
  mesh.output = config.input[0];
  inspection::export_mesh(files, hierarchy, mesh, progress, environment.cancel);
  pipeline::BuildOptions build{.force = options.replace, .restart = true};
  build.leaves_work = false;
  const pipeline::BuildReport report =
      pipeline::build_hierarchy(config, build, {local, progress, environment.cancel});
  return report.text + "its simplified levels are new: a piece has another tree than the whole";
}

}  // namespace meshhier::app
