#include "mesh_io/unpadded_stream.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace meshhier::mesh_io {

namespace {
constexpr std::size_t kUnpaddedBlock = std::size_t{1} << 16;
}  // namespace

UnpaddedStream::UnpaddedStream(InputStream& stream) : stream_(stream), buffer_(kUnpaddedBlock) {}

std::size_t UnpaddedStream::read(std::span<std::byte> to) {
  std::size_t done = 0;
  while (done < to.size() && (zeros_ > 0 || begin_ < end_ || refill())) {
    const std::size_t room = to.size() - done;
    const auto zeros = static_cast<std::size_t>(std::min<std::uint64_t>(zeros_, room));
    std::ranges::fill(to.subspan(done, zeros), std::byte{0});
    zeros_ -= zeros;
    const std::size_t count = zeros_ > 0 ? 0 : std::min(end_ - begin_, room - zeros);
    if (count > 0)
      std::memcpy(to.data() + done + zeros, buffer_.data() + begin_, count);
    begin_ += count;
    done += zeros + count;
  }
  return done;
}

/// Returns false at the end.
bool UnpaddedStream::refill() {
  while (!has_ended_) {
    const std::size_t count = stream_.read(buffer_);
    has_ended_ = count < buffer_.size();
    const auto bytes = std::span(buffer_).first(count);
    const auto last = std::ranges::find_if(bytes.rbegin(), bytes.rend(),
                                           [](std::byte b) { return b != std::byte{0}; });
    begin_ = 0;
    end_ = static_cast<std::size_t>(bytes.rend() - last);
    const std::uint64_t padding = count - end_;
    if (end_ == 0) {
      held_ += padding;
      continue;
    }
    zeros_ = std::exchange(held_, padding);
    return true;
  }
  return false;
}

}  // namespace meshhier::mesh_io
