// A stream whose start has been looked at.
#pragma once

#include "mesh_io/input_stream.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>

namespace meshhier::querying {

class StartOfStream final : public mesh_io::InputStream {
 public:
  /// `stream` must outlive it.
  explicit StartOfStream(mesh_io::InputStream& stream)
      : stream_(stream), size_(stream.read(start_)) {}

  /// Returns up to 64 bytes.
  std::string_view start() const { return {reinterpret_cast<const char*>(start_.data()), size_}; }

  std::size_t read(std::span<std::byte> to) override {
    const std::size_t count = std::min(to.size(), size_ - taken_);
    if (count > 0)
      std::memcpy(to.data(), start_.data() + taken_, count);
    taken_ += count;
    return count < to.size() ? count + stream_.read(to.subspan(count)) : count;
  }

 private:
  mesh_io::InputStream& stream_;
  std::array<std::byte, 64> start_{};
  std::size_t size_;
  std::size_t taken_ = 0;
};

}  // namespace meshhier::querying
