// A text in memory as a stream.
#pragma once

#include "mesh_io/input_stream.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>

namespace meshhier::mesh_io {

/// Refers to the text.
class TextStream final : public InputStream {
 public:
  explicit TextStream(std::string_view text) : text_(text) {}

  std::size_t read(std::span<std::byte> to) override {
    const std::size_t count = std::min(to.size(), text_.size());
    if (count > 0)
      std::memcpy(to.data(), text_.data(), count);
    text_.remove_prefix(count);
    return count;
  }

 private:
  std::string_view text_;
};

}  // namespace meshhier::mesh_io
