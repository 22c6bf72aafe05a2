#include "import/copy_list.h"

#include "import/raw_mesh.h"

#include <algorithm>

namespace meshhier::importing {

CopyList::CopyList(storage::ScratchFile& scratch)
    : copies_(std::make_unique<storage::RecordSpool<CopyVertex>>(scratch, kImportSpoolBytes)) {}

CopyList::CopyList(storage::ScratchFile& scratch, std::uint64_t vertices)
    : blobs_(
          std::make_unique<storage::BlobStore>(scratch, (vertices + kBlockIds - 1) / kBlockIds)) {}

bool CopyList::restore(const StoredCopies& stored) {
  if (stored.block >= blobs_->count() || stored.blob.bytes % sizeof(CopyVertex) != 0 ||
      stored.blob.bytes > kBlockIds * sizeof(CopyVertex) || blobs_->size(stored.block) > 0 ||
      !blobs_->restore(stored.block, stored.blob))
    return false;
  restored_count_ += stored.blob.bytes / sizeof(CopyVertex);
  return true;
}

void CopyList::add_block(std::uint64_t block, std::vector<CopyVertex>& memory) const {
  const std::size_t before = memory.size();
  if (blobs_) {
    const storage::BlobView view = blobs_->view(block);
    memory.resize(before + view.bytes().size() / sizeof(CopyVertex));
    std::ranges::copy(view.bytes(),
                      std::as_writable_bytes(std::span(memory).subspan(before)).begin());
    return;
  }
  memory.resize(before + start(block + 1) - start(block));
  copies_->read(start(block), std::span(memory).subspan(before));
}

void CopyList::append(const CopyVertex& copy) {
  starts_.resize(std::max<std::size_t>(starts_.size(), copy.id / kBlockIds + 1), count());
  copies_->append(copy);
}

std::span<const CopyVertex> CopyList::read(std::uint64_t first, std::uint64_t count,
                                           std::vector<CopyVertex>& memory) const {
  memory.clear();
  if (empty() || count == 0)
    return memory;
  const std::uint64_t end = std::min((first + count - 1) / kBlockIds + 1, blocks());
  for (std::uint64_t block = first / kBlockIds; block < end; ++block)
    add_block(block, memory);
  const auto at = [&](std::uint64_t id) {
    return std::lower_bound(memory.begin(), memory.end(), id,
                            [](const CopyVertex& copy, std::uint64_t i) { return copy.id < i; });
  };
  return {at(first), at(first + count)};
}

bool CopyCursor::is_copy(std::uint32_t id) {
  if (copies_.empty())
    return false;
  if (const std::uint64_t block = id / CopyList::kBlockIds; block != block_) {
    block_ = block;
    rest_ = copies_.read(block * CopyList::kBlockIds, CopyList::kBlockIds, memory_);
  }
  while (!rest_.empty() && rest_.front().id < id)
    rest_ = rest_.subspan(1);
  return !rest_.empty() && rest_.front().id == id;
}

}  // namespace meshhier::importing
