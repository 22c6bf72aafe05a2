#include "storage/io/output_file.h"

#include "base/error.h"
#include "storage/io/paths.h"
#include "storage/io/patient_lock.h"
#include "storage/io/process.h"

#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

/// Unlike a work directory, the parent is not made: a mistyped path should be told.
void require_parent(FileSystem& files, const OutputRequest& request, const fs::path& target) {
  const fs::path directory = target.parent_path();
  if (directory.empty())
    return;
  if (!files.is_directory(directory)) {
    throw Error(ErrorCode::io, fmt::format("cannot write {}: there is no directory {}",
                                           request.path.string(), directory.string()));
  }
  if (const std::string why = files.why_not_writable(directory); !why.empty()) {
    throw Error(ErrorCode::io,
                fmt::format("cannot write {}: {} cannot be written ({}); choose another place for "
                            "the output",
                            request.path.string(), directory.string(), why));
  }
}

/// The files beside the target have longer names than it, and they must be possible, too.
void require_short_name(const OutputRequest& request, const fs::path& target) {
  constexpr std::size_t kLongestName = 255;  // on Linux's file systems
  const std::size_t length = scratch_path(target).filename().native().size();
  if (length > kLongestName) {
    throw Error(ErrorCode::io, fmt::format("cannot write {}: its name is too long, by {} bytes",
                                           request.path.string(), length - kLongestName));
  }
}

[[noreturn]] void refuse_kind(const OutputRequest& request, const char* what) {
  throw Error(ErrorCode::usage, fmt::format("cannot write {}: it is {}, and the output is one file",
                                            request.path.string(), what));
}

/// The system's path for what is open as this process's standard output.
constexpr const char* kSystemsStandardOutput = "/dev/stdout";

Error already_there(const fs::path& path, const char* state) {
  return {ErrorCode::exists, fmt::format("{} {}; --force replaces it", path.string(), state)};
}

/// Returns where a name is, whatever it leads to.
fs::path name_itself(FileSystem& files, const fs::path& name) {
  const fs::path folder = name.parent_path();
  return files.canonical(folder.empty() ? "." : folder) / name.filename();
}

/// Returns where a path leads to and, if its name is a link, where that link is.
std::vector<fs::path> places_of(FileSystem& files, const fs::path& path) {
  const fs::path name = without_last_slash(path);
  std::vector<fs::path> places{files.canonical(name)};
  if (files.is_link(name))
    places.push_back(name_itself(files, name));
  return places;
}

/// Paths may differ and be one place: files have several names by hard links, directories by
/// mounts.
bool is_one_place(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return a == b || fs::equivalent(a, b, ignored);
}

bool lies_in(FileSystem& files, const fs::path& path, const fs::path& folder) {
  const FileKind kind = files.kind(folder);
  if (kind != FileKind::directory && kind != FileKind::none)
    return false;  // nothing lies in a file
  if (is_within(path, folder))
    return true;
  if (kind == FileKind::none)
    return false;
  for (fs::path at = path.parent_path(); at != at.parent_path(); at = at.parent_path()) {
    if (is_one_place(at, folder))
      return true;
  }
  return false;
}

}  // namespace

bool is_standard_output(FileSystem& files, const fs::path& path) {
  return path == kStandardOutput || files.kind(path) == FileKind::standard_output;
}

void require_apart(FileSystem& files, const fs::path& output, std::span<const fs::path> inputs) {
  const std::vector<fs::path> places = places_of(files, output);
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::usage,
                fmt::format("cannot write {}: {}; name another output", output.string(), why));
  };
  for (const fs::path& input : inputs) {
    if (input.empty())
      continue;
    for (const fs::path& place : places_of(files, input)) {
      if (is_one_place(places.front(), place))
        refuse("it would replace " + input.string());
      if (lies_in(files, places.front(), place))
        refuse("it lies in " + input.string());
      if (lies_in(files, place, places.front()))
        refuse(fmt::format("the input {} lies in it", input.string()));
    }
  }
}

fs::path unfinished_path(const fs::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-part", file.filename().string());
}

fs::path scratch_path(const fs::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-scratch", file.filename().string());
}

fs::path output_lock_path(const fs::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-lock", file.filename().string());
}

std::unique_ptr<FileLock> lock_output(FileSystem& files, const fs::path& output,
                                      const fs::path& named, const std::function<void()>& check) {
  auto lock = lock_patiently([&] {
    check();
    return files.try_lock(output_lock_path(output));
  });
  if (!lock)
    throw Error(ErrorCode::locked, fmt::format("another command is writing {}", named.string()));
  return lock;
}

