// tiles.bin: one fixed-size record a tile, ordered by level, then index (docs/file_format.md).
#pragma once

#include "hierarchy/published.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// `records`: one for each of tree.tile_nodes(), in that order.
std::vector<std::byte> encode_index(std::span<const TileRecord> records);

/// Checks version, length, checksum, order, and that exactly the tree's tiles are there. Throws
/// Error(corrupt).
std::vector<TileRecord> decode_index(std::span<const std::byte> bytes, const Tree& tree,
                                     const std::string& name);

/// One record as it is in the index: 120 bytes.
std::vector<std::byte> encode_record(const TileRecord& record);
/// The inverse. Throws Error(corrupt) if `bytes` has another size or names no level.
TileRecord decode_record(std::span<const std::byte> bytes);

/// Bytes of its index, or of the beginning of one with so many records.
std::uint64_t index_bytes(const Tree& tree);
std::uint64_t index_bytes(std::uint64_t records);

/// The record of `node`, which has a tile, among all of a tree's, ascending by node. O(log n).
const TileRecord& record_of(std::span<const TileRecord> records, NodeId node);

}  // namespace meshhier::storage
