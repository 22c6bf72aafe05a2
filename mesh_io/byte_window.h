// A file read forwards through one buffer: of fixed size, or of the file's if that is smaller.
#pragma once

#include "storage/io/file.h"
#include "storage/io/file_checksum.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace meshhier::mesh_io {

/// A file that is read for its content, and for its checksum on the way.
struct InputFile {
  const storage::File& file;
  std::uint64_t bytes = 0;  ///< the file's size; nothing beyond is read
  storage::FileChecksum* checksum = nullptr;

  /// Throws Error(io), also if the file has become shorter. Thread-safe.
  void read(std::uint64_t offset, std::span<std::byte> to) const {
    file.read_exact(offset, to);
    if (checksum != nullptr)
      checksum->add(offset, to);
  }
};

class ByteWindow {
 public:
  /// The unit of reading: large enough that a disk streams, small enough to stay in the L2 cache.
  /// Also above the largest row without lists a header of kMaxHeaderBytes can declare (150 KiB).
  static constexpr std::size_t kCapacity = std::size_t{1} << 20;

  explicit ByteWindow(const InputFile& input)
      : input_(input),
        buffer_(std::make_unique_for_overwrite<std::byte[]>(
            static_cast<std::size_t>(std::min<std::uint64_t>(kCapacity, input.bytes)))) {}

  /// Return the offset in the file of begin(), and the number of bytes from there to the file's
  /// end.
  std::uint64_t offset() const { return base_ + begin_; }
  std::uint64_t remaining() const { return input_.bytes - offset(); }
  const storage::File& file() const { return input_.file; }

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

  InputFile input_;
  std::unique_ptr<std::byte[]> buffer_;  ///< kCapacity, or the whole file
  std::uint64_t base_ = 0;               ///< offset in the file of buffer_[0]
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace meshhier::mesh_io
