#include "mesh_io/byte_window.h"

#include <algorithm>
#include <cstring>
#include <span>

namespace meshhier::mesh_io {

void ByteWindow::seek(std::uint64_t offset) {
  if (offset >= base_ && offset - base_ <= end_) {
    begin_ = static_cast<std::size_t>(offset - base_);
    return;
  }
  base_ = offset;
  begin_ = 0;
  end_ = 0;
}

bool ByteWindow::refill(std::size_t bytes) {
  const std::size_t kept = available();
  const std::uint64_t behind = input_.bytes - (base_ + end_);
  if (behind == 0)
    return false;
  std::memmove(buffer_.get(), begin(), kept);
  base_ += begin_;
  begin_ = 0;
  end_ = kept;
  std::size_t wanted = std::min<std::uint64_t>(kCapacity - kept, behind);
  // The read ends where a checksum's block does, if that is enough: the next read then begins with
  // one.
  const std::size_t beyond = (base_ + kept + wanted) % storage::FileChecksum::kBlockBytes;
  if (wanted < behind && beyond < wanted && kept + wanted - beyond >= bytes)
    wanted -= beyond;
  // A file that shrinks while it is read is a failure of I/O, told as such.
  input_.read(base_ + kept, std::span(buffer_.get() + kept, wanted));
  end_ += wanted;
  return available() >= bytes;
}

}  // namespace meshhier::mesh_io
