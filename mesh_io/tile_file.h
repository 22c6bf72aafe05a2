// The content of a tileset's file (OGC, 3D Tiles 1.0 and 1.1): a glTF, one within a b3dm, or
// several tiles within a cmpt.
#pragma once

#include "base/vec.h"
#include "mesh_io/formats.h"
#include "storage/io/file.h"

#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {

/// The place of a b3dm's batch table in its file.
struct BatchTablePlace {
  std::uint64_t json = 0, json_bytes = 0, binary_bytes = 0;  ///< the binary part stands behind
  std::uint64_t rows = UINT64_MAX;                           ///< at most, of the binary part
  friend bool operator==(const BatchTablePlace&, const BatchTablePlace&) = default;
};

/// A glTF within a file.
struct TileGltf {
  MeshKind kind{};                      ///< gltf, glb or b3dm
  std::uint64_t offset = 0, bytes = 0;  ///< the glTF's place in the file
  Vec3d centre;                         ///< added to positions, z-up (RTC_CENTER)
  BatchTablePlace batch{};
  MeshOutline outline{};
};

struct TileFile {
  std::vector<TileGltf> meshes{};
  std::uint64_t instanced = 0, points = 0, vectors = 0;  ///< tiles that are no meshes
  bool is_tileset = false;                               ///< the JSON of another one
  bool is_packed = false;                                ///< in gzip: offsets count in its content
};

/// Reads headers, feature tables and outlines of a file, packed by gzip or not. Throws Error(input)
/// if the file is none of these, if it is truncated, or if tiles lie in each other deeper than 8
/// levels or are more than 65,536; Error(budget) if a feature table takes more than `most_bytes` of
/// memory.
TileFile read_tile_file(const storage::File& file, std::uint64_t most_bytes);

}  // namespace meshhier::mesh_io
