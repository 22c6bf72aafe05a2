// A tile as a glTF 2.0 binary with the extension MESHHIER_tile (docs/file_format.md).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "hierarchy/attributes.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "hierarchy/vec.h"

namespace meshhier::storage {

/// What all tiles of a hierarchy share.
struct TileFormat {
  AttributeLayout attributes;
  bool unit_normals = true;  ///< all input normals have unit length; else partitions store them in _NORMAL too
  Vec3d origin;              ///< added to every position (the node's translation); 0 for float input
};

/// Deterministic, O(size). Requires a consistent tile (see PublishedTile).
std::vector<std::byte> encode_tile(const PublishedTile& tile, const Tree& tree, const TileFormat& format);

/// The inverse of encode_tile, on bytes nobody vouches for: every count, offset and index is checked
/// before it is used. Throws Error(corrupt) that starts with `name` and says what was expected.
PublishedTile decode_tile(std::span<const std::byte> bytes, NodeId node, const Tree& tree, const TileFormat& format,
                          const std::string& name);

}  // namespace meshhier::storage
