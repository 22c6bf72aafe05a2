// Bytes on their way to a file, from its first to its last.
#pragma once

#include "storage/io/file.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::exporting {

/// Writes a file in buffers of 1 MiB. All throw Error(io). For one thread.
class ByteStream {
 public:
  explicit ByteStream(storage::File& file) : file_(file) { buffer_.reserve(kBufferBytes); }

  void put(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const std::size_t count = std::min(bytes.size(), kBufferBytes - buffer_.size());
      buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + count);
      bytes = bytes.subspan(count);
      if (buffer_.size() == kBufferBytes)
        flush();
    }
  }
  void put(std::string_view text) { put(std::as_bytes(std::span(text))); }

  /// Required after the last bytes.
  void flush() {
    file_.write_at(written_, buffer_);
    written_ += buffer_.size();
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

  storage::File& file_;
  std::vector<std::byte> buffer_;
  std::uint64_t written_ = 0;
};

}  // namespace meshhier::exporting
