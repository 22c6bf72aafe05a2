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

std::uint64_t manifest_checksum(storage::FileSystem& files, const fs::path& hierarchy) {
  const auto manifest = files.open(storage::manifest_path(hierarchy));
  return storage::checksum(storage::read_file(*manifest, manifest->size()));
}

/// Whether it is the hierarchy, or its archive, whose manifest has that checksum.
bool is_it(storage::FileSystem& files, const fs::path& path, storage::Container container,
           std::uint64_t checksum) {
  if (!files.exists(path) || files.is_directory(path) != (container == storage::Container::files))
    return false;
  try {
    return in_hierarchy(files, path, container, manifest_checksum) == checksum;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::io && error.code() != ErrorCode::corrupt)
      throw;
    return false;
  }
}

std::uint64_t finished_checksum(const TaskPlan& plan, const fs::path& work,
                                storage::FileSystem& files) {
  const storage::SegmentName name{plan.fingerprint, "finish", 0};
  const auto segment = storage::Segment::open(files, work, name);
  if (!segment)
    throw missing_task(work, "finish", 0);
  std::optional<std::uint64_t> checksum;
  segment->for_each([&](const storage::EntrySink::Entry& entry) {
    if (entry.contains("finished") && entry.at("finished").is_number_unsigned())
      checksum = entry.at("finished").get<std::uint64_t>();
    return true;
  });
  if (!checksum)
    throw damaged_segment(work, name);
  return *checksum;
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
}

std::uint64_t bytes_of(storage::FileSystem& files, const storage::HierarchyReader& made) {
  return made.manifest().total_bytes + files.open(storage::manifest_path(made.directory()))->size();
}

}  // namespace

void finish_hierarchy(Workshop& workshop, const fs::path& work, storage::SegmentWriter& entries,
                      const StageContext& context) {
  storage::FileSystem& files = context.files;
  const storage::WorkDirectory shared(files, output_of(context.config), true, work);
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
  entries.append({{"finished", manifest_checksum(files, built)}});
}

std::string name_hierarchy(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  const storage::Output output = output_of(plan.config);
  const std::uint64_t checksum = finished_checksum(plan, work, files);
  storage::WorkDirectory shared(files, output, plan.replace, work);
  if (!is_it(files, output.path, output.container, checksum)) {
    if (!is_it(files, made_path(work, output.container), output.container, checksum)) {
      throw Error(ErrorCode::io,
                  fmt::format("{} is not the hierarchy that was finished in {}, and nor is what "
                              "lies there: plan the build again",
                              output.path.string(), work.string()));
    }
    shared.publish();
  }
  remove_what_is_not_needed(plan, work, files);
  return in_hierarchy(
      files, output.path, output.container, [&](storage::FileSystem& in, const fs::path& path) {
        const storage::HierarchyReader made(in, path);
        const std::uint64_t bytes = output.container == storage::Container::archive
                                        ? files.open(path)->size()
                                        : bytes_of(in, made);
        return made_text(made, path, bytes) +
               notes_text(made, plan.config, has_area(made, execution::CancelToken()));
      });
}

}  // namespace meshhier::pipeline
