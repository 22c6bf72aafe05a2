// Reads encoded bytes one after another, a buffer at a time.
#pragma once

#include "images/image_codec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace meshhier::images {

inline constexpr std::string_view kEndsEarly =
    "the picture ends early; the file may have been cut off";

/// Reads as many bytes as there is room for; fewer only at the end. Returns how many.
inline std::size_t read_at(const ByteSource& source, std::uint64_t offset,
                           std::span<std::byte> into) {
  std::size_t count = 0;
  for (std::size_t more = 1; more > 0 && count < into.size(); count += more)
    more = source(offset + count, into.subspan(count));
  return count;
}

class SourceBuffer {
 public:
  explicit SourceBuffer(ByteSource source) : source_(std::move(source)) {}

  /// Returns some bytes behind the last ones, valid until the next call; none at the end.
  std::span<const std::byte> next() {
    const std::size_t count = source_(offset_, buffer_);
    offset_ += count;
    return std::span(buffer_).first(count);
  }
  /// Leaves out bytes behind the last ones.
  void skip(std::uint64_t bytes) { offset_ += bytes; }

 private:
  ByteSource source_;
  std::uint64_t offset_ = 0;
  std::array<std::byte, 16384> buffer_{};
};

}  // namespace meshhier::images
