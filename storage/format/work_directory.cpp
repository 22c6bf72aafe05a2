#include "storage/format/work_directory.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/format/archive.h"
#include "storage/format/layout.h"
#include "storage/format/system_files.h"
#include "storage/io/hash.h"
#include "storage/io/patient_lock.h"
#include "storage/io/system_failure.h"

#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {

namespace {

namespace fs = std::filesystem;

/// Returns a file in the directory that no hierarchy, or stream, has, and no system leaves in
/// folders; empty if there is none.
std::string foreign_file(FileSystem& files, const Output& output) {
  const auto is_own =
      output.content == OutputContent::progressive_stream ? is_stream_file : is_hierarchy_file;
  for (const fs::path& file : files.list(output.path)) {
    const std::string name = file.lexically_relative(output.path).generic_string();
    if (!is_own(name) && !is_system_file(name) && !is_manifest_at_work(name))
      return name;
  }
  return "";
}

/// Returns why the output that lies there is not replaced; empty if it is.
std::string objection(FileSystem& files, const Output& output) {
  const bool is_directory = files.is_directory(output.path);
  if (output.container == Container::archive) {
    if (is_directory)
      return "is a directory, and one file is to be made (\"container\": \"3tz\")";
    return is_hierarchy_archive(files, output.path) ? "" : "is not the archive of a hierarchy";
  }
  const bool is_stream = output.content == OutputContent::progressive_stream;
  if (!is_directory && is_stream)
    return "is not a progressive stream but a file";
  if (!is_directory)
    return "is a file, and a directory is to be made (\"container\": \"files\")";
  const fs::path mark = is_stream ? progressive_index_path({}) : manifest_path({});
  const char* const what = is_stream ? "progressive stream" : "hierarchy";
  if (!files.exists(output.path / mark))
    return fmt::format("is not a {} (it has no {})", what, mark.string());
  const std::string foreign = foreign_file(files, output);
  return foreign.empty() ? "" : fmt::format("holds {}, which is no file of a {}", foreign, what);
}

}  // namespace

void require_outside(FileSystem& files, const fs::path& output) {
  fs::path place = files.canonical(output);
  for (fs::path parent = place.parent_path(); parent != place; parent = place.parent_path()) {
    if (files.exists(manifest_path(parent)) && files.exists(index_path(parent))) {
      throw Error(ErrorCode::usage, fmt::format("cannot make {} in the hierarchy {}; choose "
                                                "another place",
                                                output.string(), parent.string()));
    }
    place = parent;
  }
}

fs::path existing_directory(FileSystem& files, const fs::path& output) {
  fs::path directory = output.parent_path();
  while (!directory.empty() && !files.exists(directory))
    directory = directory.parent_path();
  return directory.empty() ? "." : directory;
}

void check_place(FileSystem& files, const fs::path& output) {
  constexpr std::size_t kLongestName = 255;  // on Linux's file systems
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::io, fmt::format("cannot make {}: {}", output.string(), why));
  };
  const std::size_t length = work_path(output).filename().string().size();
  if (length > kLongestName)
    refuse("its name is too long, by " + counted(length - kLongestName, "bytes"));
  const fs::path directory = existing_directory(files, output);
  if (!files.is_directory(directory))
    refuse(fmt::format("{} is not a directory", directory.string()));
  if (const std::string why = files.why_not_writable(directory); !why.empty()) {
    refuse(fmt::format("{} cannot be written ({}); choose another place for the output",
                       directory.string(), why));
  }
}

fs::path followed(FileSystem& files, const fs::path& output) {
  const fs::path parent = output.parent_path();
  const fs::path real = files.canonical(output);
  return real == files.canonical(parent.empty() ? "." : parent) / output.filename() ? output : real;
}

bool check_output(FileSystem& files, const Output& output, bool replace, const char* state) {
  require_outside(files, output.path);
  if (!files.exists(output.path))
    return false;
  if (!replace) {
    throw Error(ErrorCode::exists,
                fmt::format("{} {}; --force replaces it", output.path.string(), state));
  }
  if (const std::string why = objection(files, output); !why.empty()) {
    throw Error(ErrorCode::exists,
                fmt::format("{} {}, and is never replaced: move it away, or name another output",
                            output.path.string(), why));
  }
  return true;
}

namespace {

std::uint64_t manifest_checksum(FileSystem& files, const fs::path& hierarchy) {
  const std::unique_ptr<File> manifest = files.open(manifest_path(hierarchy));
  return checksum(read_file(*manifest, manifest->size()));
}

}  // namespace

std::unique_ptr<FileLock> take_work(FileSystem& files, const fs::path& work) {
  files.make_directories(work);
  try {
    return files.try_lock(lock_path(work));
  } catch (const NotThere&) {
    return nullptr;
  }
}

void remove_work(FileSystem& files, const fs::path& work, std::unique_ptr<FileLock> lock) {
  for (const fs::path& child : files.children(work)) {
    if (child != lock_path(work))
      files.remove_all(child);
  }
  lock.reset();  // its file goes with it; who comes now makes another
  files.remove_if_empty(work);
}

