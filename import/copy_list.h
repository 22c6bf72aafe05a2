// Vertices that lie where an earlier one does.
#pragma once

#include "hierarchy/copy_vertex.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::importing {

/// All copies of a mesh, ascending by id, in a spool. An empty one holds nothing.
class CopyList {
 public:
  CopyList() = default;
  /// `scratch` must outlive the list.
  explicit CopyList(storage::ScratchFile& scratch);

  /// In ascending order.
  void append(const CopyVertex& copy);

  std::uint64_t count() const { return copies_ ? copies_->size() : 0; }
  bool empty() const { return count() == 0; }

  /// Those with ids in [first, first + count), in `memory`. Thread-safe for different `memory`.
  /// Reads whole blocks of kBlockIds ids.
  std::span<const CopyVertex> read(std::uint64_t first, std::uint64_t count,
                                   std::vector<CopyVertex>& memory) const;

  /// Calls visit(copy) for all, ascending by id; `check` before each block, which may throw.
  template <class Check, class Visit>
  void for_each(const Check& check, const Visit& visit) const {
    std::vector<CopyVertex> memory;
    for (std::uint64_t block = 0; block < starts_.size(); ++block) {
      check();
      for (const CopyVertex& copy : read(block * kBlockIds, kBlockIds, memory))
        visit(copy);
    }
  }

  static constexpr std::uint64_t kBlockIds = 65536;  ///< as many as blocks of vertices have

 private:
  /// The first copy of a block of ids, or behind it.
  std::uint64_t start(std::uint64_t block) const {
    return block < starts_.size() ? starts_[block] : count();
  }

  std::unique_ptr<storage::RecordSpool<CopyVertex>> copies_;
  std::vector<std::uint64_t> starts_;  ///< of each block of ids that is begun
};

/// Asks for ids in ascending order whether they are copies.
class CopyCursor {
 public:
  explicit CopyCursor(const CopyList& copies) : copies_(copies) {}

  /// `id` not below that of the call before.
  bool is_copy(std::uint32_t id);

 private:
  const CopyList& copies_;
  std::uint64_t block_ = UINT64_MAX;
  std::vector<CopyVertex> memory_;
  std::span<const CopyVertex> rest_;
};

}  // namespace meshhier::importing
