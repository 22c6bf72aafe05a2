// The directory of objects.bin: where each block is, and which objects are in it
// (docs/file_format.md).
#pragma once

#include "hierarchy/object_row.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// A block's key is the name of its first object, of a longer one its first so many bytes: so the
/// directory stays small whatever the names are.
inline constexpr std::size_t kMostKeyBytes = 255;
/// More than any directory has, unpacked: 2^24 objects in blocks of 64 take half of it at most.
inline constexpr std::size_t kMostDirectoryBytes = std::size_t{256} << 20;

/// Objects that lie in one block.
struct ObjectBlock {
  std::uint64_t offset = 0;    ///< in the file; follows from the blocks before
  std::uint32_t bytes = 0;     ///< in the file
  std::uint32_t unpacked = 0;  ///< bytes
  std::uint32_t first = 0;     ///< object; follows from the blocks before
  std::uint32_t count = 0;     ///< objects
  std::uint64_t checksum = 0;  ///< XXH3-64 of its bytes in the file
  std::string key;
  friend bool operator==(const ObjectBlock&, const ObjectBlock&) = default;
};

struct ObjectDirectory {
  std::vector<ObjectProperty> properties;
  std::vector<ObjectBlock> blocks;

  std::uint32_t objects() const {
    return blocks.empty() ? 0 : blocks.back().first + blocks.back().count;
  }
};

std::string_view key_of(std::string_view name);

/// Returns the bytes of a directory, not packed.
std::vector<std::byte> encode_object_directory(const ObjectDirectory& directory);

/// Parses a directory that nobody vouches for, whose blocks fill the file from `offset` up to
/// `end`. Throws Error(corrupt) that starts with `name`.
ObjectDirectory decode_object_directory(std::span<const std::byte> bytes, std::uint64_t offset,
                                        std::uint64_t end, const std::string& name);

}  // namespace meshhier::storage
