#include "progressive/stream.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/allocator.h"
#include "execution/size_text.h"
#include "hierarchy/cut.h"
#include "hierarchy/detail.h"
#include "mesh_io/output_name.h"
#include "progressive/detail_writer.h"
#include "progressive/foreign_corners.h"
#include "progressive/level_lists.h"
#include "progressive/stream_index.h"
#include "progressive/stream_plan.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/task_arena.h>

namespace meshhier::progressive {
namespace {

namespace fs = std::filesystem;
using progressive::Sector;

void require_no_textures(const storage::HierarchyReader& reader) {
  if (!reader.manifest().textures)
    return;
  throw Error(ErrorCode::usage,
              reader.directory().string() +
                  " has textures, which a progressive stream cannot show: make it of a hierarchy "
                  "that was built without them");
}

void require_half_edge(const storage::HierarchyReader& reader) {
  const auto& config = reader.manifest().config;
  const auto simplify = config.find("simplify");
  const bool known = simplify != config.end() && simplify->is_object() &&
                     simplify->contains("method") && (*simplify)["method"].is_string();
  const std::string method = known ? (*simplify)["method"].get<std::string>() : "another method";
  if (method == "half_edge")
    return;
  throw Error(
      ErrorCode::usage,
      fmt::format("{} was simplified by {}: a progressive stream needs vertices that stay "
                  "where they are, so build it with \"simplify\": {{\"method\": \"half_edge\"}}",
                  reader.directory().string(), method));
}

void require_one_vertex_a_place(const storage::HierarchyReader& reader) {
  const auto& records = reader.records();
  if (std::none_of(records.begin(), records.end(),
                   [](const TileRecord& record) { return record.copy_count > 0; }))
    return;
  throw Error(ErrorCode::usage,
              fmt::format("{} has several vertices at one place: a progressive stream needs one "
                          "vertex at each, so build it with \"topology\": \"index\", or with "
                          "\"weld\": true if those vertices are equal",
                          reader.directory().string()));
}

/// Returns the levels that the stream shows, one a file, from the sector's own to the last.
std::vector<Level> shown_levels(const Tree& tree, NodeId node,
                                const std::optional<std::uint32_t>& steps) {
  const int top = raw(node.level);
  const int below = raw(tree.depth()) - top;
  if (steps && (*steps < 1 || std::int64_t{*steps} > below)) {
    throw Error(ErrorCode::usage,
                below == 0
                    ? fmt::format("--steps {}: there is no level below {}", *steps, to_text(node))
                    : fmt::format("--steps {}: expected 1 to {}, the levels below {}", *steps,
                                  below, to_text(node)));
  }
  const int details = steps ? static_cast<int>(*steps) : below;
  std::vector<Level> levels;
  for (int i = 0; i <= details; ++i)
    levels.push_back(static_cast<Level>(top + (details == 0 ? 0 : i * below / details)));
  return levels;
}

/// Returns the bytes for scratch files and output, at most.
std::uint64_t disk_need(const storage::HierarchyReader& reader, const Sector& sector) {
  const Tree& tree = reader.tree();
  const auto width = static_cast<std::uint64_t>(vertex_values(reader.tile_format().attributes));
  std::uint64_t bytes = 0;
  for (const TileRecord& record : reader.records()) {
    const bool inside = record.node.level >= sector.node.level &&
                        tree.ancestor(record.node, sector.node.level) == sector.node;
    if (!inside)
      continue;
    const std::uint64_t triangles = std::uint64_t{record.interior_count} + record.border_count;
    // At most three corners a triangle have stand-ins; partitions hold all that is lost at all, and
    // that is in the files.
    bytes += std::min(3 * triangles, tree.ranks(record.node).size() + record.ghost_count) *
             (sizeof(StandIn) + 4 * width);
    if (tree.is_partition(record.node))
      bytes += 2 * (triangles * sizeof(LostTriangle) + record.own_count * (4 + 4 * width));
  }
  return bytes;
}

void require_disk(storage::FileSystem& files, const fs::path& directory, std::uint64_t needed) {
  const std::uint64_t free = files.free_bytes(directory);
  if (free < needed) {
    throw Error(ErrorCode::budget,
                fmt::format("{} has {} free, the stream and its temporary files may take {}",
                            directory.string(), execution::rounded_size_text(free),
                            execution::rounded_size_text(needed)));
  }
}

/// Makes the stream's files in `directory`.
class StreamWriter {
 public:
  StreamWriter(storage::FileSystem& files, const storage::HierarchyReader& reader,
               const Sector& sector, std::vector<Level> levels, const ProgressivePlan& plan)
      : files_(files), reader_(reader), sector_(sector), levels_(std::move(levels)), plan_(plan) {}

