// The formats of meshes, a row each: how they are recognised, and what documents say of them.
// Formats that are known but not read stand in other_formats.h.
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// A tileset is the JSON of 3D Tiles, whose tiles are meshes; a b3dm is such a tile. The last ones
/// are rasters of heights.
enum class MeshKind : std::uint8_t {
  ply,
  obj,
  gltf,
  glb,
  stl_binary,
  stl_text,
  off,
  tileset,
  b3dm,
  osgb,
  geotiff,
  hgt,
  asc
};

class MeshContent;  // recognition.h

/// How sure it is that a file is of a kind. A kind that is sure wins over one that is likely.
enum class Certainty : std::uint8_t { none, likely, sure };

/// Facts about a file that are found without reading its mesh.
struct MeshOutline {
  std::vector<std::filesystem::path> buffers{};  ///< files with its vertices and triangles
  bool names_ktx2 = false;                       ///< it uses pictures in KTX2
};

struct FormatRow {
  MeshKind kind{};
  std::string_view name{};    ///< for people: "binary STL"
  std::string_view format{};  ///< the name that it shares with its siblings: "STL"
  std::string_view ending{};  ///< its files' ending: ".stl"; empty: the content alone tells
  Certainty (*look)(MeshContent&) = nullptr;  ///< null: lies within files of other kinds
  MeshOutline (*outline)(const storage::File&) = nullptr;  ///< null: it names nothing
  bool in_metres = false;       ///< its coordinates are, by its specification
  bool has_place = false;       ///< its files may say where on the globe they stand; z is up
  bool is_raster = false;       ///< of heights: several are one mosaic
  bool names_features = false;  ///< numbers of features in it are labels, by its specification
  /// Endings of files that one names, besides pictures.
  std::vector<std::string_view> companions{};
  /// The parts of a format that are kept and left out, for all its kinds together, in Markdown;
  /// empty: an earlier row says it.
  std::string_view kept{}, left_out{};
};

/// Returns the table, one row a kind. Where several kinds are equally sure, a file is of the first
/// one.
const std::vector<FormatRow>& format_rows();
const FormatRow& row_of(MeshKind kind);

struct MeshFormat {
  MeshKind kind{};
  bool is_gzip = false;

  const FormatRow& row() const { return row_of(kind); }
};

/// Returns a name for people: "OBJ", "binary STL (gzip)".
std::string name_of(const MeshFormat& format);

/// Recognises a mesh by the first 64 KiB of its content, or by more where a row of the table asks
/// for it. Throws Error(input) if it is no mesh, which says what it is if that is known; Error(io).
/// Thread-safe for different files.
MeshFormat detect_format(const storage::File& file);

/// Does the same; returns nothing if the file is no mesh.
std::optional<MeshFormat> find_format(const storage::File& file);

/// Returns the formats of files with endings for sentences, "PLY, OBJ or STL"; without 3D Tiles,
/// whose tileset.json sentences name beside them.
std::string format_names();
/// Returns all endings for sentences: ".ply, .obj or .stl".
std::string mesh_endings_text();
/// Returns the endings, each once.
std::vector<std::string_view> mesh_endings();

/// Returns whether a file of that name is taken for a mesh: it has the ending of one, perhaps with
/// ".gz" behind it, in capitals or small letters, and does not begin with a dot.
bool is_mesh_name(std::string_view name);

/// Returns the name without these endings: "david" of "david.ply.gz"; "" if it has none of them.
std::string mesh_stem(std::string_view name);

}  // namespace meshhier::mesh_io
