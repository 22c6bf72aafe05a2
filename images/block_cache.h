// A cache of the blocks of texels that were read lately.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace meshhier::images {

/// Keeps blocks by keys; the least recently used ones go first. Thread-safe: keys are spread over
/// parts with a lock each.
class BlockCache {
 public:
  /// `most_bytes`: memory for blocks, and for their places in list and table.
  explicit BlockCache(std::uint64_t most_bytes);

  /// Calls `use` with the block's bytes; returns false if the block is not there. `use` must be
  /// quick: other threads wait.
  template <class Use>
  bool use(std::uint64_t key, const Use& use) {
    Part& part = part_of(key);
    const std::lock_guard lock(part.mutex);
    const std::byte* block = part.find(key);
    if (block != nullptr)
      use(block);
    return block != nullptr;
  }

  /// Keeps the block, unless it is there or larger than all room.
  void put(std::uint64_t key, std::vector<std::byte> block);

 private:
  struct Block {
    std::uint64_t key = 0;
    std::vector<std::byte> bytes;
  };
  struct Part {
    /// Returns null if the block is not there; else the block becomes the last to go.
    const std::byte* find(std::uint64_t key);
    void put(std::uint64_t key, std::vector<std::byte> bytes, std::uint64_t most_bytes);
    void drop_oldest();

    std::mutex mutex;         ///< guards the members below
    std::list<Block> blocks;  ///< the one used last comes first
    std::unordered_map<std::uint64_t, std::list<Block>::iterator> places;
    std::uint64_t held_bytes = 0;
  };
  Part& part_of(std::uint64_t key);

  std::size_t part_count_;
  std::uint64_t most_bytes_of_part_;
  std::unique_ptr<Part[]> parts_;
};

}  // namespace meshhier::images
