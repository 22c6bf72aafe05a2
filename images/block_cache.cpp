#include "images/block_cache.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace meshhier::images {
namespace {

constexpr std::uint64_t kMostParts = 16;
/// A part has room for dozens of blocks.
constexpr std::uint64_t kLeastBytesOfPart = 1 << 20;
/// The memory of a block besides its texels: its places in list and table, and the allocator's own.
constexpr std::uint64_t kBytesBeside = 160;

std::uint64_t cost(std::size_t block_bytes) {
  return block_bytes + kBytesBeside;
}

}  // namespace

BlockCache::BlockCache(std::uint64_t most_bytes)
    : part_count_(std::clamp<std::uint64_t>(most_bytes / kLeastBytesOfPart, 1, kMostParts)),
      most_bytes_of_part_(most_bytes / part_count_),
      parts_(std::make_unique<Part[]>(part_count_)) {}

BlockCache::Part& BlockCache::part_of(std::uint64_t key) {
  constexpr std::uint64_t kGoldenRatio = 0x9e3779b97f4a7c15;  // Fibonacci hashing, Knuth 6.4
  return parts_[(key * kGoldenRatio >> 32) % part_count_];
}

void BlockCache::put(std::uint64_t key, std::vector<std::byte> block) {
  Part& part = part_of(key);
  const std::lock_guard lock(part.mutex);
  part.put(key, std::move(block), most_bytes_of_part_);
}

const std::byte* BlockCache::Part::find(std::uint64_t key) {
  const auto found = places.find(key);
  if (found == places.end())
    return nullptr;
  blocks.splice(blocks.begin(), blocks, found->second);
  return found->second->bytes.data();
}

void BlockCache::Part::put(std::uint64_t key, std::vector<std::byte> bytes,
                           std::uint64_t most_bytes) {
  if (cost(bytes.size()) > most_bytes || places.contains(key))
    return;
  while (held_bytes + cost(bytes.size()) > most_bytes)
    drop_oldest();
  held_bytes += cost(bytes.size());
  blocks.push_front({key, std::move(bytes)});
  places.emplace(key, blocks.begin());
}

void BlockCache::Part::drop_oldest() {
  held_bytes -= cost(blocks.back().bytes.size());
  places.erase(blocks.back().key);
  blocks.pop_back();
}

}  // namespace meshhier::images
