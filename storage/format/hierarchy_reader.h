// Read access to a finished hierarchy.
#pragma once

#include "hierarchy/outline.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/manifest.h"
#include "storage/format/tile_glb.h"
#include "storage/io/file.h"

#include <filesystem>
#include <span>
#include <vector>

namespace meshhier::storage {

/// Every failure throws Error: io if a file is missing or unreadable, corrupt if its size, checksum
/// or content is wrong; the message names the file. Thread-safe once constructed, as far as `files`
/// is, which must outlive it.
class HierarchyReader {
 public:
  /// Reads manifest and index.
  HierarchyReader(FileSystem& files, std::filesystem::path directory);

  const std::filesystem::path& directory() const { return directory_; }
  const Manifest& manifest() const { return manifest_; }
  const Tree& tree() const { return tree_; }
  const TileFormat& tile_format() const { return format_; }

  /// Ascending by node.
  const std::vector<TileRecord>& records() const { return records_; }
  /// Of the tile that stands for the node (Tree::tile_node). Requires tree().contains(node).
  const TileRecord& record(NodeId node) const;

  /// These tiles will be read soon, in that order: a hint.
  void will_read(std::span<const NodeId> nodes) const;
  /// Reads one tile, checks its size and checksum, and that its counts are those of the index.
  PublishedTile read_tile(NodeId node) const;
  /// Reads the outline, checks its size and checksum.
  Outline read_outline() const;
  /// Reads the preview, checks its size and checksum; does not decode it. Requires that the
  /// manifest names one.
  std::vector<std::byte> read_preview() const;

 private:
  FileSystem& files_;
  std::filesystem::path directory_;
  Manifest manifest_;
  Tree tree_;
  TileFormat format_;
  std::vector<TileRecord> records_;
};

}  // namespace meshhier::storage
