#include "pipeline/import_stage.h"

#include "base/error.h"
#include "execution/allocator.h"
#include "hierarchy/value_channels.h"
#include "import/find_copies.h"
#include "import/import_input.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/plan/disk_claims.h"
#include "pipeline/stage_costs.h"
#include "storage/format/layout.h"
#include "storage/format/object_table.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::pipeline {
namespace {

importing::MeshInput::Place place_of(const std::filesystem::path& work,
                                     const std::filesystem::path& objects,
                                     storage::MemoryPool& pool, std::uint64_t sort_bytes,
                                     const BuildEnvironment& environment) {
  return {storage::imported_path(work), work / "import", pool,   sort_bytes, environment.progress,
          environment.cancel,           work / "copies", objects};
}

bool is_to_be_looked_at(const config::Config& config) {
  return config.topology == Topology::place;
}

}  // namespace

importing::ImportMemory import_memory(const importing::MeshInput& input,
                                      const config::Config& config) {
  return importing::plan_import(memory_budget(config), input.files().held_bytes());
}

ImportedBytes imported_by(const importing::MeshInput& input) {
  return {input.imported_bytes(), input.objects() ? input.objects()->facts.bytes : 0};
}

std::uint64_t import_disk(const importing::MeshInput& input, const config::Config& config) {
  const importing::ImportMemory memory = import_memory(input, config);
  const std::uint64_t imported =
      input.needs_import() ? importing::predict_import(input.files(), memory) : 0;
  if (!is_to_be_looked_at(config))
    return imported;
  const std::uint64_t look = importing::look_bytes(input.description());
  return std::max(imported, input.imported_bytes() + look - std::min(look, memory.pool_bytes));
}

std::vector<StageTime> import_time(const importing::MeshInput& input,
                                   const config::Config& config) {
  // 10 ns a byte for OBJ to 34 for binary STL, whose corners are sorted. Texts have 43 bytes a
  // triangle, binary STL 50; gzip packs them to a third or a quarter, and takes as long again.
  constexpr double kByteSeconds = 20e-9;
  constexpr double kTriangleBytes = 45;
  constexpr double kPacked = 4;
  constexpr double kVertexSeconds = 40e-9;  // to find those that lie together
  double bytes = 0;
  for (const importing::InputFileFacts& file : input.files().all())
    bytes += static_cast<double>(file.identity.bytes) * (file.format.is_gzip ? kPacked : 1);
  if (input.files().mosaic())
    bytes += 2 * kTriangleBytes * static_cast<double>(input.files().mosaic()->cells());
  const double rest = bytes / kTriangleBytes * kBuildTriangleSeconds;
  const StageTime others{"", "", 0, rest / static_cast<double>(thread_count(config))};
  const std::uint64_t vertices = input.needs_import() ? 0 : input.description().vertex_count;
  const StageTime look{"import", "vertices", vertices,
                       static_cast<double>(vertices) * kVertexSeconds};
  if (!input.needs_import())
    return {look, others};
  return {{"import", "bytes", input.files().bytes(), bytes * kByteSeconds}, look, others};
}

DiskVolumes imported_disk(const JobSize& job, const TilePopulation& /*tiles*/,
                          const MemoryPlan& /*memory*/) {
  return {{static_cast<double>(job.imported_bytes), DiskMoment::splits, DiskMoment::noted}};
}

void read_once(importing::MeshInput& input, const config::Config& config,
               const importing::MeshInput::Place& place) {
  if (input.needs_import())
    input.import(place);
  if (is_to_be_looked_at(config))
    input.find_copies(place);
}

importing::MeshInput open_input(const config::Config& config, storage::FileSystem& files) {
  return {config.input,
          files,
          {.weld = config.weld,
           .textures = config.texture.use ? importing::Textures::use : importing::Textures::ignore,
           .crop = config.crop_box(),
           .attributes = config.attributes,
           .drape = config.texture.drape,
           .objects = config.objects.from,
           .object_table = config.objects.table,
           .crs = config.placement.crs.value_or(""),
           .tileset = mesh_io::TilesetRoom::of(memory_budget(config))}};
}

bool is_read_before_plan(const importing::MeshInput& input, const config::Config& config) {
  return input.needs_import() || is_to_be_looked_at(config);
}