  progressive::ProgressiveIndex write(const fs::path& scratch_file, const fs::path& directory,
                                      execution::Progress& progress,
                                      const execution::CancelToken& cancel) {
    storage::MemoryPool pool(plan_.pool_bytes);
    storage::ScratchFile scratch(files_, scratch_file, pool);
    std::vector<LevelLists> lists;
    for (int level = 0; level <= raw(reader_.tree().depth()); ++level)
      lists.emplace_back(scratch);
    // Tracing a tile took twice as long as writing what it loses.
    progress.expect({{"trace", "tiles", 0, 2}, {"write", "entries", 0, 1}});
    trace(lists, progress, cancel);
    return write_files(lists, directory, progress, cancel);
  }

 private:
  void trace(std::vector<LevelLists>& lists, execution::Progress& progress,
             const execution::CancelToken& cancel) const {
    TraceOptions options;
    options.listed.resize(lists.size());
    for (const Level level : levels_)
      options.listed[raw(level)] = true;
    options.subtrees = plan_.subtrees;
    options.in_flight = plan_.subtrees_in_flight;
    const std::uint64_t tiles = 2 * std::uint64_t{sector_.partitions.size()} - 1;
    progress.stage("trace", tiles, "tiles");
    trace_sector(reader_, sector_, options, lists, progress, cancel);
  }

  ForeignCorners foreign_of(const std::vector<LevelLists>& lists, Level level) const {
    const auto width = static_cast<std::size_t>(vertex_values(reader_.tile_format().attributes));
    const std::uint64_t needed = ForeignCorners::memory_bytes(lists[raw(level)], width);
    if (needed > plan_.foreign_bytes)
      refuse_border(needed);
    return {lists[raw(level)], width};
  }

  [[noreturn]] void refuse_border(std::uint64_t needed) const {
    const std::uint64_t more = (needed - plan_.foreign_bytes) * ProgressivePlan::kForeignParts;
    constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
    throw Error(ErrorCode::budget,
                fmt::format("a memory budget of {} is too small for the border of this sector: "
                            "--memory-budget {} would do",
                            execution::exact_size_text(plan_.budget_bytes),
                            execution::exact_size_text(
                                (plan_.budget_bytes + more) / kMebibyte * kMebibyte + kMebibyte)));
  }

  progressive::ProgressiveIndex write_files(const std::vector<LevelLists>& lists,
                                            const fs::path& directory,
                                            execution::Progress& progress,
                                            const execution::CancelToken& cancel) const {
    const ForeignCorners all = foreign_of(lists, reader_.tree().depth());
    progressive::ProgressiveIndex index = begin_index(lists, all);
    progress.stage("write", entries_of(lists), "entries");
    ForeignCorners coarse;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      ForeignCorners fine = foreign_of(lists, levels_[i]);
      DetailSpan span{static_cast<std::uint32_t>(i), std::nullopt, levels_[i]};
      if (i > 0)
        span.coarse = levels_[i - 1];
      const DetailSource source{lists,
                                sector_,
                                reader_.tile_format().attributes,
                                all,
                                coarse,
                                fine,
                                plan_.runs_in_flight};
      progressive::ProgressiveFile file = write_detail(
          files_, storage::detail_path(directory, span.step), span, source, progress, cancel);
      file.shown_vertices = own_vertices(levels_[i]) + fine.size();
      file.shown_triangles =
          file.triangles + (index.files.empty() ? 0 : index.files.back().shown_triangles);
      index.files.push_back(file);
      coarse = std::move(fine);
    }
    return index;
  }

  /// Returns the number of entries, a little too many: stand-ins that do not change are none.
  std::uint64_t entries_of(const std::vector<LevelLists>& lists) const {
    std::uint64_t entries = 0;
    for (const LevelLists& level : lists)
      entries += level.lost_ranks.size() + level.lost_triangles.size() + level.stand_ins.size();
    return entries;
  }

