// Read access to a finished hierarchy.
#pragma once

#include "hierarchy/outline.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/manifest.h"
#include "storage/format/tile_glb.h"
#include "storage/io/file.h"

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::storage {

/// Reads the files of one hierarchy, all of the build that it was opened with. Every failure throws
/// Error: io if a file is missing or unreadable, or if another build has taken the hierarchy's
/// place meanwhile; corrupt if a size, checksum or content is wrong; the message names the file.
/// Thread-safe once constructed, as far as `files` is, which must outlive it.
class HierarchyReader {
 public:
  /// Reads manifest and index. `directory` may be an archive's path if `files` reads it so
  /// (HierarchyFiles). Holds the records: O(tiles) memory.
  HierarchyReader(FileSystem& files, std::filesystem::path directory);

  const std::filesystem::path& directory() const { return directory_; }
  const Manifest& manifest() const { return manifest_; }
  const Tree& tree() const { return tree_; }
  const TileFormat& tile_format() const { return format_; }

  /// All records, ascending by node.
  const std::vector<TileRecord>& records() const { return records_; }
  /// Returns the record of the tile that stands for the node (Tree::tile_node). Requires
  /// tree().contains(node). O(log n).
  const TileRecord& record(NodeId node) const;

  /// A hint: these tiles will be read soon, in that order.
  void will_read(std::span<const NodeId> nodes) const;
  /// Reads the tile that stands for the node, checks its size and checksum, that its content is
  /// sound (decode_tile()), and that its counts are those of the index. Requires
  /// tree().contains(node).
  PublishedTile read_tile(NodeId node) const;
  /// Reads the outline, checks its size, checksum and content.
  Outline read_outline() const;
  /// Opens the table of objects, which is that of the manifest. Throws Error(usage) if there are no
  /// objects.
  std::unique_ptr<ObjectTable> open_objects() const;
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
