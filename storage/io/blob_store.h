// Numbered blobs of scratch data that outlive the process: all on disk, and in memory too while the
// budget lasts.
#pragma once

#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::storage {

/// A blob's bytes: in place if the store holds them in memory, else read from disk. A view is valid
/// as long as the store keeps the blob.
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

/// The place of a blob in a scratch file.
struct StoredBlob {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64
};

/// Each blob is put once, or restored, and read any number of times. Threads may put and read
/// different blobs at once; a blob may be read once its put() has returned. Failures of the scratch
/// file throw Error(io). Indices are below count().
class BlobStore {
 public:
  BlobStore(ScratchFile& scratch, std::size_t count) : scratch_(&scratch), blobs_(count) {}
  BlobStore(BlobStore&&) = default;
  BlobStore& operator=(BlobStore&&) = delete;
  ~BlobStore() { clear(); }

  std::size_t count() const { return blobs_.size(); }
  /// Writes a blob to disk, and keeps a copy in memory if the pool has room for it.
  void put(std::size_t index, std::span<const std::byte> bytes);
  /// Writes a blob to disk alone.
  void put_on_disk(std::size_t index, std::span<const std::byte> bytes);
  std::uint64_t size(std::size_t index) const { return blobs_[index].stored.bytes; }

  /// The place of a blob: for restore(), in another process even.
  const StoredBlob& stored(std::size_t index) const { return blobs_[index].stored; }
  /// Takes a blob that is in the scratch file already. Returns false, and nothing happens, if what
  /// is there is not what was put. In a mounted file only the length is looked at: such a blob is
  /// checked when it is viewed.
  bool restore(std::size_t index, const StoredBlob& stored);

  /// Copies bytes.size() bytes from `offset`, without a check; requires them to be there.
  void read(std::size_t index, std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Copies the first bytes.size() bytes, which must be there. A blob of a mounted file is checked
  /// as a whole the first time: throws as view(), then also if it has fewer.
  void copy(std::size_t index, std::span<std::byte> bytes) const;
  /// Returns a whole blob, without a copy if it is in memory. Throws ScratchFile::changed() if the
  /// disk has changed it.
  BlobView view(std::size_t index) const;

  /// Gives the memory back; all stays on disk. There must be no view.
  void drop_copies();
  /// Forgets everything and gives its memory back. There must be no view.
  void clear();

 private:
  struct Blob {
    StoredBlob stored;
    std::unique_ptr<std::byte[]> memory;
  };
  bool is_as_put(const StoredBlob& stored, std::span<std::byte> bytes) const;

  ScratchFile* scratch_;
  std::vector<Blob> blobs_;
  mutable std::vector<char> checked_;  ///< those of mounted files that were as put; may be empty
};

}  // namespace meshhier::storage
