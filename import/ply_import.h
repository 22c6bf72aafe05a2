// PLY files as meshes. Faces may show pictures or have colours or values: then corners that show
// another picture, another place of it, another colour or other values are other vertices.
#pragma once

#include "base/bounds.h"
#include "import/added_file.h"
#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/named_files.h"
#include "mesh_io/ply_source.h"

#include <filesystem>
#include <optional>

namespace meshhier::importing {

/// What is taken of a file.
struct PlyUse {
  Textures textures{};
  const std::optional<BoundsD>& crop;  ///< all, if there is none
};

/// Appends the mesh of `source` to `mesh`, but for its layout. `path`: that of the file; its folder
/// has the pictures. Where only a box is taken, what is apart of it stays out, if the file can be
/// read in place: a large file is not copied for a piece. If a triangle shows a picture that is
/// there, the file is textured: vertices are ordered as in the file, then by the bits of their
/// texture coordinates, which are glTF's, then by the first triangle with their values, then by
/// their material. There is one material for each picture that triangles use, by first use;
/// triangles without a picture are white. Else, if faces have colours or values, vertices are
/// ordered as in the file, then by these. Else the mesh is that of the vertices and triangles
/// alone. Pictures that triangles should show and that are not there are noted in the mesh's table.
/// Throws as PlySource, and Error(input) if the mesh gets 2^32 vertices or more.
AddedFile import_ply(mesh_io::PlySource& source, const std::filesystem::path& path,
                     const PlyUse& use, RawMesh& mesh, mesh_io::NamedFiles& files,
                     const ImportRoom& room);

}  // namespace meshhier::importing
