#include "storage/io/spool.h"

#include "base/error.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {

bool MemoryPool::try_take(std::uint64_t bytes) {
  std::int64_t before = free_.load();
  do {
    if (before < static_cast<std::int64_t>(bytes))
      return false;
  } while (!free_.compare_exchange_weak(before, before - static_cast<std::int64_t>(bytes)));
  return true;
}

ScratchFile::ScratchFile(FileSystem& files, std::filesystem::path path, MemoryPool& pool,
                         Stays stays, Files files_at_once)
    : files_(files),
      path_(std::move(path)),
      pool_(pool),
      stays_(stays),
      own_(files_at_once == Files::one ? 1 : kMostFiles) {
  if (stays == Stays::no)
    return;
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (files_.exists(path_of(i)))
      own_[i].file = files_.reopen(path_of(i));
  }
}

ScratchFile::~ScratchFile() {
  if (stays_ == Stays::yes)
    return;
  try {
    remove();
  } catch (const Error&) {  // the whole work directory is removed at the end of a build in any case
  }
}

std::filesystem::path ScratchFile::path_of(std::size_t own) const {
  std::filesystem::path path = path_;
  if (own > 0)
    path += '.' + std::to_string(own);
  return path;
}

std::uint64_t ScratchFile::size() const {
  const std::lock_guard lock(mutex_);
  return std::accumulate(own_.begin(), own_.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Own& own) { return sum + own.size; });
}

void ScratchFile::remove() {
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (!own_[i].file)
      continue;
    own_[i].file.reset();
    pool_.scratch_use().add_removed(std::exchange(own_[i].size, 0));
    files_.remove_all(path_of(i));
  }
  free_.clear();
}

void ScratchFile::sync(const std::function<void()>& check) {
  std::vector<File*> files;
  {
    const std::lock_guard lock(mutex_);  // others may make files meanwhile
    for (const Own& own : own_) {
      if (own.file)
        files.push_back(own.file.get());
    }
  }
  for (File* file : files)
    file->sync(check);
}

void ScratchFile::mount(std::unique_ptr<File> file) {
  if (mounted_.size() == kMostMounted)
    throw Error(ErrorCode::io, path_.string() + ": too many files are read beside it");
  mounted_.push_back(std::move(file));
}

Error ScratchFile::changed(std::uint64_t offset) const {
  constexpr const char* kWhat =
      " is not what was written to it: the disk, or another program, changed it";
  if (!is_mounted(offset))
    return {ErrorCode::io, path_of(place_of(offset).own).string() + kWhat};
  return {ErrorCode::corrupt,
          file_at(offset).path().string() + kWhat + "; remove it, and run its task again"};
}

bool ScratchFile::claim(std::uint64_t offset, std::uint64_t bytes) {
  if (is_mounted(offset)) {
    const std::uint64_t place = offset & kOffsetMask;
    const std::uint64_t there = offset >> kPlaceBits > mounted_.size() ? 0 : file_at(offset).size();
    return place <= there && bytes <= there - place;
  }
  const Place place = place_of(offset);
  Own& own = own_[place.own];
  if (!own.file)
    return bytes == 0;
  const std::uint64_t there = own.file->size();
  if (place.offset > there || bytes > there - place.offset)
    return false;
  const std::uint64_t end = place.offset + bytes;
  if (end > own.size) {
    pool_.scratch_use().add_grown(end - own.size);
    own.size = end;
  }
  return true;
}

std::size_t ScratchFile::own_of_this_thread() const {
  static std::atomic<std::size_t> threads = 0;
  thread_local const std::size_t thread = threads++;
  return thread % own_.size();
}

std::uint64_t ScratchFile::append(std::span<const std::byte> bytes) {
  File* file = nullptr;
  std::uint64_t offset = 0;
  bool grows = false;
  {
    const std::lock_guard lock(mutex_);
    const auto free = free_.find(bytes.size());
    grows = free == free_.end() || free->second.empty();
    std::size_t own = 0;
    if (grows) {
      own = own_of_this_thread();
      if (!own_[own].file)
        own_[own].file = files_.create(path_of(own));
      offset = std::uint64_t{own} << kFileBits | own_[own].size;
      own_[own].size += bytes.size();
      require_room(own);
    } else {
      offset = free->second.back();
      free->second.pop_back();
      own = place_of(offset).own;
    }
    file = own_[own].file.get();
  }
  file->write_at(place_of(offset).offset, bytes);
  pool_.scratch_use().add_written(bytes.size());
  if (grows)
    pool_.scratch_use().add_grown(bytes.size());
  return offset;
}

