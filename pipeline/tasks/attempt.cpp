#include "pipeline/tasks/attempt.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/io/process.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace meshhier::pipeline {
namespace {

void copy_file(storage::FileSystem& files, const std::filesystem::path& from,
               const std::filesystem::path& to, const execution::CancelToken& cancel) {
  constexpr std::uint64_t kCopiedAtOnce = std::uint64_t{4} << 20;
  const auto source = files.open(from);
  const auto copy = files.create(to);
  const std::uint64_t size = source->size();
  std::vector<std::byte> buffer(std::min(size, kCopiedAtOnce));
  for (std::uint64_t at = 0; at < size; at += kCopiedAtOnce) {
    cancel.check();
    const auto block = std::span(buffer).first(std::min(size - at, kCopiedAtOnce));
    source->read_exact(at, block);
    copy->write_at(at, block);
  }
}

}  // namespace

Attempt::Attempt(storage::FileSystem& files, std::filesystem::path work,
                 const std::filesystem::path& scratch)
    : files_(files),
      work_(std::move(work)),
      directory_((scratch.empty() ? storage::attempts_path(work_) : scratch) /
                 storage::unique_name()) {
  files_.make_directories(directory_);
  if (scratch.empty())
    shared_ = directory_;
}

Attempt::~Attempt() {
  for (const std::filesystem::path& directory : {directory_, shared_}) {
    try {
      if (!directory.empty())
        files_.remove_all(directory);
    } catch (const Error&) {  // `finish` removes what is left
    }
  }
}

std::filesystem::path Attempt::shared_directory() {
  if (shared_.empty()) {
    shared_ = storage::attempts_path(work_) / storage::unique_name();
    files_.make_directories(shared_);
  }
  return shared_;
}

void Attempt::seal(const storage::SegmentWriter& entries, const std::filesystem::path& data,
                   const storage::SegmentName& name, const execution::CancelToken& cancel) {
  std::filesystem::path file = data.empty() ? shared_directory() / "segment" : data;
  if (!data.empty() && shared_directory() != directory_) {
    file = shared_directory() / "segment";
    copy_file(files_, data, file, cancel);
  }
  {
    const auto segment = files_.exists(file) ? files_.reopen(file) : files_.create(file);
    entries.seal(*segment, segment->size());
  }
  const std::filesystem::path sealed = storage::segment_path(work_, name);
  if (!files_.rename_new(file, sealed) && !storage::Segment::is_whole(files_, work_, name))
    files_.rename(file, sealed);
  files_.sync_directory(storage::segments_path(work_));
}

}  // namespace meshhier::pipeline
