// Objects that lie side by side in objects.bin, before they are packed (docs/file_format.md).
#pragma once

#include "hierarchy/object_row.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// A block has so many objects at most.
inline constexpr std::size_t kMostBlockObjects = 256;
/// Their names and texts have so many bytes at most, unless it is one object only.
inline constexpr std::size_t kMostBlockTextBytes = std::size_t{64} * 1024;
/// More than any block has, unpacked.
inline constexpr std::size_t kMostObjectBlockBytes =
    kMostObjectTextBytes + kMostBlockObjects * (128 + 16 * kMostObjectProperties);

/// Returns the bytes of a block. Requires values of the properties' types.
std::vector<std::byte> encode_object_block(std::span<const ObjectRow> rows,
                                           std::span<const ObjectProperty> properties);

/// Parses a block of `count` objects that nobody vouches for. Throws Error(corrupt) that starts
/// with `name`.
std::vector<ObjectRow> decode_object_block(std::span<const std::byte> bytes, std::size_t count,
                                           std::span<const ObjectProperty> properties,
                                           const std::string& name);

}  // namespace meshhier::storage
