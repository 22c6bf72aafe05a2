// The JSON of one tileset (OGC, 3D Tiles 1.0 and 1.1) as a list of its tiles.
#pragma once

#include "base/vec.h"
#include "mesh_io/gltf_transform.h"
#include "mesh_io/subtree.h"
#include "mesh_io/tile_volume.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// The children of a tile take its place, or are shown beside it.
enum class Refine : std::uint8_t { inherited, replace, add };

/// A content that a tile names.
struct TileContentName {
  std::optional<std::string> uri;  ///< none: an error, if it is looked for
  std::uint32_t tile = 0;          ///< number of the tile
  std::string place;               ///< in the tile: ".content"
};

struct TilesetTile {
  std::optional<std::uint32_t> parent{};  ///< none: the root
  std::uint32_t number = 0;               ///< among the children of its parent
  Refine refine = Refine::inherited;
  bool is_leaf = true;
  GltfTransform transform{};  ///< to the parent's coordinates
  std::optional<TileVolume> volume{};
  std::uint32_t first_content = 0, end_content = 0;  ///< range of TilesetDocument::contents
};

/// A tile that stands for a tree of tiles (implicit_tiles.h).
struct ImplicitTiling {
  std::uint32_t tile = 0;  ///< number of the tile, whose contents are templates of names
  SubtreeShape shape;
  std::uint32_t levels = 1;  ///< levels that there may be tiles on
  std::string subtrees;      ///< template of the names of subtrees
  std::optional<VolumeNumbers> volume{};
};

struct TilesetDocument {
  std::filesystem::path path;
  std::vector<TilesetTile> tiles{};  ///< parents first, in the order of the document
  std::vector<ImplicitTiling> implicit{};
  std::vector<TileContentName> contents{};
  GltfTransform axes{};       ///< from the axes of a glTF to those of 3D Tiles
  bool is_hierarchy = false;  ///< a build made it
  GltfTransform origin{};     ///< the move that the root's transform of a hierarchy does first
};

/// Returns the root's transform from the input's coordinates: without the move by the origin.
GltfTransform from_input(const TilesetDocument& document);

/// Returns "root.children[3].content", for messages.
std::string place_of(const TilesetDocument& document, const TileContentName& content);

/// Reads a document, packed by gzip or not. `most_bytes`: memory for its JSON. Throws Error(input)
/// naming file and place if it is no tileset or if its values are not as the specification says;
/// Error(budget), Error(io).
TilesetDocument read_tileset_document(const storage::File& file, std::uint64_t most_bytes);

}  // namespace meshhier::mesh_io
