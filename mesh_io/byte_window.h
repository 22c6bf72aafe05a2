// A file read forwards through one buffer of fixed size.
#pragma once

#include "storage/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace meshhier::mesh_io {

class ByteWindow {
 public:
  /// The unit of reading: large enough that a disk streams, small enough to stay in the L2 cache.
  /// Also above the largest row without lists a header of kMaxHeaderBytes can declare (150 KiB).
  static constexpr std::size_t kCapacity = std::size_t{1} << 20;

  /// `file_bytes`: the file's size; nothing beyond is read.
  ByteWindow(const storage::File& file, std::uint64_t file_bytes)
      : file_(file),
        file_bytes_(file_bytes),
        buffer_(std::make_unique_for_overwrite<std::byte[]>(kCapacity)) {}

  /// Offset in the file of begin(), and what follows from there.
  std::uint64_t offset() const { return base_ + begin_; }
  std::uint64_t remaining() const { return file_bytes_ - offset(); }
  const storage::File& file() const { return file_; }

  /// The bytes in memory.
  const std::byte* begin() const { return buffer_.get() + begin_; }
  const std::byte* end() const { return buffer_.get() + end_; }
  std::size_t available() const { return end_ - begin_; }

  /// Makes at least `bytes` <= kCapacity available; false if the file has fewer left (all of them
  /// are available then). Moves the bytes. Throws Error(io).
  bool ensure(std::size_t bytes) { return available() >= bytes || refill(bytes); }

  /// Moves forwards: within the bytes in memory, or by any number up to remaining().
  void advance(std::size_t bytes) { begin_ += bytes; }
  void skip(std::uint64_t bytes) { seek(offset() + bytes); }

  void seek(std::uint64_t offset);

 private:
  bool refill(std::size_t bytes);

  const storage::File& file_;
  std::uint64_t file_bytes_;
  std::unique_ptr<std::byte[]> buffer_;  ///< kCapacity
  std::uint64_t base_ = 0;               ///< offset in the file of buffer_[0]
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace meshhier::mesh_io
