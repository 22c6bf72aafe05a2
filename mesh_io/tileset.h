// A tileset of 3D Tiles (OGC, 1.0 and 1.1) as meshes: the finest tile of each place, and where it
// stands.
//
// Coordinates are z-up, in metres. Those of a tileset on the globe, where tiles have six digits
// before the point and no axis is up, are turned into a local frame: east, north, up.
#pragma once

#include "mesh_io/formats.h"
#include "mesh_io/globe_frame.h"
#include "mesh_io/gltf_transform.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// Memory that the JSON of a tileset may take: 30 MB of text, a hundred thousand tiles.
inline constexpr std::uint64_t kTilesetBytes = std::uint64_t{256} << 20;

/// The transform of the root, if it is such a frame; else that of the middle of the root's bounding
/// volume, rounded to metres. Where that volume says little, as it is of the globe or a continent,
/// the tiles that are shown decide: the transform of all, if it is such a frame, else the middle of
/// their places. Nothing if that does not lie on the globe. Throws as read_tileset().
std::optional<GlobeFrame> globe_frame(storage::FileSystem& files, const std::filesystem::path& path,
                                      std::uint64_t most_bytes);

/// A glTF of a tile.
struct TilesetMesh {
  std::filesystem::path file;
  MeshFormat format;
  std::uint64_t offset = 0, bytes = 0;  ///< of the glTF in the file, or in what it holds in gzip
  GltfTransform placement;              ///< from the coordinates of its scene to the frame's
  /// What stands for the file: it holds the tile as a data URI.
  std::shared_ptr<const std::vector<std::byte>> data{};
};

struct Tileset {
  std::vector<TilesetMesh> meshes;               ///< in the order of the document
  std::vector<std::filesystem::path> documents;  ///< of external tilesets, each once
  std::optional<GlobeFrame> frame;               ///< none: coordinates are those of the tileset
  bool is_hierarchy = false;                     ///< one that a build made
  std::uint64_t coarser = 0;                     ///< contents that finer ones replace
  std::uint64_t instanced = 0, points = 0;       ///< tiles that are no meshes
};

/// Reads the tileset and all external ones, and the headers of tiles, each once. Of tiles that
/// refine by replacement those without children are taken, of others all; a tile, and the root of
/// an external tileset, that says nothing refines as its parent. Contents are files below the
/// folder of `path`, packed by gzip or not, or data URIs. `frame`: of another tileset, for both;
/// null: its own, as globe_frame() has it. `most_bytes`: memory for a JSON. Throws Error(input)
/// naming file and place if a document is no tileset, if tiles are implicit, if a content is on the
/// web, not there or no tile, if tilesets hold each other, or if they have more than kMostTiles
/// tiles; Error(budget), Error(io).
Tileset read_tileset(storage::FileSystem& files, const std::filesystem::path& path,
                     const std::optional<GlobeFrame>* frame, std::uint64_t most_bytes);

}  // namespace meshhier::mesh_io
