// A text without the zeros that may follow it.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Hands on all but the zeros at the end of a stream, which must outlive it. Throws as that stream.
class UnpaddedStream final : public InputStream {
 public:
  explicit UnpaddedStream(InputStream& stream);

  std::size_t read(std::span<std::byte> to) override;
  /// Returns how many zeros were left out; known at the end.
  std::uint64_t padding() const { return held_; }

 private:
  bool refill();

  InputStream& stream_;
  std::vector<std::byte> buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< bytes of the buffer to be handed on
  std::uint64_t zeros_ = 0;          ///< zeros that come before them
  std::uint64_t held_ = 0;           ///< zeros that come behind them, if more follows
  bool has_ended_ = false;
};

}  // namespace meshhier::mesh_io
