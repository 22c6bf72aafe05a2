// All documents and contents of a tileset, each of which is read once however often it is named.
#pragma once

#include "mesh_io/globe_frame.h"
#include "mesh_io/tile_file.h"
#include "mesh_io/tileset_document.h"
#include "mesh_io/tileset_room.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::mesh_io {

/// The most memory for contents that documents hold as data.
inline constexpr std::uint64_t kMostTileData = std::uint64_t{64} << 20;

/// A content that tiles show: a file, or data that a document holds.
struct TileContent {
  std::filesystem::path file;  ///< the document, if it is data
  std::shared_ptr<const std::vector<std::byte>> data{};
  TileFile tile;
  std::optional<std::uint32_t> document{};  ///< number of the document of an external tileset
};

/// A content where a tile shows it.
struct ShownContent {
  const TileContent& content;
  const TilesetTile& tile;
  const GltfTransform& axes;
  const GltfTransform& to_globe;   ///< from the tile's coordinates to the tileset's
  const GltfTransform& placement;  ///< from the tile's coordinates to the frame's
};

/// The documents of a tileset and their contents. Reading is done by the constructor; for_each() is
/// thread-safe.
class TilesetTree {
 public:
  /// Reads the documents, and the headers of the contents that are shown. Throws as
  /// read_tileset().
  TilesetTree(storage::FileSystem& files, const std::filesystem::path& path,
              const TilesetRoom& room);

  const TilesetDocument& root() const { return documents_[0].document; }
  /// Returns the files of external tilesets, but for those that are data, and of subtrees.
  const std::vector<std::filesystem::path>& external() const { return external_; }

  using Visit = std::function<void(const ShownContent&)>;
  /// Visits the contents that are shown, in the order of the documents, and calls `coarser` for
  /// each content that finer tiles replace. A tile whose coordinates are the frame's is placed
  /// there exactly.
  void for_each(const std::optional<GlobeFrame>& frame, const Visit& visit,
                const std::function<void()>& coarser) const;

 private:
  /// A document, with the numbers of its contents that are shown.
  struct Part {
    TilesetDocument document;
    std::vector<std::optional<std::uint32_t>> contents;
  };
  /// The size of a document with all that it names.
  struct Size {
    std::uint64_t tiles = 0;  ///< with those of the documents that it names
    std::size_t levels = 0;   ///< documents within each other
    bool is_open = true;      ///< being counted
  };
  /// The placement of a tile.
  struct Stand {
    GltfTransform to_globe, placement;
    bool adds = false;
  };
  using SizeKey = std::pair<std::uint32_t, bool>;

  Size size_of(std::uint32_t document, bool parent_adds, std::size_t level);
  std::uint32_t add_document(const storage::File& file);
  std::uint32_t content_of(std::uint32_t document, std::uint32_t content);
  std::uint32_t add_content(TileContent content, const storage::File& file);
  TileContent data_content(const Part& part, const TileContentName& name, std::string_view base64);
  void add_implicit_tiles(TilesetDocument& document);
  /// Returns the file that a URI names from a folder; `document` and `place`: where it stands.
  std::filesystem::path file_of(const std::filesystem::path& document,
                                const std::filesystem::path& folder, const std::string& uri,
                                const std::string& place) const;
  /// Returns a file below the place of all; nothing if there is none.
  std::optional<std::filesystem::path> find_file(const std::filesystem::path& folder,
                                                 const std::string& uri) const;
  bool is_below_place(const std::filesystem::path& path) const;
  static Stand stand_of(const TilesetDocument& document, const TilesetTile& tile,
                        const Stand& parent, const std::optional<GlobeFrame>& frame);
  void walk(std::uint32_t document, const Stand& parent, const std::optional<GlobeFrame>& frame,
            const Visit& visit, const std::function<void()>& coarser) const;

  storage::FileSystem& files_;
  std::filesystem::path place_;
  TilesetRoom room_;
  std::uint64_t data_bytes_ = 0;
  std::uint64_t read_ = 0;       ///< tiles and contents of the documents
  std::vector<Part> documents_;  ///< the root first
  std::vector<TileContent> contents_;
  std::map<std::filesystem::path, std::uint32_t> known_;  ///< contents by their files
  std::map<SizeKey, Size> sizes_;
  std::vector<std::filesystem::path> external_;
};

}  // namespace meshhier::mesh_io
