#include "pipeline/estimate.h"

#include "base/plain_text.h"
#include "config/placement.h"
#include "execution/size_text.h"
#include "import/import_input.h"
#include "import/mesh_input.h"
#include "pipeline/import_stage.h"
#include "pipeline/stage_costs.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/format/work_folder.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>

namespace meshhier::pipeline {
namespace {

using Json = nlohmann::ordered_json;

// Temporary bytes are written once and read about twice.
constexpr double kTemporaryMoves = 3;

// Sweeps over the vertices and the checksum read the input more than once; a part comes from the
// system's cache.
constexpr double kInputReads = 2;

std::uint64_t fixed_memory(const BuildEstimate& e) {
  return e.memory_budget_bytes - e.plan.memory.work_bytes - e.plan.memory.pool_bytes;
}

std::string memory_text(const BuildEstimate& e) {
  const MemoryPlan& memory = e.plan.memory;
  return fmt::format(
      "memory      {} at most, {} would do\n"
      "            {} program, index and allocator, {} stages at work, {} data kept off the "
      "disk\n"
      "            in flight: {}, {}, {}; rank table {}\n",
      execution::exact_size_text(e.memory_budget_bytes),
      execution::exact_size_text(e.least_budget_bytes),
      execution::rounded_size_text(fixed_memory(e)),
      execution::rounded_size_text(memory.work_bytes),
      execution::rounded_size_text(memory.pool_bytes), counted(memory.blocks_in_flight, "blocks"),
      counted(memory.chunks_in_flight, "chunks"), counted(memory.tiles_in_flight, "tiles"),
      execution::rounded_size_text(memory.table_bytes));
}

Json memory_json(const BuildEstimate& e) {
  const MemoryPlan& memory = e.plan.memory;
  return {{"budget_bytes", e.memory_budget_bytes},
          {"least_budget_bytes", e.least_budget_bytes},
          {"fixed_bytes", fixed_memory(e)},
          {"work_bytes", memory.work_bytes},
          {"pool_bytes", memory.pool_bytes},
          {"table_bytes", memory.table_bytes},
          {"blocks_in_flight", memory.blocks_in_flight},
          {"chunks_in_flight", memory.chunks_in_flight},
          {"tiles_in_flight", memory.tiles_in_flight},
          {"pictures_in_flight", memory.pictures_in_flight}};
}

}  // namespace

namespace {

/// Imports an input that is text or packed, or is to be welded, into a folder to count it, and
/// counts places.
void count_by_reading(const config::Config& config, importing::MeshInput& input,
                      const std::filesystem::path& folder, storage::MemoryPool& pool,
                      const execution::CancelToken& cancel) {
  const importing::ImportMemory memory = import_memory(input, config);
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism,
                                         thread_count(config));
  pool.set_capacity(memory.pool_bytes);
  execution::NoProgress silent;
  read_once(input, config,
            {folder / "mesh", folder / "scratch", pool, memory.sort_bytes, silent, cancel,
             folder / "objects"});
}

void describe_import(const importing::InputFiles& input, const importing::ImportMemory& memory,
                     BuildEstimate& estimate) {
  estimate.mesh.format = input.formats() + " (imported to count it)";
  estimate.mesh.file_bytes = input.bytes();
  std::uint64_t& temporary = estimate.plan.disk.temporary_bytes;
  temporary = std::max(temporary, importing::predict_import(input, memory));
}

/// Returns where the config puts the model, for people; reads the vertices if it does.
std::string placement_of(const config::Config& config, importing::MeshInput& input,
                         const execution::CancelToken& cancel) {
  if (!config.placement.longitude && !config.placement.crs)
    return "";
  BoundsD bounds;
  input.open()->read_vertices([&](const mesh_io::VertexBlock& block) {
    cancel.check();
    for (const Vec3f p : block.positions)
      bounds.add(to_double(p));
    for (const Vec3d p : block.exact)
      bounds.add(p);
  });
  const std::optional<Transform> transform = config::tileset_transform(config, bounds);
  return transform ? config::placement_text(config, bounds, *transform) : "";
}

}  // namespace

TimeEstimate estimate_time(const BuildPlan& plan, std::uint64_t input_bytes) {
  TimeEstimate time;
  for (const StageTime& stage : cpu_times(plan))
    time.cpu_seconds += stage.seconds;
  const double moved = kInputReads * static_cast<double>(input_bytes) +
                       kTemporaryMoves * static_cast<double>(plan.disk.temporary_bytes) +
                       static_cast<double>(plan.disk.output_bytes);
  time.wall_seconds = wall_seconds(time.cpu_seconds, plan.threads) + moved / kDiskBytesPerSecond;
  return time;
}

