// PLY files whose faces show pictures or have colours or values as meshes: corners that show
// another picture, another place of it, another colour or other values are other vertices.
#pragma once

#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/named_files.h"
#include "mesh_io/ply_source.h"
#include "mesh_io/unplaced.h"
#include "mesh_io/zeroed.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

struct PlyImport {
  AttributeLayout layout;
  bool fits_float = true;
  mesh_io::FaceCounts counts;
  std::uint64_t split_vertices = 0;  ///< vertices that a vertex of the file has beyond one
  /// Colours of vertices that show no picture, beside others that do.
  std::uint64_t hidden_colours = 0;
  mesh_io::UnplacedVertices unplaced;
  mesh_io::ZeroedCounts zeroed;  ///< attributes of vertices and of polygons' corners
};

/// Appends the mesh of `source` to `mesh`, but for its layout. `path`: that of the file; its folder
/// has the pictures. If a triangle shows a picture that is there, the file is textured: vertices
/// are ordered as in the file, then by the bits of their texture coordinates, which are glTF's,
/// then by the first triangle with their values, then by their material. There is one material for
/// each picture that triangles use, by first use; triangles without a picture are white. Else, if
/// faces have colours or values, vertices are ordered as in the file, then by these. Else the mesh
/// is that of the vertices and triangles alone. Pictures that triangles should show and that are
/// not there are noted in the mesh's table. Throws as PlySource. Requires has_corner_attributes().
PlyImport import_ply_corners(mesh_io::PlySource& source, const std::filesystem::path& path,
                             Textures textures, RawMesh& mesh, mesh_io::NamedFiles& files,
                             const ImportRoom& room);

}  // namespace meshhier::importing
