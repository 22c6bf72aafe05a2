// Numbered blobs of scratch data: in memory while the budget lasts, on disk from there on.
#pragma once

#include "storage/spool.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::storage {

/// A blob's bytes: in place if the store holds them in memory, else read from disk. Not valid
/// longer than the store keeps the blob.
class BlobView {
 public:
  explicit BlobView(std::span<const std::byte> in_place) : bytes_(in_place) {}
  BlobView(std::unique_ptr<std::byte[]> read, std::size_t size)
      : bytes_(read.get(), size), read_(std::move(read)) {}

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
  std::unique_ptr<std::byte[]> read_;
};

/// Each blob is put once and read any number of times. Threads may put and read different blobs at
/// once; a blob may be read once its put() has returned.
class BlobStore {
 public:
  BlobStore(ScratchFile& scratch, std::size_t count) : scratch_(&scratch), blobs_(count) {}
  BlobStore(BlobStore&&) = default;
  BlobStore& operator=(BlobStore&&) = delete;
  ~BlobStore() { clear(); }

  std::size_t count() const { return blobs_.size(); }
  void put(std::size_t index, std::span<const std::byte> bytes);
  std::uint64_t size(std::size_t index) const { return blobs_[index].size; }

  /// Copies bytes.size() bytes from `offset`; requires them to be there.
  void read(std::size_t index, std::uint64_t offset, std::span<std::byte> bytes) const;
  /// A whole blob, without a copy if it is in memory.
  BlobView view(std::size_t index) const;

  /// Forgets everything and gives its memory back.
  void clear();

 private:
  struct Blob {
    std::unique_ptr<std::byte[]> memory;
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
  };

  ScratchFile* scratch_;
  std::vector<Blob> blobs_;
};

}  // namespace meshhier::storage
