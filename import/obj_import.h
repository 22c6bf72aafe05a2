// OBJ files as meshes: corners that name another position, texture coordinate or normal are other
// vertices.
#pragma once

#include "import/raw_mesh.h"
#include "mesh_io/obj_reader.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

struct ObjImport {
  mesh_io::ObjCounts counts;
  AttributeLayout layout;
  bool fits_float = true;
  std::uint64_t split_vertices = 0;  ///< that a position has beyond one
  std::uint64_t filled_colours = 0;  ///< positions without a colour in a file that has some: white
  std::uint64_t filled_texcoords = 0;  ///< vertices without one in a file that has some: 0 0
  std::uint64_t filled_normals = 0;    ///< likewise: 0 0 0
};

/// Appends the mesh of a file to `mesh`, but for its layout. Attributes that no corner refers to
/// are no attributes. Without texture coordinates and normals vertices are the file's positions, in
/// their order; else there is one for each position that no triangle uses and for each combination
/// that is used, ordered by position, then texture coordinate, then normal, none being first.
/// Throws as mesh_io::read_obj.
ObjImport import_obj(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     const ImportRoom& room);

}  // namespace meshhier::importing
