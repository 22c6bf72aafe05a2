// The content of an input file from its start to its end, unpacked on the way if it is gzip.
#pragma once

#include "mesh_io/byte_window.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Called before each block of the file is read, with its number of bytes. May throw, which ends
/// the reading.
using ReadWatch = std::function<void(std::uint64_t)>;

/// A content that is read once, forwards. For one thread.
class InputStream {
 public:
  virtual ~InputStream() = default;
  /// Fills `to` as far as the content goes: fewer bytes only at its end. Throws Error(io), and
  /// Error(input) naming the byte of the file if it is damaged gzip.
  virtual std::size_t read(std::span<std::byte> to) = 0;
};

/// The file's bytes in consecutive blocks of the checksum's size.
class FileBlocks {
 public:
  FileBlocks(const InputFile& input, ReadWatch watch);

  /// Returns the next block, valid until the next call; empty at the end. Throws Error(io).
  std::span<const std::byte> next();
  /// Returns the offset in the file behind the last block.
  std::uint64_t offset() const { return offset_; }
  const InputFile& input() const { return input_; }

 private:
  InputFile input_;
  ReadWatch watch_;
  std::vector<std::byte> buffer_;
  std::uint64_t offset_ = 0;
};

/// Returns whether the file starts as gzip does (RFC 1952). Throws Error(io).
bool is_gzip(const storage::File& file);

/// Opens the content of `input`, whose File must outlive the stream. When read() has come to the
/// end, all of the file has been read and added to its checksum.
std::unique_ptr<InputStream> open_stream(const InputFile& input, ReadWatch watch);

/// Reads and forgets `bytes`, or up to the end; returns how many there were. Throws as read().
std::uint64_t skip(InputStream& stream, std::uint64_t bytes);

}  // namespace meshhier::mesh_io