/// Throws Error(io) if a file that has grown is larger than offsets can tell.
void ScratchFile::require_room(std::size_t own) const {
  const int bits = own_.size() == 1 ? kPlaceBits : kFileBits;
  if (own_[own].size > std::uint64_t{1} << bits) {
    throw Error(ErrorCode::io, fmt::format("{} would be larger than {} TiB", path_of(own).string(),
                                           std::uint64_t{1} << (bits - 40)));
  }
}

void ScratchFile::release(std::uint64_t offset, std::uint64_t bytes) {
  if (is_mounted(offset))
    return;
  const std::lock_guard lock(mutex_);
  free_[bytes].push_back(offset);
}

Spool::Spool(Spool&& other) noexcept
    : scratch_(other.scratch_),
      block_bytes_(other.block_bytes_),
      end_(std::exchange(other.end_, nullptr)),
      room_(std::exchange(other.room_, 0)),
      size_(std::exchange(other.size_, 0)),
      checksum_(std::exchange(other.checksum_, 0)),
      blocks_(std::move(other.blocks_)) {
  other.blocks_.clear();
}

void Spool::append_to_blocks(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (room_ == 0)
      open_block();
    const std::size_t count = std::min(bytes.size(), room_);
    std::memcpy(end_, bytes.data(), count);
    grow(count);
    bytes = bytes.subspan(count);
  }
}

/// Begins a block. The full one before is counted in the pool from now on; if that has no room, it
/// goes to disk, and the new block takes over its memory.
void Spool::open_block() {
  if (size_ > 0)
    checksum_ = checksum({blocks_.back().memory(), block_bytes_}, checksum_);
  if (size_ == 0 || scratch_->pool().try_take(block_bytes_)) {
    auto memory = std::make_unique_for_overwrite<std::byte[]>(block_bytes_);
    blocks_.push_back(Block::in_memory(memory.get()));
    memory.release();
  } else {
    std::byte* memory = blocks_.back().memory();
    const std::uint64_t offset = scratch_->append({memory, block_bytes_});
    blocks_.push_back(Block::in_memory(memory));
    blocks_[blocks_.size() - 2] = Block::on_disk(offset);
  }
  end_ = blocks_.back().memory();
  room_ = block_bytes_;
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

StoredSpool Spool::store() {
  StoredSpool stored{.bytes = size_, .checksum = 0, .block_bytes = block_bytes_, .blocks = {}};
  stored.blocks.reserve(blocks_.size());
  if (!blocks_.empty()) {  // the last one is in memory
    const std::size_t last = blocks_.size() - 1;
    checksum_ = checksum({blocks_[last].memory(), used_bytes(last)}, checksum_);
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    Block& block = blocks_[i];
    if (!block.is_on_disk()) {
      const std::unique_ptr<std::byte[]> memory(block.memory());
      block = Block::on_disk(0);  // whatever happens now, it is not in memory
      if (i + 1 < blocks_.size())
        scratch_->pool().give_back(block_bytes_);
      block = Block::on_disk(scratch_->append({memory.get(), used_bytes(i)}));
    }
    stored.blocks.push_back(block.offset());
  }
  end_ = nullptr;
  room_ = 0;
  stored.checksum = checksum_;
  return stored;
}

bool Spool::restore(const StoredSpool& stored) {
  const std::uint64_t block = stored.block_bytes;
  if (block == 0 || stored.blocks.size() != stored.bytes / block + (stored.bytes % block > 0))
    return false;
  block_bytes_ = block;
  size_ = stored.bytes;
  checksum_ = stored.checksum;
  for (const std::uint64_t offset : stored.blocks)
    blocks_.push_back(Block::on_disk(scratch_->placed(offset)));
  return true;
}

bool Spool::is_as_stored() const {
  std::uint64_t sum = 0;
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    bytes.resize(used_bytes(i));
    if (!scratch_->claim(blocks_[i].offset(), bytes.size()))
      return false;
    read(i * block_bytes_, bytes);
    sum = checksum(bytes, sum);
  }
  return sum == checksum_;
}

std::size_t Spool::used_bytes(std::size_t block) const {
  return std::min<std::uint64_t>(block_bytes_, size_ - block * block_bytes_);
}

void Spool::clear() {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].is_on_disk()) {
      scratch_->release(blocks_[i].offset(), used_bytes(i));
      continue;
    }
    delete[] blocks_[i].memory();
    if (i + 1 < blocks_.size())
      scratch_->pool().give_back(block_bytes_);
  }
  blocks_ = {};
  end_ = nullptr;
  room_ = 0;
  size_ = 0;
  checksum_ = 0;
}

}  // namespace meshhier::storage
