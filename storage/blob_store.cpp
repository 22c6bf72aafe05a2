#include "storage/blob_store.h"

#include <cassert>
#include <cstring>

namespace meshhier::storage {

void BlobStore::put(std::size_t index, std::span<const std::byte> bytes) {
  Blob& blob = blobs_[index];
  assert(blob.size == 0);
  blob.size = bytes.size();
  if (bytes.empty())
    return;
  if (scratch_->pool().try_take(bytes.size())) {
    blob.memory = std::make_unique_for_overwrite<std::byte[]>(bytes.size());
    std::memcpy(blob.memory.get(), bytes.data(), bytes.size());
  } else {
    blob.offset = scratch_->append(bytes);
  }
}

void BlobStore::read(std::size_t index, std::uint64_t offset, std::span<std::byte> bytes) const {
  const Blob& blob = blobs_[index];
  assert(offset + bytes.size() <= blob.size);
  if (bytes.empty())
    return;
  if (blob.memory) {
    std::memcpy(bytes.data(), blob.memory.get() + offset, bytes.size());
  } else {
    scratch_->read(blob.offset + offset, bytes);
  }
}

std::vector<std::byte> BlobStore::get(std::size_t index) const {
  std::vector<std::byte> bytes(blobs_[index].size);
  read(index, 0, bytes);
  return bytes;
}

void BlobStore::clear() {
  for (Blob& blob : blobs_) {
    if (blob.memory)
      scratch_->pool().give_back(blob.size);
    blob = {};
  }
}

}  // namespace meshhier::storage
