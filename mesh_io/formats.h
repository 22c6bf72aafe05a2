// The formats of meshes, a row each: what is done with them, and what people are told of them.
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

/// A tileset is the JSON of 3D Tiles, whose tiles are meshes; a b3dm is such a tile.
enum class MeshKind : std::uint8_t {
  ply,
  obj,
  gltf,
  glb,
  stl_binary,
  stl_text,
  off,
  tileset,
  b3dm
};

class MeshContent;  // recognition.h

/// How sure it is that a file is of a kind: what is sure of another one is not what is likely.
enum class Certainty : std::uint8_t { none, likely, sure };

struct FormatRow {
  MeshKind kind{};
  std::string_view name{};    ///< for people: "binary STL"
  std::string_view format{};  ///< what it is called together with its siblings: "STL"
  std::string_view ending{};  ///< of its files: ".stl"; empty: the content alone tells what it is
  Certainty (*look)(MeshContent&) = nullptr;  ///< null: lies within files of other kinds
  /// Lists the files with vertices and triangles that a file names; null: it names none.
  std::vector<std::filesystem::path> (*buffers)(const storage::File&) = nullptr;
  bool in_metres = false;       ///< its coordinates are, by its specification
  bool names_features = false;  ///< numbers of features are labels, by its specification
  /// Endings of files that one names, besides pictures.
  std::vector<std::string_view> companions{};
  /// In Markdown, of all kinds of a format; empty: an earlier row says it.
  std::string_view kept{}, left_out{};
};

/// One row a kind. Where several kinds are sure or likely, a file is of the first one.
const std::vector<FormatRow>& format_rows();
const FormatRow& row_of(MeshKind kind);

struct MeshFormat {
  MeshKind kind{};
  bool is_gzip = false;

  const FormatRow& row() const { return row_of(kind); }
};

/// For people: "OBJ", "binary STL (gzip)".
std::string name_of(const MeshFormat& format);

/// Looks at the first 64 KiB of the content, and where a row of the table asks for more, at that.
/// Throws Error(input) if it is none of these, with what it is if that is known; Error(io).
MeshFormat detect_format(const storage::File& file);

/// The same; nothing if it is none of these.
std::optional<MeshFormat> find_format(const storage::File& file);

/// The formats of files with endings, and these endings, for sentences: "PLY, OBJ or STL", ".ply,
/// .obj or .stl".
std::string format_names();
std::string mesh_endings_text();
/// The endings, each once.
std::vector<std::string_view> mesh_endings();

/// Whether a file of that name is taken for a mesh: it has the ending of one, perhaps with ".gz"
/// behind it, in capitals or small letters, and does not begin with a dot.
bool is_mesh_name(std::string_view name);

/// The name without these endings: "david" of "david.ply.gz"; "" if it has none of them.
std::string mesh_stem(std::string_view name);

}  // namespace meshhier::mesh_io
