// Appends text and bytes to a file, many at once.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {

class BufferedFile {
 public:
  explicit BufferedFile(std::shared_ptr<storage::File> file) : file_(std::move(file)) {}

  /// As fmt::format(). Throws Error(io).
  template <class... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(fmt::appender(buffer_), format, std::forward<Values>(values)...);
    flush_if_full();
  }
  void append(std::span<const std::byte> bytes) {
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    buffer_.append(text, text + bytes.size());
    flush_if_full();
  }
  /// Required after the last byte.
  void flush() {
    file_->write_at(written_, std::as_bytes(std::span(buffer_.data(), buffer_.size())));
    written_ += buffer_.size();
    buffer_.clear();
  }
  /// Returns the bytes that were flushed so far.
  std::uint64_t size() const { return written_; }

 private:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

  void flush_if_full() {
    if (buffer_.size() >= kBufferBytes)
      flush();
  }

  std::shared_ptr<storage::File> file_;
  fmt::memory_buffer buffer_;
  std::uint64_t written_ = 0;
};

}  // namespace meshhier::bench