WorkDirectory::WorkDirectory(FileSystem& files, Output output, bool replace,
                             const std::function<void()>& check)
    : files_(files), output_(std::move(output)), path_(work_path(output_.path)), replace_(replace) {
  for (auto parent = output_.path.parent_path(); !parent.empty() && !files_.exists(parent);
       parent = parent.parent_path()) {
    made_parents_.push_back(parent);
  }
  if (files_.is_link(path_)) {
    throw Error(ErrorCode::io,
                fmt::format("{} is a link, and temporary files of the build go there; remove it",
                            path_.string()));
  }
  lock_ = lock_patiently([&] {
    check();
    check_output(files_, output_, replace_);
    return take_work(files_, path_);
  });
  if (!lock_) {
    throw Error(ErrorCode::locked,
                fmt::format("another build of {} is at work", output_.path.string()));
  }
  restore_journal();
  kept_ = files_.exists(journal_path(path_));
}

WorkDirectory::WorkDirectory(FileSystem& files, Output output, bool replace, fs::path shared)
    : files_(files),
      output_(std::move(output)),
      path_(std::move(shared)),
      lock_(files.try_lock(lock_path(path_))),
      replace_(replace),
      is_shared_(true) {
  if (!lock_) {
    throw Error(ErrorCode::locked, fmt::format("another process is finishing the build in {}: try "
                                               "again when it has ended",
                                               path_.string()));
  }
}

WorkDirectory::~WorkDirectory() {
  if (kept_ || (is_shared_ && !published_))
    return;
  try {
    remove_rest();
  } catch (const Error&) {  // `meshhier clean` finds what is left
  }
}

void WorkDirectory::remove_rest() {
  if (published_)
    files_.remove_all(replaced_path(output_.path));
  if (is_shared_) {
    files_.remove_all(built());
    files_.remove_all(packed());
    return;
  }
  remove_work(files_, path_, std::move(lock_));
  if (published_)
    return;
  for (const fs::path& parent : made_parents_)
    files_.remove_if_empty(parent);
}

std::filesystem::path WorkDirectory::built() const {
  return built_path(path_);
}

std::filesystem::path WorkDirectory::packed() const {
  return packed_path(path_);
}

void WorkDirectory::clear() {
  for (const std::filesystem::path& file : files_.list(path_)) {
    if (file != lock_path(path_) && file != imported_path(path_) &&
        file != imported_objects_path(path_))
      files_.remove_all(file);
  }
  files_.remove_all(built());
  kept_ = false;
}

/// Syncs what gets the name: an archive without the files that were packed into it.
void WorkDirectory::sync_result() {
  if (output_.container == Container::archive)
    files_.open(packed())->sync();
  else
    files_.sync_tree(path_);
}

void WorkDirectory::publish() {
  sync_result();
  const fs::path from = output_.container == Container::files ? built() : packed();
  if (!check_output(files_, output_, replace_, "appeared during the build"))
    give_name(from);
  else if (!exchange(from))
    replace(from);
  published_ = true;
  kept_ = false;
}

void WorkDirectory::give_name(const fs::path& from) {
  if (!files_.rename_new(from, output_.path)) {
    throw Error(ErrorCode::exists, fmt::format("{} appeared during the build; --force replaces it",
                                               output_.path.string()));
  }
  try {
    sync_names();
  } catch (const Error&) {
    files_.rename(output_.path, from);
    throw;
  }
}

bool WorkDirectory::exchange(const fs::path& from) {
  // Killed at any moment, the output is the old hierarchy or the new one, and the journal is found
  // again only if the directory still has the hierarchy that it is about.
  const fs::path journal = journal_path(path_);
  const fs::path aside = files_.exists(journal) ? set_aside() : fs::path();
  const auto take_back = [&] {
    if (!aside.empty())
      files_.rename(aside, journal);
  };
  bool exchanged = false;
  try {
    exchanged = files_.exchange(from, output_.path);
    if (exchanged)
      sync_names();
  } catch (const Error&) {
    if (exchanged)
      files_.exchange(from, output_.path);
    take_back();
    throw;
  }
  if (!exchanged)
    take_back();
  return exchanged;
}

// From the exchange on the hierarchy in this directory is the one that is replaced: no later build
// may take it for what the journal says is done.
fs::path WorkDirectory::set_aside() {
  const fs::path aside = set_aside_path(path_, manifest_checksum(files_, built()));
  files_.rename(journal_path(path_), aside);
  return aside;
}

void WorkDirectory::restore_journal() {
  if (files_.exists(journal_path(path_)) || !files_.exists(manifest_path(built())))
    return;
  const fs::path aside = set_aside_path(path_, manifest_checksum(files_, built()));
  if (files_.exists(aside))
    files_.rename(aside, journal_path(path_));
}

void WorkDirectory::replace(const fs::path& from) {
  const fs::path old = replaced_path(output_.path);
  files_.remove_all(old);
  files_.rename(output_.path, old);
  try {
    give_name(from);
  } catch (const Error&) {
    files_.rename_new(old, output_.path);
    throw;
  }
}

void WorkDirectory::sync_names() {
  if (output_.container == Container::archive)
    files_.remove_all(built());  // so that the disk need not take them, too
  files_.sync_tree(path_);       // which is on the output's file system
}

}  // namespace meshhier::storage
