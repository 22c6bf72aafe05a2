#include "storage/io/blob_store.h"

#include "base/error.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>

namespace meshhier::storage {

void BlobStore::put(std::size_t index, std::span<const std::byte> bytes) {
  put_on_disk(index, bytes);
  if (bytes.empty() || !scratch_->pool().try_take(bytes.size()))
    return;
  Blob& blob = blobs_[index];
  blob.memory = std::make_unique_for_overwrite<std::byte[]>(bytes.size());
  std::memcpy(blob.memory.get(), bytes.data(), bytes.size());
}

void BlobStore::put_on_disk(std::size_t index, std::span<const std::byte> bytes) {
  Blob& blob = blobs_[index];
  assert(blob.stored.bytes == 0);
  if (!bytes.empty())
    blob.stored = {scratch_->append(bytes), bytes.size(), checksum(bytes)};
}

bool BlobStore::restore(std::size_t index, const StoredBlob& stored) {
  const StoredBlob here{scratch_->placed(stored.offset), stored.bytes, stored.checksum};
  if (!scratch_->claim(here.offset, here.bytes))
    return false;
  if (ScratchFile::is_mounted(here.offset)) {
    checked_.resize(blobs_.size());
  } else {
    const auto bytes = std::make_unique_for_overwrite<std::byte[]>(here.bytes);
    if (!is_as_put(here, {bytes.get(), here.bytes}))
      return false;
  }
  blobs_[index].stored = here;
  return true;
}

/// Reads the blob into `bytes`, which has its size, and compares the checksum.
bool BlobStore::is_as_put(const StoredBlob& stored, std::span<std::byte> bytes) const {
  if (bytes.empty())
    return true;
  scratch_->read(stored.offset, bytes);
  return checksum(bytes) == stored.checksum;
}

void BlobStore::read(std::size_t index, std::uint64_t offset, std::span<std::byte> bytes) const {
  const Blob& blob = blobs_[index];
  assert(offset + bytes.size() <= blob.stored.bytes);
  if (bytes.empty())
    return;
  if (blob.memory) {
    std::memcpy(bytes.data(), blob.memory.get() + offset, bytes.size());
  } else {
    scratch_->read(blob.stored.offset + offset, bytes);
  }
}

void BlobStore::copy(std::size_t index, std::span<std::byte> bytes) const {
  if (!ScratchFile::is_mounted(blobs_[index].stored.offset))
    return read(index, 0, bytes);
  // Threads that come at once may all check the blob: they find the same, and no order matters.
  const std::atomic_ref<char> checked(checked_[index]);
  if (checked.load(std::memory_order_relaxed) != 0)
    return read(index, 0, bytes);
  const BlobView whole = view(index);
  if (bytes.size() > whole.bytes().size())
    throw scratch_->changed(blobs_[index].stored.offset);
  std::ranges::copy(whole.bytes().first(bytes.size()), bytes.begin());
  checked.store(1, std::memory_order_relaxed);
}

BlobView BlobStore::view(std::size_t index) const {
  const Blob& blob = blobs_[index];
  const std::size_t size = blob.stored.bytes;
  if (blob.memory || size == 0)
    return BlobView({blob.memory.get(), size});
  auto bytes = std::make_unique_for_overwrite<std::byte[]>(size);
  if (!is_as_put(blob.stored, {bytes.get(), size}))
    throw scratch_->changed(blob.stored.offset);
  return BlobView(std::move(bytes), size);
}

void BlobStore::drop_copies() {
  for (Blob& blob : blobs_) {
    if (blob.memory)
      scratch_->pool().give_back(blob.stored.bytes);
    blob.memory.reset();
  }
}

void BlobStore::clear() {
  drop_copies();
  for (Blob& blob : blobs_)
    blob = {};
}

}  // namespace meshhier::storage
