// A tileset of 3D Tiles (OGC, 1.0 and 1.1) as meshes: the finest tile of each place, and where it
// stands.
//
// Coordinates are z-up, in metres. Those of a tileset on the globe, where tiles have six digits
// before the point and no axis is up, are turned into a local frame: east, north, up.
#pragma once

#include "mesh_io/formats.h"
#include "mesh_io/globe_frame.h"
#include "mesh_io/gltf_transform.h"
#include "mesh_io/tile_file.h"
#include "mesh_io/tileset_room.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the local frame of a tileset: the transform of the root, if it is such a frame; else the
/// frame at the middle of the root's bounding volume, rounded to metres. A volume as large as the
/// globe or a continent says little: then the tiles that are shown decide, by the transform of all,
/// if it is such a frame, else by the middle of their places. Nothing if that does not lie on the
/// globe. Throws as read_tileset().
std::optional<GlobeFrame> globe_frame(storage::FileSystem& files, const std::filesystem::path& path,
                                      const TilesetRoom& room);

/// A tile's glTF.
struct TilesetMesh {
  std::filesystem::path file;
  MeshFormat format;
  /// The glTF's place in the file, or in its content if that is gzip.
  std::uint64_t offset = 0, bytes = 0;
  GltfTransform placement;  ///< from the coordinates of its scene to the frame's
  MeshOutline outline{};
  /// The bytes that stand for the file, if it holds the tile as a data URI.
  std::shared_ptr<const std::vector<std::byte>> data{};
  BatchTablePlace batch{};
};

struct Tileset {
  std::vector<TilesetMesh> meshes;               ///< in the order of the document
  std::vector<std::filesystem::path> documents;  ///< of external tilesets and subtrees
  std::optional<GlobeFrame> frame;               ///< none: coordinates are those of the tileset
  bool is_hierarchy = false;                     ///< a build made it
  std::uint64_t coarser = 0;                     ///< contents that finer ones replace
  std::uint64_t instanced = 0, points = 0, vectors = 0;  ///< tiles that are no meshes
};

/// Reads the tileset and all external ones, and the headers of tiles, each once. Tiles that refine
/// by replacement are taken if they have no children, all others always; a tile, and the root of an
/// external tileset, that says nothing refines as its parent. Contents are files below the folder
/// of `path`, packed by gzip or not, or data URIs. `frame`: that of another tileset, so that both
/// stand in one; null: its own, as globe_frame() returns it.
/// Throws Error(input) naming file and place if a document is no tileset, if a subtree
/// of implicit tiles is missing or broken, if a content is on the web, not there or no tile, if
/// tilesets hold each other, or if they have more tiles than there is room for; Error(budget),
/// Error(io).
Tileset read_tileset(storage::FileSystem& files, const std::filesystem::path& path,
                     const std::optional<GlobeFrame>* frame, const TilesetRoom& room);

}  // namespace meshhier::mesh_io
