// Which kind of mesh a file holds, by its content.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstdint>
#include <optional>
#include <string>

namespace meshhier::mesh_io {

/// A tileset is the JSON of 3D Tiles, whose tiles are meshes; a b3dm is such a tile.
enum class MeshKind : std::uint8_t {
  ply,
  obj,
  stl_binary,
  stl_text,
  off,
  gltf,
  glb,
  tileset,
  b3dm
};

/// What the reader of glTF reads.
constexpr bool is_gltf(MeshKind kind) {
  return kind == MeshKind::gltf || kind == MeshKind::glb || kind == MeshKind::b3dm;
}

struct MeshFormat {
  MeshKind kind{};
  bool is_gzip = false;
};

/// For people: "OBJ", "binary STL (gzip)".
std::string name_of(const MeshFormat& format);

/// Looks at the first 64 KiB of the content, of JSON up to the keys that tell what it is, and of a
/// binary STL at the file's size: one that begins with "solid", as texts do, is binary if its size
/// says so or (where it is packed, or where its first facets have numbers as meshes have) if the
/// first bytes are no text. An object of JSON is read up to the keys that tell what it is, wherever
/// they stand: a glTF has meshes or what belongs to them; a tileset a "root" beside its "asset", or
/// a geometric error. One without any is a glTF if its first key is one of glTF's. Throws
/// Error(input) if it is none of these, Error(io).
MeshFormat detect_format(const storage::File& file);

/// The same; nothing if it is none of these.
std::optional<MeshFormat> find_format(const storage::File& file);

}  // namespace meshhier::mesh_io