OutputFile::OutputFile(FileSystem& files, const OutputRequest& request,
                       const std::function<void()>& check)
    : files_(files), check_(check), replace_(request.replace), is_own_name_(request.is_own_name) {
  const fs::path& path = request.path;
  if (!is_own_name_ && is_standard_output(files, path)) {
    open_stream(kSystemsStandardOutput);
    return;
  }
  const FileKind kind = is_own_name_ ? FileKind::none : files.kind(path);
  switch (kind) {
    case FileKind::stream:
    case FileKind::standard_output:
      open_stream(path);
      return;
    case FileKind::directory:
      refuse_kind(request, "a directory");
    case FileKind::other:
      refuse_kind(request, "neither a regular file nor a FIFO nor a character device");
    case FileKind::none:
      if (path.filename().empty() || path.filename() == "." || path.filename() == "..")
        refuse_kind(request, "no name of a file");
      break;
    case FileKind::regular:
      break;
  }
  require_apart(files, path, request.inputs);
  if (kind == FileKind::regular && !replace_)
    throw already_there(path, "is already there");
  open_regular(request);
}

void OutputFile::open_stream(const fs::path& path) {
  file_ = files_.open_stream(path, check_);
  own_directory_ = make_temporary_directory();
  scratch_ = own_directory_ / "scratch";
}

void OutputFile::open_regular(const OutputRequest& request) {
  const fs::path target =
      is_own_name_ ? name_itself(files_, request.path) : files_.canonical(request.path);
  require_parent(files_, request, target);
  require_short_name(request, target);
  for (const fs::path& own :
       {unfinished_path(target), scratch_path(target), output_lock_path(target)})
    require_apart(files_, own, request.inputs);
  lock_ = lock_output(files_, target, request.path, check_);
  target_ = target;
  if (files_.exists(target_))
    require_replaceable();
  temporary_ = unfinished_path(target);
  scratch_ = scratch_path(target);
  files_.remove_all(temporary_);  // a killed command may have left it
  file_ = files_.create(temporary_);
}

OutputFile::~OutputFile() {
  file_.reset();
  try {
    if (!temporary_.empty())
      files_.remove_all(temporary_);
    if (!own_directory_.empty())
      files_.remove_all(own_directory_);
  } catch (const Error&) {  // the failure that brought us here is the one to report
  }
}

void OutputFile::publish() {
  force();
  give_name();
  settle();
}

/// Forces the file to the disk, or closes a stream.
void OutputFile::force() {
  if (target_.empty())
    return file_.reset();
  file_->sync(check_);
}

void OutputFile::give_name() {
  if (target_.empty() || files_.rename_new(temporary_, target_))
    return;
  require_replaceable();
  files_.rename(temporary_, target_);
}

/// Gives the file its name so that take_name_back() can undo it, where the system can.
void OutputFile::give_name_for_now() {
  if (target_.empty() || files_.rename_new(temporary_, target_))
    return;
  require_replaceable();
  has_replaced_ = files_.exchange(temporary_, target_);
  if (!has_replaced_)
    files_.rename(temporary_, target_);
}

void OutputFile::take_name_back() {
  if (target_.empty())
    return;
  try {
    if (std::exchange(has_replaced_, false))
      files_.exchange(temporary_, target_);
    else
      files_.rename(target_, temporary_);
  } catch (const Error&) {  // the failure that brought us here is the one to report
  }
}

/// Forces the name to the disk and lets go of all else.
void OutputFile::settle() {
  if (target_.empty())
    return;
  if (has_replaced_)
    files_.remove_all(temporary_);
  temporary_.clear();
  file_.reset();
  files_.sync_directory(target_.parent_path());
  lock_.reset();
}

void OutputFile::require_replaceable() const {
  if (!replace_ || (!is_own_name_ && files_.kind(target_) != FileKind::regular))
    throw already_there(target_, "appeared meanwhile");
}

void OutputFile::publish(std::span<const std::byte> bytes) {
  file_->write_at(0, bytes);
  publish();
}

void publish_all(std::span<OutputFile* const> outputs) {
  for (OutputFile* output : outputs)
    output->force();
  std::size_t named = 0;
  try {
    for (; named < outputs.size(); ++named)
      outputs[named]->give_name_for_now();
  } catch (const Error&) {
    while (named > 0)
      outputs[--named]->take_name_back();
    throw;
  }
  for (OutputFile* output : outputs)
    output->settle();
}

}  // namespace meshhier::storage