BuildEstimate estimate_build(const config::Config& asked, bool force, storage::FileSystem& files,
                             const execution::CancelToken& cancel) {
  config::Config config = asked;
  config.output = storage::followed(files, asked.output);
  check_apart(config, files);
  storage::check_place(files, config.output);
  storage::MemoryPool pool(0);
  std::optional<storage::WorkFolder> folder;
  importing::MeshInput input = open_input(config, files);
  if (is_read_before_plan(input, config)) {
    storage::check_output(files, {config.output, config.storage.container}, force);
    check_import_disk(import_disk(input, config), config.output, files);
    folder.emplace(files,
                   storage::existing_directory(files, config.output) / config.output.filename());
    count_by_reading(config, input, folder->path(), pool, cancel);
  }
  BuildEstimate estimate{.plan = plan_build(config, input.description(), imported_by(input)),
                         .mesh = input.description(),
                         .tiles = {},
                         .time = {},
                         .disk = storage::existing_directory(files, config.output),
                         .input = config.input,
                         .output = config.output,
                         .placement = {}};
  if (input.needs_import())
    describe_import(input.files(), import_memory(input, config), estimate);
  estimate.placement = placement_of(config, input, cancel);
  input.drop();
  storage::check_output(files, {config.output, config.storage.container}, force);
  check_coders(estimate.plan.job);
  check_disk(estimate.plan.disk, config.output, files);
  estimate.tiles = count_tiles(expected_tiles(estimate.plan.job));
  estimate.time = estimate_time(estimate.plan, estimate.mesh.file_bytes);
  estimate.memory_budget_bytes = memory_budget(config);
  estimate.least_budget_bytes = least_budget(memory_costs(estimate.plan.job));
  estimate.free_bytes = files.free_bytes(estimate.disk);
  estimate.replaced_bytes = storage::bytes_at(files, config.output);
  estimate.left_bytes = storage::bytes_at(files, storage::work_path(config.output));
  return estimate;
}

std::string estimate_text(const BuildEstimate& e) {
  const Tree& tree = e.plan.tree;
  const DiskNeed& disk = e.plan.disk;
  std::string text = fmt::format(
      "input       {}: {}, {}, {}, {}\n"
      "hierarchy   {} of at most {}, {}, {}\n"
      "output      about {}\n"
      "temporary   about {} at most\n"
      "disk        {} needed at once, {} free in {}\n",
      e.input.string(), e.mesh.format, counted_vertices(e.mesh.vertex_count, e.mesh.places()),
      counted(e.mesh.face_count, "faces"), execution::rounded_size_text(e.mesh.file_bytes),
      counted(tree.partition_count(), "partitions"),
      counted((tree.vertex_count() + tree.partition_count() - 1) / tree.partition_count(),
              "vertices"),
      counted(e.tiles.levels, "levels"), counted(e.tiles.tiles(), "tiles"),
      execution::rounded_size_text(disk.output_bytes),
      execution::rounded_size_text(disk.temporary_bytes),
      execution::rounded_size_text(disk.room_bytes), execution::rounded_size_text(e.free_bytes),
      e.disk.string());
  text += memory_text(e);
  text += fmt::format(
      "time        about {} on {}, {} of CPU\n"
      "            (an estimate, for {})\n",
      execution::duration_text(e.time.wall_seconds), counted(e.plan.threads, "threads"),
      execution::duration_text(e.time.cpu_seconds), kRateMachine);
  return text + e.placement;
}

Json to_json(const BuildEstimate& e) {
  Json paths = Json::array();
  for (const std::filesystem::path& path : e.input)
    paths.push_back(path.string());
  Json json{{"input", paths.size() == 1 ? paths[0] : paths},
            {"output", e.output.string()},
            {"input_bytes", e.mesh.file_bytes},
            {"vertices", e.mesh.vertex_count},
            {"places", e.mesh.places()},
            {"faces", e.mesh.face_count},
            {"partitions", e.plan.tree.partition_count()},
            {"levels", e.tiles.levels},
            {"tiles", e.tiles.tiles()},
            {"predicted_output_bytes", e.plan.disk.output_bytes},
            {"predicted_temporary_bytes", e.plan.disk.temporary_bytes},
            {"predicted_room_bytes", e.plan.disk.room_bytes},
            {"free_bytes", e.free_bytes},
            {"memory", memory_json(e)},
            {"threads", e.plan.threads},
            {"estimated_cpu_seconds", std::round(e.time.cpu_seconds * 1000) / 1000},
            {"estimated_wall_seconds", std::round(e.time.wall_seconds * 1000) / 1000},
            {"rates_of", kRateMachine}};
  if (!e.placement.empty())
    json["placement"] = e.placement;
  return json;
}

}  // namespace meshhier::pipeline
