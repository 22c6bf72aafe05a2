#include "storage/io/output_file.h"

#include "hierarchy/error.h"
#include "storage/io/process.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

/// The name that the system has for what is asked for.
fs::path system_path(const fs::path& path) {
  return path == kStandardOutput ? fs::path("/dev/stdout") : path;
}

bool is_in(const fs::path& path, const fs::path& place) {
  return std::mismatch(place.begin(), place.end(), path.begin(), path.end()).first == place.end();
}

/// Unlike a work directory, the parent is not made: a mistyped path should be told.
void require_parent(FileSystem& files, const OutputRequest& request, const fs::path& target) {
  const fs::path directory = target.parent_path();
  if (directory.empty() || files.is_directory(directory))
    return;
  throw Error(ErrorCode::io, fmt::format("cannot write {}: there is no directory {}",
                                         request.path.string(), directory.string()));
}

[[noreturn]] void refuse_kind(const OutputRequest& request, const char* what) {
  throw Error(ErrorCode::usage, fmt::format("cannot write {}: it is {}, and the output is one file",
                                            request.path.string(), what));
}

Error already_there(const fs::path& path, const char* state) {
  return {ErrorCode::exists, fmt::format("{} {}; --force replaces it", path.string(), state)};
}

}  // namespace

bool is_standard_output(FileSystem& files, const fs::path& path) {
  return files.kind(system_path(path)) == FileKind::standard_output;
}

void require_apart(FileSystem& files, const fs::path& output, std::span<const fs::path> inputs) {
  const fs::path file = files.canonical(output);
  for (const fs::path& input : inputs) {
    const fs::path place = files.canonical(input);
    if (!is_in(file, place))
      continue;
    throw Error(ErrorCode::usage,
                fmt::format("cannot write {}: it {} {}; name another output", output.string(),
                            file == place ? "is the input" : "lies in", input.string()));
  }
}

fs::path unfinished_path(const fs::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-part", file.filename().string());
}

fs::path scratch_path(const fs::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-scratch", file.filename().string());
}

OutputFile::OutputFile(FileSystem& files, const OutputRequest& request,
                       const std::function<void()>& check)
    : files_(files), check_(check), replace_(request.replace) {
  const fs::path path = system_path(request.path);
  switch (files.kind(path)) {
    case FileKind::stream:
    case FileKind::standard_output:
      file_ = files.open_stream(path, check);
      scratch_ = scratch_path(own_temporary_path());
      return;
    case FileKind::directory:
      refuse_kind(request, "a directory");
    case FileKind::other:
      refuse_kind(request, "neither a regular file nor a FIFO nor a character device");
    case FileKind::regular:
      require_apart(files, request.path, request.inputs);
      if (!replace_)
        throw already_there(request.path, "is already there");
      break;
    case FileKind::none:
      if (path.filename().empty() || path.filename() == "." || path.filename() == "..")
        refuse_kind(request, "no name of a file");
      require_apart(files, request.path, request.inputs);
      break;
  }
  open_regular(request);
}

void OutputFile::open_regular(const OutputRequest& request) {
  target_ = files_.canonical(request.path);
  require_parent(files_, request, target_);
  temporary_ = unfinished_path(target_);
  scratch_ = scratch_path(target_);
  lock_ = files_.try_lock(temporary_);
  if (!lock_) {
    throw Error(ErrorCode::exists,
                fmt::format("another command is writing {}", request.path.string()));
  }
  file_ = files_.create(temporary_);
}

OutputFile::~OutputFile() {
  if (!file_ || target_.empty())
    return;
  file_.reset();
  try {
    files_.remove_all(temporary_);
  } catch (const Error&) {  // the failure that brought us here is the one to report
  }
}

void OutputFile::publish() {
  if (target_.empty())
    return file_.reset();
  file_->sync(check_);
  const bool is_new = files_.rename_new(temporary_, target_);
  if (!is_new && !replace_)
    throw already_there(target_, "appeared meanwhile");
  const bool exchanged = !is_new && files_.exchange(temporary_, target_);
  if (!is_new && !exchanged)
    files_.rename(temporary_, target_);
  try {
    files_.sync_directory(target_.parent_path());
  } catch (const Error&) {
    if (exchanged)
      files_.exchange(temporary_, target_);
    else if (is_new)
      files_.rename(target_, temporary_);
    throw;
  }
  file_.reset();
  if (exchanged)
    files_.remove_all(temporary_);
}

void OutputFile::publish(std::span<const std::byte> bytes) {
  file_->write_at(0, bytes);
  publish();
}

}  // namespace meshhier::storage
