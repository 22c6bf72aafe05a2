// Joins files of a list that have different attributes.
#pragma once

#include "import/raw_mesh.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

namespace meshhier::importing {

/// A file of a list, whose vertices come behind those of the files before.
struct JoinedFile {
  AttributeLayout layout;
  std::uint64_t vertices = 0;
  bool is_painted = false;  ///< its colours are those of its materials
};

/// Counts of attributes that files got or lost to be like the others.
struct JoinCounts {
  std::uint64_t untextured_files = 0;  ///< beside textured ones
  /// Vertices that lost attributes of a kind; of values, each one counts.
  std::array<std::uint64_t, kAttributeKindCount> dropped{};
  /// Vertices of files without colours, beside files with colours; none if the mesh is textured.
  std::uint64_t white_vertices = 0;
  std::uint64_t hidden_colours = 0;     ///< of vertices that show no picture or were to tint theirs
  std::uint64_t converted_colours = 0;  ///< of vertices, to the type of other files

  std::uint64_t& dropped_of(AttributeKind kind) { return dropped[static_cast<std::size_t>(kind)]; }
};

/// Gives all vertices of `mesh`, which have the channels of their own files, those of all files
/// together:
/// * normals, if all files have them: others are made by the build; likewise other attributes;
/// * colours, if a file has them, of the type that holds those of all; where there are none, white;
///   they tint pictures unless a file has both and does not mean that;
/// * texture coordinates of pictures, if a file has them: where there are none, 0 0 in a
///   material of the colour that the file's material has, else a white one;
/// * values that all files have, of one type;
/// * other texture coordinates, if all files have them.
/// A list of equal layouts stays as it is.
JoinCounts join_layouts(std::span<const JoinedFile> files, RawMesh& mesh, const ImportRoom& room);

}  // namespace meshhier::importing
