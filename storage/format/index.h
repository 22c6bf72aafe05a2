// tiles.bin: one fixed-size record a tile, ordered by level, then index (docs/file_format.md).
#pragma once

#include "hierarchy/published.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Returns the file's bytes. `records`: one for each of tree.tile_nodes(), in that order.
std::vector<std::byte> encode_index(std::span<const TileRecord> records);

/// Parses an index that nobody vouches for: checks version, length, checksum, order, that exactly
/// the tree's tiles are there, and that each record is sound. Throws Error(corrupt) that starts
/// with `name`.
std::vector<TileRecord> decode_index(std::span<const std::byte> bytes, const Tree& tree,
                                     const std::string& name);

/// Returns a record as it is in the index: 120 bytes.
std::vector<std::byte> encode_record(const TileRecord& record);
/// Parses such a record. Throws Error(corrupt) if `bytes` has another size or names no level.
TileRecord decode_record(std::span<const std::byte> bytes);

/// These return the bytes of a tree's index, and of the beginning of an index with so many records.
std::uint64_t index_bytes(const Tree& tree);
std::uint64_t index_bytes(std::uint64_t records);

/// Returns the record of `node`. Requires that it has a tile. `records`: all of a tree's, ascending
/// by node. O(log n).
const TileRecord& record_of(std::span<const TileRecord> records, NodeId node);

}  // namespace meshhier::storage
