#include "pipeline/tasks/finish_task.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "pipeline/build_report.h"
#include "pipeline/pack_stage.h"
#include "pipeline/plan/share.h"
#include "pipeline/stages.h"
#include "pipeline/tasks/task_record.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/hash.h"

#include <functional>
#include <optional>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;

storage::Output output_of(const config::Config& config) {
  return {config.output, config.storage.container};
}

/// Returns the path in `work` of the hierarchy, or its archive, until it gets its name.
fs::path made_path(const fs::path& work, storage::Container container) {
  return container == storage::Container::files ? storage::built_path(work)
                                                : storage::packed_path(work);
}

/// Calls visit(files, path) with a file system in which `path` is a hierarchy's directory.
template <class Visit>
auto in_hierarchy(storage::FileSystem& files, const fs::path& path, storage::Container container,
                  const Visit& visit) {
  if (container == storage::Container::files)
    return visit(files, path);
  storage::ArchiveFiles archive(files, path);
  return visit(archive, path);
}

/// Identifies a finished hierarchy, or its archive.
struct Finished {
  std::uint64_t checksum = 0;  ///< the manifest's
  std::uint64_t inode = 0;     ///< the manifest's file's, or the archive's; 0: not known
  friend bool operator==(const Finished&, const Finished&) = default;
};

/// Identifies the hierarchy at `path`; returns nothing if there is none of the container. Throws
/// Error(io) if it cannot be read: then nobody knows what it is.
std::optional<Finished> look_at(storage::FileSystem& files, const fs::path& path,
                                storage::Container container) {
  if (!files.exists(path) || files.is_directory(path) != (container == storage::Container::files))
    return std::nullopt;
  try {
    using Found = std::optional<Finished>;
    return in_hierarchy(files, path, container, [](auto& in, const fs::path& at) -> Found {
      if (!in.exists(storage::manifest_path(at)))
        return std::nullopt;
      const auto manifest = in.open(storage::manifest_path(at));
      return Finished{storage::checksum(storage::read_file(*manifest, manifest->size())),
                      manifest->version().inode};
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt)
      throw;
    return std::nullopt;
  }
}

Finished read_finished(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  const storage::SegmentName name{plan.fingerprint, std::string(kFinishTask), 0};
  std::optional<Finished> finished;
  open_segment(files, work, name)->for_each([&](const storage::EntrySink::Entry& entry) {
    if (!entry.contains("finished"))
      return true;
    const auto& numbers = entry.at("finished");
    if (!numbers.is_array() || numbers.size() != 2 || !numbers[0].is_number_unsigned() ||
        !numbers[1].is_number_unsigned())
      return false;
    finished = Finished{numbers[0], numbers[1]};
    return true;
  });
  if (!finished)
    throw damaged_segment(work, name);
  return *finished;
}

/// Removes what tasks sealed or left, but for the segment that says that all is done.
void remove_what_is_not_needed(const TaskPlan& plan, const fs::path& work,
                               storage::FileSystem& files) {
  const fs::path last =
      storage::segment_path(work, {plan.fingerprint, std::string(kFinishTask), 0});
  for (const fs::path& segment : files.children(storage::segments_path(work))) {
    if (segment != last)
      files.remove_all(segment);
  }
  files.remove_all(storage::attempts_path(work));
  files.remove_all(storage::built_path(work));
  files.remove_all(storage::packed_path(work));
  files.remove_all(storage::imported_objects_path(work));
}

/// Returns the task of `publish` that makes the tile at that place among all.
std::uint32_t publisher_of(std::size_t place, std::size_t count, std::uint32_t tasks) {
  std::uint32_t task = 0;
  while (place >= Share{task, tasks}.end(count))
    ++task;
  return task;
}

/// Checks that all tiles' files are what was published: any program can reach them, so all are
/// read.
void check_tiles(const BuildJournal& journal, const fs::path& work, std::uint32_t tasks,
                 const StageContext& context) {
  const std::vector<Published> tiles = journal.published();
  if (tiles.size() != context.tree().tile_count())
    throw Error(ErrorCode::corrupt, "files of tiles are missing: plan the build again");
  context.progress.stage("check", tiles.size(), "tiles");
  execution::ordered_for(
      tiles.size(), 2 * context.plan.threads, context.cancel,
      [&](std::size_t i) { return journal.is_as_published(tiles[i].record); },
      [&](std::size_t i, bool is_whole) {
        context.progress.advance(1);
        if (is_whole)
          return;
        const std::uint32_t task = publisher_of(i, tiles.size(), tasks);
        throw Error(
            ErrorCode::corrupt,
            fmt::format(
                "{} is missing or damaged: remove {}, and run `meshhier task {} publish "
                "--index {}` again",
                storage::tile_path(storage::built_path(work), tiles[i].record.node).string(),
                storage::segment_path(work, {.plan = 0, .stage = "publish", .index = task})
                    .string(),
                work.string(), task));
      });
}

/// Throws if there are files of others: they would become part of the output.
void check_no_others(const fs::path& built, storage::FileSystem& files) {
  for (const fs::path& file : files.list(built)) {
    const std::string name = file.lexically_relative(built).generic_string();
    if (!storage::is_hierarchy_file(name)) {
      throw Error(ErrorCode::io, fmt::format("{} is no file of a hierarchy: remove it, and finish "
                                             "again",
                                             file.string()));
    }
  }
}

}  // namespace

