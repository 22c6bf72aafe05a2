#include "storage/spool.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace meshhier::storage {

bool MemoryPool::try_take(std::uint64_t bytes) {
  std::int64_t before = free_.load();
  do {
    if (before < static_cast<std::int64_t>(bytes))
      return false;
  } while (!free_.compare_exchange_weak(before, before - static_cast<std::int64_t>(bytes)));
  return true;
}

ScratchFile::ScratchFile(FileSystem& files, std::filesystem::path path, MemoryPool& pool)
    : files_(files), path_(std::move(path)), pool_(pool) {}

ScratchFile::~ScratchFile() {
  if (!file_)
    return;
  file_.reset();
  pool_.scratch_use().add_removed(size_);
  try {
    files_.remove_all(path_);
  } catch (const Error&) {  // the whole work directory is removed at the end of a build in any case
  }
}

std::uint64_t ScratchFile::append(std::span<const std::byte> bytes) {
  File* file = nullptr;
  std::uint64_t offset = 0;
  bool grows = false;
  {
    const std::lock_guard lock(mutex_);
    if (!file_)
      file_ = files_.create(path_);
    file = file_.get();
    const auto free = free_.find(bytes.size());
    grows = free == free_.end() || free->second.empty();
    if (grows) {
      offset = size_.fetch_add(bytes.size());
    } else {
      offset = free->second.back();
      free->second.pop_back();
    }
  }
  file->write_at(offset, bytes);
  pool_.scratch_use().add_written(bytes.size());
  if (grows)
    pool_.scratch_use().add_grown(bytes.size());
  return offset;
}

void ScratchFile::release(std::uint64_t offset, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  free_[bytes].push_back(offset);
}

Spool::Spool(Spool&& other) noexcept
    : scratch_(other.scratch_),
      block_bytes_(other.block_bytes_),
      size_(std::exchange(other.size_, 0)),
      blocks_(std::move(other.blocks_)) {
  other.blocks_.clear();
}

void Spool::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::size_t used = size_ % block_bytes_;
    if (used == 0)
      open_block();
    const std::size_t count = std::min(bytes.size(), block_bytes_ - used);
    std::memcpy(blocks_.back().memory() + used, bytes.data(), count);
    size_ += count;
    bytes = bytes.subspan(count);
  }
}

/// Begins a block; the full one before goes into the pool, or to disk and leaves its memory.
void Spool::open_block() {
  if (size_ == 0 || scratch_->pool().try_take(block_bytes_)) {
    auto memory = std::make_unique_for_overwrite<std::byte[]>(block_bytes_);
    blocks_.push_back(Block::in_memory(memory.get()));
    memory.release();
    return;
  }
  std::byte* memory = blocks_.back().memory();
  const std::uint64_t offset = scratch_->append({memory, block_bytes_});
  blocks_.push_back(Block::in_memory(memory));
  blocks_[blocks_.size() - 2] = Block::on_disk(offset);
}

void Spool::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  assert(offset + bytes.size() <= size_);
  while (!bytes.empty()) {
    const Block& block = blocks_[offset / block_bytes_];
    const std::size_t start = offset % block_bytes_;
    const std::size_t count = std::min(bytes.size(), block_bytes_ - start);
    if (block.is_on_disk()) {
      scratch_->read(block.offset() + start, bytes.first(count));
    } else {
      std::memcpy(bytes.data(), block.memory() + start, count);
    }
    offset += count;
    bytes = bytes.subspan(count);
  }
}

void Spool::clear() {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].is_on_disk()) {
      scratch_->release(blocks_[i].offset(), block_bytes_);
      continue;
    }
    delete[] blocks_[i].memory();
    if (i + 1 < blocks_.size())
      scratch_->pool().give_back(block_bytes_);
  }
  blocks_ = {};
  size_ = 0;
}

}  // namespace meshhier::storage
