// The blocks of a raster that were decoded lately, for threads that read rows next to each other.
//
// Problem. Rows come one after another, blocks are tiles: each is needed by many reads of several
// threads, and all that read a row begin with the same tile.
// Idea. A block is decoded by the first thread that wants it. Another one that wants it meanwhile
// decodes one of those that come next in the row, instead of waiting.
//
//     thread 1: row 7  [0 decodes][2 .....          blocks of a row: 0 1 2 3 4 5
//     thread 2: row 8  [1 decodes][0 is there][1][2 waits ...
//
// Invariant. At most `most_bytes` are held, besides what threads are using.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace meshhier::mesh_io {

/// Thread-safe.
class DecodedBlocks {
 public:
  using Bytes = std::vector<std::byte>;
  using Block = std::shared_ptr<const Bytes>;

  /// Blocks of one raster. A raster gives them as long as its blocks may be held.
  struct Source {
    const void* raster = nullptr;  ///< tells rasters apart
    std::uint64_t block_bytes = 0;
    std::function<void(std::uint64_t block, std::span<std::byte> into)> decode;
  };

  explicit DecodedBlocks(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// Returns a block. `end`: the blocks from it up to here will be wanted next. Throws what
  /// decoding throws.
  Block get(const Source& source, std::uint64_t block, std::uint64_t end);
  /// Lets go of all blocks. No thread may read meanwhile.
  void clear();

 private:
  using Key = std::pair<const void*, std::uint64_t>;
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  struct Entry {
    Key key;
    std::uint64_t bytes = 0;
    Block block;  ///< null while it is decoded
  };
  using Entries = std::list<Entry>;

  Block decode(std::unique_lock<std::mutex>& lock, const Source& source, std::uint64_t block);
  void make_room(std::uint64_t bytes);
  void erase(Entries::iterator entry);

  std::uint64_t most_bytes_;
  std::mutex mutex_;  ///< guards the members below
  std::condition_variable decoded_;
  Entries entries_;  ///< the one used last comes first
  std::unordered_map<Key, Entries::iterator, Hash> places_;
  std::uint64_t held_bytes_ = 0;
};

}  // namespace meshhier::mesh_io
