#include "export/piece_mesh.h"

#include "base/error.h"
#include "export/manifest_config.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <cstddef>
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

void copy_file(const storage::File& from, storage::File& to, const execution::CancelToken& cancel) {
  constexpr std::uint64_t kBlock = std::uint64_t{1} << 20;
  std::vector<std::byte> block;
  for (std::uint64_t at = 0; at < from.size(); at += block.size()) {
    cancel.check();
    block.resize(std::min(kBlock, from.size() - at));
    from.read_exact(at, block);
    to.write_at(at, block);
  }
}

/// Says that the objects of the mesh are those of a table, by their numbers there: as a label of a
/// PLY, as names in an OBJ.
void take_objects(const storage::HierarchyReader& whole, const fs::path& table, bool is_obj,
                  config::Config& config) {
  config.objects.table = table;
  if (is_obj) {
    config.objects.from = {mesh_io::ObjectSource::object};
    return;
  }
  const auto& values = whole.tile_format().attributes.values;
  const std::string name = std::ranges::find_if(values, &ScalarAttribute::is_object)->name;
  config.objects.from = {mesh_io::ObjectSource::label, name};
  mesh_io::AttributeChoice& read = config.attributes;
  if (read.labels)
    read.labels->push_back(name);
  if (read.which != mesh_io::AttributeChoice::Which::all) {
    read.which = mesh_io::AttributeChoice::Which::named;
    read.names.push_back(name);
  }
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
  config.view = {};
  config.objects.from = {mesh_io::ObjectSource::none};
  config.objects.table.clear();
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
  const storage::HierarchyReader whole(place.files(), hierarchy);
  const bool is_textured = whole.manifest().textures.has_value();
  folder_.emplace(local, options.output);
  if (whole.manifest().objects) {
    static_cast<void>(whole.open_objects());  // refuses the table of another build
    const fs::path table = storage::objects_path(folder_->path());
    copy_file(*place.files().open(storage::objects_path(hierarchy)), *local.create(table), cancel);
    take_objects(whole, table, is_textured, config_);
  }
  ExportOptions mesh = options;
  mesh.numbers_objects = true;
  mesh.output = folder_->path() / (hierarchy.stem().string() + (is_textured ? ".obj" : ".ply"));
  config_.input = mesh.output;
  export_mesh(files, hierarchy, mesh, progress, cancel);
}

}  // namespace meshhier::exporting
