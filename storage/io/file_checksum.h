// The checksum of a large file, put together while other work reads the file.
#pragma once

#include "storage/io/file.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::storage {

/// The XXH3-64s of some consecutive blocks of a FileChecksum.
struct BlockSums {
  std::uint64_t first = 0;  ///< block
  std::vector<std::uint64_t> sums;
};

/// XXH3-64 over the XXH3-64s, 8 bytes each, little endian, of the file's consecutive blocks of
/// kBlockBytes (the last one may be shorter; an empty file has none). Blocks are independent of
/// each other, so they can come from several threads and in any order.
class FileChecksum {
 public:
  /// Small enough that most reads hold whole blocks, large enough that 10 bytes for each do not
  /// weigh: 1 MiB for 26 GiB.
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

  explicit FileChecksum(std::uint64_t file_bytes);

  /// Takes the blocks that lie within `bytes`, read at `offset`, unless they are known.
  /// Thread-safe.
  void add(std::uint64_t offset, std::span<const std::byte> bytes);

  /// Returns all blocks that are known, in ascending runs; for add(), in another process even. No
  /// thread may add meanwhile.
  std::vector<BlockSums> known() const;
  /// Takes what known() returned. Returns false, and takes nothing, if the file has no such blocks.
  bool add(const BlockSums& sums);

  /// Reads the blocks that are not known yet and returns the checksum. `check` is called before
  /// each read and may throw. Throws Error(io). No thread may add meanwhile.
  std::uint64_t complete(const File& file, const std::function<void()>& check);

  /// Returns the number of blocks that are not known yet.
  std::uint64_t missing() const;

 private:
  std::size_t block_bytes(std::size_t block) const;

  std::uint64_t file_bytes_;
  std::vector<std::uint64_t> sums_;
  std::vector<std::atomic<bool>> known_;
};

}  // namespace meshhier::storage
