#include "storage/io/atomic_file.h"

#include "hierarchy/error.h"

#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {

std::filesystem::path unfinished_path(const std::filesystem::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-part", file.filename().string());
}

AtomicFile::AtomicFile(FileSystem& files, std::filesystem::path path)
    : files_(files), path_(std::move(path)), temporary_(unfinished_path(path_)) {
  if (files_.exists(path_))
    files_.open(path_);  // a directory or a device cannot be replaced by a file
  file_ = files_.create(temporary_);
}

AtomicFile::~AtomicFile() {
  if (!file_)
    return;
  file_.reset();
  try {
    files_.remove_all(temporary_);
  } catch (const Error&) {  // the failure that brought us here is the one to report
  }
}

void AtomicFile::publish(std::span<const std::byte> bytes) {
  file_->write_at(0, bytes);
  publish();
}

void AtomicFile::publish() {
  file_->sync();
  files_.rename(temporary_, path_);
  file_.reset();
}

}  // namespace meshhier::storage
