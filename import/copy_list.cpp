#include "import/copy_list.h"

#include "import/raw_mesh.h"

#include <algorithm>

namespace meshhier::importing {

CopyList::CopyList(storage::ScratchFile& scratch)
    : copies_(std::make_unique<storage::RecordSpool<CopyVertex>>(scratch, kImportSpoolBytes)) {}

void CopyList::append(const CopyVertex& copy) {
  starts_.resize(std::max<std::size_t>(starts_.size(), copy.id / kBlockIds + 1), count());
  copies_->append(copy);
}

std::span<const CopyVertex> CopyList::read(std::uint64_t first, std::uint64_t count,
                                           std::vector<CopyVertex>& memory) const {
  memory.clear();
  if (empty() || count == 0)
    return memory;
  const std::uint64_t begin = start(first / kBlockIds);
  memory.resize(start((first + count - 1) / kBlockIds + 1) - begin);
  copies_->read(begin, memory);
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