void finish_hierarchy(const TaskKind& kind, Workshop& workshop, const fs::path& work,
                      std::uint32_t tasks, storage::SegmentWriter& entries,
                      const StageContext& context) {
  storage::FileSystem& files = context.files;
  const storage::Container container = context.config.storage.container;
  const fs::path built = storage::built_path(work);
  check_tiles(workshop.journal, work, tasks, context);
  check_no_others(built, files);
  Making making{workshop, {built}};
  make_stages(kind, making, {}, context);
  if (container == storage::Container::archive) {
    const storage::HierarchyReader made(files, built);
    pack(made, storage::packed_path(work), workshop.tile_scratch.pool().scratch_use(), context);
  } else {
    files.sync_tree(built);
  }
  const std::optional<Finished> made = look_at(files, made_path(work, container), container);
  if (!made)
    throw Error(ErrorCode::io, built.string() + " was changed while it was finished");
  entries.append({{"finished", {made->checksum, made->inode}}});
}

std::string name_hierarchy(const TaskPlan& plan, storage::WorkDirectory& shared,
                           storage::FileSystem& files) {
  const fs::path& work = shared.path();
  const storage::Output output = output_of(plan.config);
  const fs::path made_at = made_path(work, output.container);
  const Finished finished = read_finished(plan, work, files);
  const auto named = look_at(files, output.path, output.container);
  const bool is_known = finished.inode != 0;
  const bool is_there = is_known && named == finished;
  if (!is_there && look_at(files, made_at, output.container) == finished) {
    if (!plan.replace && files.exists(output.path)) {
      throw Error(ErrorCode::exists,
                  fmt::format("{} appeared during the build: move it away, and finish again",
                              output.path.string()));
    }
    files.make_directories(output.path.parent_path());
    shared.publish();
  } else if (!is_there && (!named || named->checksum != finished.checksum ||
                           (is_known && files.exists(made_at)))) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{} is not the hierarchy that was finished in {}, and nor is what "
                            "lies there: plan the build again",
                            output.path.string(), work.string()));
  }
  remove_what_is_not_needed(plan, work, files);
  return in_hierarchy(
      files, output.path, output.container, [&](storage::FileSystem& in, const fs::path& path) {
        const storage::HierarchyReader made(in, path);
        const std::uint64_t bytes = output.container == storage::Container::archive
                                        ? files.open(path)->size()
                                        : bytes_of(made, in);
        return made_text(made, path, bytes) +
               notes_text(made, plan.config, has_area(made, execution::CancelToken()));
      });
}

bool is_named(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  return !files.exists(storage::built_path(work)) && !files.exists(storage::packed_path(work)) &&
         storage::Segment::is_whole(files, work, {plan.fingerprint, std::string(kFinishTask), 0});
}

}  // namespace meshhier::pipeline
