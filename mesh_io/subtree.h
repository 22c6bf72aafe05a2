// Subtrees of implicit tiles (OGC, 3D Tiles 1.1, "Implicit Tiling"; of 1.0:
// 3DTILES_implicit_tiling).
//
// Problem. A tileset of a million tiles lists none of them: a tree is regular, and files of bits
// say which of its tiles there are.
//
// Idea. A subtree covers some levels below its root. Its bits stand level by level, those of a
// level along the Z-order curve, on which the children of tile i are the N from N * i on:
//
//       level 0            bit 0                   N = 4: a quadtree, whose children stand as
//       level 1            bits 1 ... 4                 2 3
//       level 2            bits 5 ... 20                0 1
//       child subtrees     bits of their own, as of the level below the last
//
// A file is JSON, or JSON with the bits behind it, little endian:
//
//       0  "subt", version 1 u32, bytes of the JSON u64, bytes behind it u64; the JSON; these bytes
//
// Cost. Only the bits are read, not the metadata in other views: 16 MiB at most of each kind.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// The most bits of one kind; a quadtree of 13 levels below the root has as many tiles.
inline constexpr std::uint64_t kMostAvailabilityBits = std::uint64_t{1} << 27;

/// The form of a tree of implicit tiles.
struct SubtreeShape {
  bool is_octree = false;
  std::uint32_t levels = 1;  ///< levels of a subtree, 1 or more

  std::uint32_t children() const { return is_octree ? 8 : 4; }
  /// Returns the tiles of a level, which are the child subtrees for `level == levels`.
  std::uint64_t tiles_of(std::uint32_t level) const {
    return std::uint64_t{1} << ((is_octree ? 3 : 2) * level);
  }
  /// Returns the bits before those of a level.
  std::uint64_t first_of(std::uint32_t level) const {
    return (tiles_of(level) - 1) / (children() - 1);
  }
};

/// Bits that are stored, or all the same.
class Availability {
 public:
  explicit Availability(bool constant = false) : constant_(constant) {}
  explicit Availability(std::vector<std::byte> bits) : bits_(std::move(bits)) {}

  bool at(std::uint64_t index) const {
    if (bits_.empty())
      return constant_;
    return (std::to_integer<unsigned>(bits_[index / 8]) >> (index % 8) & 1U) != 0;
  }

 private:
  std::vector<std::byte> bits_;
  bool constant_ = false;
};

struct Subtree {
  Availability tiles;
  std::vector<Availability> contents;  ///< of each of a tile's contents
  Availability children;               ///< child subtrees
};

/// Opens a file that a URI names from a folder; `place`: where the URI stands, for messages.
using OpenNamed = std::function<std::unique_ptr<storage::File>(
    const std::filesystem::path& folder, const std::string& uri, const std::string& place)>;

/// Reads a subtree, packed by gzip or not. `most_contents`: of a tile; `most_bytes`: memory for its
/// JSON, and for its bits. Throws Error(input) naming file and place if it is none, has fewer bits
/// than `shape` asks for, or tells of more contents; Error(budget), Error(io), and what `open`
/// throws. Requires up to kMostAvailabilityBits by shape.
Subtree read_subtree(const storage::File& file, const SubtreeShape& shape,
                     std::size_t most_contents, std::uint64_t most_bytes, const OpenNamed& open);

}  // namespace meshhier::mesh_io