namespace {

/// Throws if the config names an attribute that the input does not have: it is mistyped.
void require_attributes(const config::Config& config, const importing::MeshInput& input) {
  const AttributeLayout& layout = input.description().attributes;
  const auto require = [&](std::string_view key, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      if (std::ranges::find(layout.values, name, &ScalarAttribute::name) != layout.values.end())
        continue;
      std::vector<std::string> there;
      for (const ScalarAttribute& value : layout.values)
        there.push_back(value.name);
      constexpr std::string_view kOfVertices = "vertex.";
      for (const std::string& unused : input.files().unused()) {
        if (unused.starts_with(kOfVertices))
          there.push_back(unused.substr(kOfVertices.size()));
      }
      throw Error(
          ErrorCode::input,
          fmt::format("{}: {} has no \"{}\" to be read; {}", key, config.input.string(), name,
                      there.empty() ? "there is nothing of that kind"
                                    : fmt::format("there is {}", fmt::join(there, ", "))));
    }
  };
  using Which = mesh_io::AttributeChoice::Which;
  if (config.attributes.which == Which::named)
    require("attributes", config.attributes.names);
  if (config.attributes.labels && config.attributes.which != Which::none)
    require("labels", *config.attributes.labels);
  if (!config.view.attribute.empty())
    require("view.attribute", {config.view.attribute});
}

BuildPlan plan_of(const importing::MeshInput& input, images::MaterialList materials,
                  const config::Config& config, storage::FileSystem& files) {
  require_attributes(config, input);
  BuildPlan plan = plan_build(config, input.description(), imported_by(input),
                              plan_textures(std::move(materials), config.missing_images, files));
  input.files().check_unchanged();
  return plan;
}

}  // namespace

BuildPlan read_and_plan(importing::MeshInput& input, const std::filesystem::path& directory,
                        const std::filesystem::path& objects, storage::MemoryPool& pool,
                        const config::Config& config, const BuildEnvironment& environment) {
  const importing::ImportMemory memory = import_memory(input, config);
  pool.set_capacity(memory.pool_bytes);
  environment.progress.expect(import_time(input, config));
  read_once(input, config, place_of(directory, objects, pool, memory.sort_bytes, environment));
  execution::release_free_memory(memory_budget(config));
  return plan_of(input, input.materials(), config, environment.files);
}

namespace {

/// Returns whether the table of the mesh's objects is gone, or damaged.
bool lacks_objects(const mesh_io::MeshDescription& mesh, const storage::WorkDirectory& work,
                   storage::FileSystem& files) {
  const auto path = storage::imported_objects_path(work.path());
  if (!placed_object(mesh.attributes) || files.kind(path) != storage::FileKind::regular)
    return placed_object(mesh.attributes).has_value();
  try {
    const storage::ObjectTable table(files.open(path));
    return false;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt)
      throw;
    return true;
  }
}

}  // namespace

BuildPlan import_and_plan(importing::MeshInput& input, storage::WorkDirectory& work,
                          storage::MemoryPool& pool, const config::Config& config,
                          const BuildEnvironment& environment) {
  const auto earlier = find_earlier_build(environment.files, work.path());
  work.keep(earlier.has_value());
  auto recalled =
      earlier ? recall_import(*earlier, input, config, environment.cancel) : std::nullopt;
  if (recalled && lacks_objects(*recalled, work, environment.files))
    recalled.reset();
  const auto make_plan = [&] {
    if (!recalled)
      return read_and_plan(input, work.path(), storage::imported_objects_path(work.path()), pool,
                           config, environment);
    input.recall(*recalled);
    return plan_of(input, earlier->materials, config, environment.files);
  };
  BuildPlan plan = make_plan();
  plan.disk.temporary_bytes = std::max(plan.disk.temporary_bytes, import_disk(input, config));
  check_coders(plan.job);
  claim_disk(work.path(), plan.disk.room_bytes, environment.files, pool.scratch_use(),
             [&] { check_disk(plan.disk, config.output, environment.files); });
  return plan;
}

void import_again(importing::MeshInput& input, const storage::WorkDirectory& work,
                  storage::MemoryPool& pool, const StageContext& context) {
  const mesh_io::MeshDescription recalled = input.description();
  const std::uint64_t sort_bytes =
      std::min(import_memory(input, context.config).sort_bytes, context.memory().work_bytes / 4);
  read_once(input, context.config,
            place_of(work.path(), storage::imported_objects_path(work.path()), pool, sort_bytes,
                     {context.files, context.progress, context.cancel}));
  const mesh_io::MeshDescription& mesh = input.description();
  if (mesh.vertex_count != recalled.vertex_count || mesh.places() != recalled.places() ||
      mesh.face_count != recalled.face_count || mesh.attributes != recalled.attributes) {
    throw Error(ErrorCode::input, input.files().name() + " was changed; build it again");
  }
}

bool can_be_read(const importing::MeshInput& input, const config::Config& config) {
  return input.can_be_read() && (!is_to_be_looked_at(config) || input.was_looked_at());
}

}  // namespace meshhier::pipeline
