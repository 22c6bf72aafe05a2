// A file of the system, for the sources that open them: file.cpp and folder.cpp.
#pragma once

#include "storage/io/file.h"
#include "storage/io/system_failure.h"

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meshhier::storage {

inline std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

inline FileVersion version_of(const struct stat& status) {
  return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
          nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)};
}

class PosixFile final : public File {
 public:
  PosixFile(std::filesystem::path path, int descriptor, std::shared_ptr<IoCounters> counters)
      : File(std::move(path)), descriptor_(descriptor), counters_(std::move(counters)) {}
  ~PosixFile() override { ::close(descriptor_); }

  std::uint64_t size() const override {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0)
      fail_system("inspect", path(), errno);
    return static_cast<std::uint64_t>(status.st_size);
  }

  FileVersion version() const override {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0)
      fail_system("inspect", path(), errno);
    return version_of(status);
  }

  void sync() override {
    if (::fsync(descriptor_) != 0)
      fail_system("sync", path(), errno);
  }
  using File::sync;

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    ssize_t count = 0;
    do {
      count = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    } while (count < 0 && errno == EINTR);
    if (count < 0)
      fail_system("read", path(), errno);
    counters_->bytes_read += static_cast<std::uint64_t>(count);
    return static_cast<std::size_t>(count);
  }

  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    ssize_t count = 0;
    do {
      count = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    } while (count < 0 && errno == EINTR);
    if (count < 0)
      fail_system("write", path(), errno);
    counters_->bytes_written += static_cast<std::uint64_t>(count);
    return static_cast<std::size_t>(count);
  }

  void write_out(std::uint64_t offset, std::uint64_t bytes, Wait wait) override {
    unsigned flags = SYNC_FILE_RANGE_WRITE;
    if (wait == Wait::yes)
      flags |= SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WAIT_AFTER;
    ::sync_file_range(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(bytes), flags);
  }

 private:
  int descriptor_;
  std::shared_ptr<IoCounters> counters_;
};

}  // namespace meshhier::storage
