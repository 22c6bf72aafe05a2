// A list of vertices that lie where an earlier one does.
#pragma once

#include "hierarchy/copy_vertex.h"
#include "storage/io/blob_store.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::importing {

/// The place in a scratch file of the copies of a block of ids.
struct StoredCopies {
  std::uint64_t block = 0;
  storage::StoredBlob blob;
};

/// All copies of a mesh, ascending by id, in a spool. An empty one holds nothing.
class CopyList {
 public:
  CopyList() = default;
  /// `scratch` must outlive the list.
  explicit CopyList(storage::ScratchFile& scratch);

  /// Makes an empty list for a mesh of so many vertices, for restore().
  CopyList(storage::ScratchFile& scratch, std::uint64_t vertices);

  /// Takes the next copy; ids ascend.
  void append(const CopyVertex& copy);

  /// Puts all copies into another scratch file, for restore(), in another process even; `check` as
  /// for for_each(). Throws Error(io).
  template <class Check>
  std::vector<StoredCopies> store(storage::ScratchFile& scratch, const Check& check) const;
  /// Takes a block that was stored; false if it is none of this mesh, or if the scratch file does
  /// not hold it.
  bool restore(const StoredCopies& stored);

  std::uint64_t count() const { return copies_ ? copies_->size() : restored_count_; }
  bool empty() const { return count() == 0; }

  /// Returns the copies with ids in [first, first + count), which lie in `memory`. Thread-safe for
  /// different `memory`. Reads whole blocks of kBlockIds ids. Throws as BlobStore::view() of what
  /// was restored.
  std::span<const CopyVertex> read(std::uint64_t first, std::uint64_t count,
                                   std::vector<CopyVertex>& memory) const;

  /// Calls visit(copy) for all, ascending by id; `check` before each block, which may throw.
  template <class Check, class Visit>
  void for_each(const Check& check, const Visit& visit) const {
    for_each(0, blocks() * kBlockIds, check, visit);
  }
  /// Does the same for the copies with ids in [first, end).
  template <class Check, class Visit>
  void for_each(std::uint64_t first, std::uint64_t end, const Check& check,
                const Visit& visit) const {
    std::vector<CopyVertex> memory;
    end = std::min(end, blocks() * kBlockIds);
    while (first < end) {
      check();
      const std::uint64_t next = std::min(end, (first / kBlockIds + 1) * kBlockIds);
      for (const CopyVertex& copy : read(first, next - first, memory))
        visit(copy);
      first = next;
    }
  }

  static constexpr std::uint64_t kBlockIds = 65536;  ///< as many as blocks of vertices have

 private:
  std::uint64_t blocks() const { return blobs_ ? blobs_->count() : starts_.size(); }
  /// Appends the copies of a block of ids to `memory`.
  void add_block(std::uint64_t block, std::vector<CopyVertex>& memory) const;
  /// Returns the index of a block's first copy, or of the next block's if it has none.
  std::uint64_t start(std::uint64_t block) const {
    return block < starts_.size() ? starts_[block] : count();
  }

  std::unique_ptr<storage::RecordSpool<CopyVertex>> copies_;
  /// Indices of first copies, for each block of ids that is begun.
  std::vector<std::uint64_t> starts_;
  std::unique_ptr<storage::BlobStore> blobs_;  ///< copies of a restored list, by block of ids
  std::uint64_t restored_count_ = 0;
};

template <class Check>
std::vector<StoredCopies> CopyList::store(storage::ScratchFile& scratch, const Check& check) const {
  storage::BlobStore blobs(scratch, blocks());
  std::vector<StoredCopies> stored;
  std::vector<CopyVertex> memory;
  for (std::uint64_t block = 0; block < blocks(); ++block) {
    check();
    memory.clear();
    add_block(block, memory);
    if (memory.empty())
      continue;
    blobs.put(block, std::as_bytes(std::span(memory)));
    stored.push_back({block, blobs.stored(block)});
  }
  return stored;
}

/// Tells of ids in ascending order whether they are copies. For one thread.
class CopyCursor {
 public:
  explicit CopyCursor(const CopyList& copies) : copies_(copies) {}

  /// Requires an `id` not below that of the call before.
  bool is_copy(std::uint32_t id);

 private:
  const CopyList& copies_;
  std::uint64_t block_ = UINT64_MAX;
  std::vector<CopyVertex> memory_;
  std::span<const CopyVertex> rest_;
};

}  // namespace meshhier::importing
