#include "verify/verify.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "hierarchy/cut.h"
#include "storage/format/archive_check.h"
#include "storage/format/archive_files.h"
#include "storage/format/build_name.h"
#include "storage/format/layout.h"
#include "storage/format/load_manifest.h"
#include "verify/verify_parts.h"

#include <optional>
#include <random>
#include <utility>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;

/// Returns a path unlike that of another run of verify. Nothing else depends on chance.
fs::path scratch_path(storage::FileSystem& files, const fs::path& directory,
                      const VerifyOptions& options) {
  std::random_device chance;
  return storage::verify_scratch_path(options.scratch_folder
                                          ? *options.scratch_folder / directory.filename()
                                          : files.canonical(directory),
                                      chance());
}

/// Returns nothing if it is an archive with a broken list of files.
std::optional<storage::HierarchyFiles> open_place(storage::FileSystem& files,
                                                  const fs::path& directory,
                                                  ProblemList& problems) {
  try {
    return std::optional<storage::HierarchyFiles>(std::in_place, files, directory);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt)
      throw;
    problems.add(error.what());
    return std::nullopt;
  }
}

/// All that is not content, and contents against their CRC-32.
void verify_archive(const storage::Archive& archive, ProblemList& problems,
                    std::vector<std::string>& checks, const execution::CancelToken& cancel) {
  storage::check_archive(
      archive, [&] { cancel.check(); }, [&](const std::string& problem) { problems.add(problem); });
  checks.push_back(fmt::format("archive: {}, {} with the index",
                               counted(archive.file().size(), "bytes"),
                               counted(archive.entry_count(), "files")));
}

/// Returns nothing if manifest or index are broken: no more can be said of the rest then.
std::optional<storage::HierarchyReader> open_hierarchy(storage::FileSystem& files,
                                                       const fs::path& directory,
                                                       ProblemList& problems) {
  try {
    return std::optional<storage::HierarchyReader>(std::in_place, files, directory);
  } catch (const storage::Replaced&) {
    throw;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt && error.code() != ErrorCode::io)
      throw;
    problems.add(error.what());
    return std::nullopt;
  }
}

/// Returns seconds, as measured for a scan of 54 partitions.
std::vector<execution::ExpectedStage> expected_times(const VerifyJob& job) {
  const auto tiles = static_cast<double>(job.reader.records().size());
  const auto partitions = static_cast<double>(job.tree().partition_count());
  std::vector<execution::ExpectedStage> times{
      {"verify", "tiles", 0, tiles * 1.8e-3},
      {"seams", "cuts", 0, partitions * (job.options.cuts + 1) * 0.8e-3}};
  if (!job.options.input.empty())
    times.push_back({"input", "partitions", 0, partitions * 1.4e-3});
  return times;
}

void verify_all(const VerifyJob& job) {
  job.progress.expect(expected_times(job));
  verify_manifest(job);
  if (job.options.region.is_any())
    return verify_piece(job);
  verify_files(job);
  verify_tiles(job);
  if (job.tiles.unreadable_count() > 0) {
    job.problems.add(fmt::format("{}: seams{} not looked at: {} cannot be read",
                                 job.reader.directory().string(),
                                 job.options.input.empty() ? "" : " and input",
                                 counted(job.tiles.unreadable_count(), "tiles")));
    return;
  }
  try {
    verify_seams(job);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt)
      throw;
    job.problems.add(error.what());
  }
  if (!job.options.input.empty())
    verify_input(job);
}

}  // namespace

std::vector<std::string> ProblemList::take() {
  std::vector<std::string> all = std::move(problems_);
  if (count_ > all.size())
    all.push_back("and " + counted(count_ - all.size(), "more problems"));
  return all;
}

TileStore::TileStore(const storage::HierarchyReader& reader, std::uint64_t cache_bytes,
                     ProblemList& problems)
    : tree_(reader.tree()),
      problems_(problems),
      cache_(
          cache_bytes, [&reader](NodeId node) { return reader.read_tile(node); },
          [](const PublishedTile& tile) { return exporting::memory_bytes(tile); }) {}

std::shared_ptr<const PublishedTile> TileStore::find(NodeId node) {
  node = tree_.tile_node(node);
  if (unreadable_.contains(node))
    return nullptr;
  try {
    return cache_.get(node);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt && error.code() != ErrorCode::io)
      throw;
    unreadable_.insert(node);
    problems_.add(error.what());
    return nullptr;
  }
}

VerifyReport verify_hierarchy(storage::FileSystem& files, const fs::path& directory,
                              const VerifyOptions& options, execution::Progress& progress,
                              const execution::CancelToken& cancel) {
  VerifyReport report;
  ProblemList problems;
  if (const auto place = open_place(files, directory, problems)) {
    if (place->archive() != nullptr && !options.region.is_any())
      verify_archive(*place->archive(), problems, report.checks, cancel);
    if (problems.count() == 0)
      storage::require_manifest(place->files(), directory);
    if (const auto reader = open_hierarchy(place->files(), directory, problems)) {
      storage::MemoryPool pool(options.memory_budget / 8);
      storage::ScratchFile scratch(files, scratch_path(files, directory, options), pool);
      TileStore tiles(*reader, options.memory_budget / 4, problems);
      storage::of_one_build(place->files(), directory, reader->manifest(), [&] {
        verify_all({place->files(), *reader, options, scratch, tiles, problems, report.checks,
                    progress, cancel});
      });
      if (problems.count() > 0)
        storage::require_same_build(place->files(), directory, reader->manifest());
    }
  }
  report.problems = problems.take();
  return report;
}

}  // namespace meshhier::verifying
