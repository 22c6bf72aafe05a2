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

BlobView BlobStore::view(std::size_t index) const {
  const Blob& blob = blobs_[index];
  if (blob.memory || blob.size == 0)
    return BlobView({blob.memory.get(), blob.size});
  auto bytes = std::make_unique_for_overwrite<std::byte[]>(blob.size);
  scratch_->read(blob.offset, {bytes.get(), blob.size});
  return BlobView(std::move(bytes), blob.size);
}

void BlobStore::clear() {
  for (Blob& blob : blobs_) {
    if (blob.memory)
      scratch_->pool().give_back(blob.size);
    blob = {};
  }
}

}  // namespace meshhier::storage
