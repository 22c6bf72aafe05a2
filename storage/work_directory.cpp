#include "storage/work_directory.h"

#include "hierarchy/error.h"
#include "storage/layout.h"

#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {

OutputKind hierarchy_output() {
  return {"a hierarchy", manifest_path({})};
}

OutputKind progressive_output() {
  return {"a progressive stream", progressive_index_path({})};
}

bool check_output(FileSystem& files, const std::filesystem::path& output, bool replace,
                  const char* state, const OutputKind& kind) {
  if (!files.exists(output))
    return false;
  if (!replace) {
    throw Error(ErrorCode::exists,
                fmt::format("{} {}; --force replaces it", output.string(), state));
  }
  if (!files.exists(output / kind.marker)) {
    throw Error(ErrorCode::exists,
                fmt::format("{} is not {} (it has no {}), so --force does not replace it",
                            output.string(), kind.noun, kind.marker.string()));
  }
  return true;
}

namespace {

/// A process that was killed holds its lock until the disk has done what it was asked for.
std::unique_ptr<FileLock> lock_patiently(FileSystem& files, const std::filesystem::path& path) {
  constexpr int kTries = 60;
  constexpr std::chrono::milliseconds kPause(50);
  std::unique_ptr<FileLock> lock = files.try_lock(path);
  for (int i = 1; i < kTries && !lock; ++i) {
    std::this_thread::sleep_for(kPause);
    lock = files.try_lock(path);
  }
  return lock;
}

}  // namespace

WorkDirectory::WorkDirectory(FileSystem& files, std::filesystem::path output, bool replace,
                             OutputKind kind)
    : files_(files),
      output_(std::move(output)),
      path_(work_path(output_)),
      replace_(replace),
      kind_(std::move(kind)) {
  check_output(files_, output_, replace_, "is already there", kind_);
  for (auto parent = output_.parent_path(); !parent.empty() && !files_.exists(parent);
       parent = parent.parent_path()) {
    made_parent_ = parent;
  }
  files_.make_directories(path_);
  lock_ = lock_patiently(files_, lock_path(path_));
  if (!lock_) {
    throw Error(ErrorCode::exists, fmt::format("another build of {} is at work", output_.string()));
  }
}

WorkDirectory::~WorkDirectory() {
  if (published_ || kept_)
    return;
  try {
    files_.remove_all(path_);  // while it is locked: who comes now finds no lock, and makes another
    if (!made_parent_.empty() && files_.list(made_parent_).empty())
      files_.remove_all(made_parent_);
  } catch (const Error&) {  // the failure that brought us here is the one to report
  }
}

std::filesystem::path WorkDirectory::built() const {
  return built_path(path_);
}

void WorkDirectory::clear() {
  for (const std::filesystem::path& file : files_.list(path_)) {
    if (file != lock_path(path_) && file != imported_path(path_))
      files_.remove_all(file);
  }
  files_.remove_all(built());
}

void WorkDirectory::publish() {
  files_.sync_tree(path_);
  const std::filesystem::path old = replaced_path(output_);
  const bool replacing =
      check_output(files_, output_, replace_, "appeared during the build", kind_);
  if (replacing) {
    files_.remove_all(old);
    files_.rename(output_, old);
  }
  bool renamed = false;
  try {
    files_.rename(built(), output_);
    renamed = true;
    files_.sync_tree(output_);
  } catch (const Error&) {
    if (renamed)
      files_.rename(output_, built());
    if (replacing)
      files_.rename(old, output_);
    throw;
  }
  published_ = true;
  kept_ = false;
  files_.remove_all(old);
  files_.remove_all(path_);
}

}  // namespace meshhier::storage
