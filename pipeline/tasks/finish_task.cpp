#include "pipeline/tasks/finish_task.h"

#include "hierarchy/error.h"
#include "pipeline/build_report.h"
#include "pipeline/outline_stage.h"
#include "pipeline/pack_stage.h"
#include "pipeline/publish_stage.h"
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

/// Where the hierarchy, or its archive, lies in `work` until it gets its name.
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

/// What tells a finished hierarchy, or its archive, from any other.
struct Finished {
  std::uint64_t checksum = 0;  ///< of the manifest
  std::uint64_t inode = 0;     ///< of the manifest's file, or the archive's; 0: not known
  friend bool operator==(const Finished&, const Finished&) = default;
};

/// Of what lies at `path`; none if that is no hierarchy of the container.
std::optional<Finished> look_at(storage::FileSystem& files, const fs::path& path,
                                storage::Container container) {
  if (!files.exists(path) || files.is_directory(path) != (container == storage::Container::files))
    return std::nullopt;
  try {
    return in_hierarchy(files, path, container, [&](storage::FileSystem& in, const fs::path& at) {
      const auto manifest = in.open(storage::manifest_path(at));
      return Finished{storage::checksum(storage::read_file(*manifest, manifest->size())),
                      manifest->version().inode};
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::io && error.code() != ErrorCode::corrupt)
      throw;
    return std::nullopt;
  }
}

Finished read_finished(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  const storage::SegmentName name{plan.fingerprint, "finish", 0};
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

/// What tasks sealed or left, but for what says that all is done.
void remove_what_is_not_needed(const TaskPlan& plan, const fs::path& work,
                               storage::FileSystem& files) {
  const fs::path last = storage::segment_path(work, {plan.fingerprint, "finish", 0});
  for (const fs::path& segment : files.children(storage::segments_path(work))) {
    if (segment != last)
      files.remove_all(segment);
  }
  files.remove_all(storage::attempts_path(work));
  files.remove_all(storage::built_path(work));
  files.remove_all(storage::packed_path(work));
}

std::uint64_t bytes_of(storage::FileSystem& files, const storage::HierarchyReader& made) {
  return made.manifest().total_bytes + files.open(storage::manifest_path(made.directory()))->size();
}

}  // namespace

void finish_hierarchy(Workshop& workshop, const fs::path& work, storage::SegmentWriter& entries,
                      const StageContext& context) {
  storage::FileSystem& files = context.files;
  if (workshop.journal.published().size() != context.tree().tile_count())
    throw Error(ErrorCode::corrupt, "files of tiles are missing: plan the build again");
  const fs::path built = storage::built_path(work);
  const OutlineStageResult outline =
      make_outline(workshop.forest, workshop.journal.source()->summary.diagonal(), context);
  write_account(workshop.forest, workshop.textures, workshop.journal, outline, built, context);
  if (context.config.storage.container == storage::Container::archive) {
    const storage::HierarchyReader made(files, built);
    pack(made, storage::packed_path(work), workshop.tile_scratch.pool().scratch_use(), context);
  } else {
    files.sync_tree(built);
  }
  const storage::Container container = context.config.storage.container;
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
    shared.publish();
  } else if (!is_there && (!named || named->checksum != finished.checksum ||
                           (is_known && files.exists(made_at)))) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{} is not the hierarchy that was finished in {}, and nor is what "
                            "lies there: plan the build again",
                            output.path.string(), work.string()));
  }
  remove_what_is_not_needed(plan, work, files);
  return in_hierarchy(files, output.path, output.container,
                      [&](storage::FileSystem& in, const fs::path& path) {
                        const storage::HierarchyReader made(in, path);
                        const std::uint64_t bytes = output.container == storage::Container::archive
                                                        ? files.open(path)->size()
                                                        : bytes_of(in, made);
                        return made_text(made, path, bytes) + notes_text(made, plan.config);
                      });
}

bool is_named(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  return !files.exists(storage::built_path(work)) && !files.exists(storage::packed_path(work)) &&
         storage::Segment::is_whole(files, work, {plan.fingerprint, "finish", 0});
}

}  // namespace meshhier::pipeline
