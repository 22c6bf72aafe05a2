#include "mesh_io/decoded_blocks.h"

namespace meshhier::mesh_io {

std::size_t DecodedBlocks::Hash::operator()(const Key& key) const {
  constexpr std::uint64_t kGoldenRatio = 0x9e3779b97f4a7c15;  // Fibonacci hashing, Knuth 6.4
  return std::hash<const void*>()(key.first) ^ static_cast<std::size_t>(key.second * kGoldenRatio);
}

DecodedBlocks::Block DecodedBlocks::get(const Source& source, std::uint64_t block,
                                        std::uint64_t end) {
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto found = places_.find({source.raster, block});
    if (found == places_.end())
      return decode(lock, source, block);
    if (found->second->block != nullptr) {
      entries_.splice(entries_.begin(), entries_, found->second);
      return found->second->block;
    }
    std::uint64_t next = block + 1;
    while (next < end && places_.contains({source.raster, next}))
      ++next;
    if (next < end && held_bytes_ + source.block_bytes <= most_bytes_)
      decode(lock, source, next);
    else
      decoded_.wait(lock);
  }
}

void DecodedBlocks::clear() {
  const std::lock_guard lock(mutex_);
  places_.clear();
  entries_.clear();
  held_bytes_ = 0;
}

DecodedBlocks::Block DecodedBlocks::decode(std::unique_lock<std::mutex>& lock, const Source& source,
                                           std::uint64_t block) {
  make_room(source.block_bytes);
  entries_.push_front({{source.raster, block}, source.block_bytes, nullptr});
  const auto entry = entries_.begin();
  places_.emplace(entry->key, entry);
  held_bytes_ += entry->bytes;
  lock.unlock();
  Block made;
  try {
    auto bytes = std::make_shared<Bytes>(source.block_bytes);
    source.decode(block, *bytes);
    made = std::move(bytes);
  } catch (...) {
    lock.lock();
    erase(entry);
    decoded_.notify_all();
    throw;
  }
  lock.lock();
  entry->block = made;
  decoded_.notify_all();
  return made;
}

/// Drops the oldest ones; blocks that are being decoded stay.
void DecodedBlocks::make_room(std::uint64_t bytes) {
  for (auto one = entries_.end(); held_bytes_ + bytes > most_bytes_ && one != entries_.begin();) {
    --one;
    if (one->block != nullptr)
      erase(one++);
  }
}

void DecodedBlocks::erase(Entries::iterator entry) {
  held_bytes_ -= entry->bytes;
  places_.erase(entry->key);
  entries_.erase(entry);
}

}  // namespace meshhier::mesh_io