  progressive::ProgressiveIndex begin_index(const std::vector<LevelLists>& lists,
                                            const ForeignCorners& foreign) const {
    const storage::Manifest& manifest = reader_.manifest();
    progressive::ProgressiveIndex index;
    index.generator = manifest.generator;
    index.source = manifest.source;
    index.node = sector_.node;
    index.own_vertices = sector_.ranks.size();
    index.vertices = index.own_vertices + foreign.size();
    for (const LevelLists& level : lists)
      index.triangles += level.lost_triangles.size();
    index.origin = manifest.origin;
    index.up = manifest.up;
    index.licence = manifest.licence;
    return index;
  }

  /// Returns the number of own vertices of the tiles that stand for the sector's nodes of a level.
  std::uint64_t own_vertices(Level level) const {
    std::uint64_t vertices = 0;
    const Tree& tree = reader_.tree();
    for (std::uint32_t partition = sector_.partitions.begin; partition < sector_.partitions.end;) {
      const NodeId node = tree.ancestor({tree.depth(), partition}, level);
      vertices += reader_.record(node).own_count;
      partition = tree.partitions(node).end;
    }
    return vertices;
  }

  storage::FileSystem& files_;
  const storage::HierarchyReader& reader_;
  const Sector& sector_;
  std::vector<Level> levels_;
  ProgressivePlan plan_;
};

std::string summary_of(const fs::path& output, const progressive::ProgressiveIndex& index) {
  std::uint64_t bytes = 0;
  for (const progressive::ProgressiveFile& file : index.files)
    bytes += file.bytes;
  return fmt::format(
      "{}: {}, {}, in a base of {} and {}, {} in all, {:.2f} bytes a vertex", output.string(),
      counted(index.vertices, "vertices"), counted(index.triangles, "triangles"),
      execution::rounded_size_text(index.files.front().bytes),
      counted(index.files.size() - 1, "details"), execution::rounded_size_text(bytes),
      static_cast<double>(bytes) / static_cast<double>(index.vertices));
}

}  // namespace

std::string write_progressive(storage::FileSystem& files, const fs::path& hierarchy,
                              const ProgressiveOptions& options, execution::Progress& progress,
                              const execution::CancelToken& cancel) {
  mesh_io::require_true_ending(options.output.string(), {},
                               "progressive makes a directory of its own kind; name it NAME.prog");
  const storage::Output output{storage::followed(files, options.output), storage::Container::files,
                               storage::OutputContent::progressive_stream};
  storage::check_output(files, output, options.replace);
  storage::require_apart(files, options.output, std::array{hierarchy});
  storage::check_place(files, output.path);
  execution::configure_allocator(options.memory_budget);
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader reader(place.files(), hierarchy);
  require_no_textures(reader);
  require_half_edge(reader);
  require_one_vertex_a_place(reader);
  const NodeId asked = options.node.value_or(NodeId{});
  require_node(reader.tree(), asked);
  const Sector sector(reader.tree(), reader.tree().tile_node(asked));
  std::vector<Level> levels = shown_levels(reader.tree(), sector.node, options.steps);

  const ProgressivePlan plan =
      plan_progressive(reader, sector, options.memory_budget,
                       static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  storage::WorkDirectory work(files, output, options.replace);
  if (work.is_kept()) {
    throw Error(ErrorCode::other_work,
                fmt::format("{} holds what a stopped build has done; go on with it, or remove it "
                            "(meshhier clean --remove {})",
                            work.path().string(), output.path.string()));
  }
  require_disk(files, work.path(), disk_need(reader, sector));
  work.clear();  // a killed run may have left files
  files.make_directories(work.built());
  StreamWriter writer(files, reader, sector, std::move(levels), plan);
  const progressive::ProgressiveIndex index =
      writer.write(work.path() / "lists", work.built(), progress, cancel);
  const std::string text = progressive::to_json_text(index);
  storage::write_file(files, storage::progressive_index_path(work.built()),
                      std::as_bytes(std::span(text)));
  work.publish();
  return summary_of(options.output, index);
}

}  // namespace meshhier::progressive
