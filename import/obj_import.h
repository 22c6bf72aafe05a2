// OBJ files as meshes: corners that name another position, texture coordinate or normal are other
// vertices.
#pragma once

#include "import/added_file.h"
#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/named_files.h"

#include <filesystem>

namespace meshhier::importing {

/// Appends the mesh of a file to `mesh`, but for its layout. Attributes that no corner refers to
/// are no attributes. Without texture coordinates and normals vertices are the file's positions, in
/// their order; else there is one for each position that no triangle uses and for each combination
/// that is used, ordered by position, then texture coordinate, then normal, none being first.
///
/// If a triangle's material has a picture that is there, the file is textured, its layout says so,
/// and the last part of a combination is the material's number in the mesh's table; texture
/// coordinates are glTF's. Triangles without a picture or without texture coordinates show the
/// material's colour, with 0 0 as coordinates. Pictures that triangles should show and that are not
/// there are noted in the table in any case.
///
/// If `attributes` name "group", "object" or "material", the file has a label (u16) of that name if
/// it has statements of that kind: their names' numbers in mesh.label_names, 0 before the first.
/// Corners of other labels are other combinations, ordered behind the normal.
///
/// In a file without such pictures, the colours of the materials that triangles have are those of
/// the vertices where these have none: then a combination ends with the colour. If no vertex has
/// one, only those that are to be seen (PlainColours). `files` finds the libraries and pictures.
/// Throws as mesh_io::read_obj and read_libraries.
AddedFile import_obj(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     mesh_io::NamedFiles& files, Textures textures,
                     const mesh_io::AttributeChoice& attributes, const ImportRoom& room);

}  // namespace meshhier::importing
