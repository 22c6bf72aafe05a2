// OBJ files as meshes: corners that name another position, texture coordinate or normal are other
// vertices.
#pragma once

#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/named_files.h"
#include "mesh_io/obj_reader.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

struct ObjImport {
  mesh_io::ObjCounts counts;
  AttributeLayout layout;
  bool fits_float = true;
  std::uint64_t split_vertices = 0;    ///< vertices that a position has beyond one
  std::uint64_t material_colours = 0;  ///< materials' colours that vertices have
  bool is_painted = false;             ///< vertices have no other colours
  std::uint64_t filled_colours = 0;    ///< vertices without a colour in a file that has some: white
  std::uint64_t hidden_colours = 0;    ///< colours of vertices that show no picture
  std::uint64_t filled_texcoords = 0;  ///< vertices without one in a file that has some: 0 0
  std::uint64_t filled_normals = 0;    ///< likewise: 0 0 0
  std::uint64_t missing_libraries = 0;  ///< missing libraries that a file names
  std::uint64_t ignored_polypaint = 0;  ///< colours of #MRGB that are not one a vertex
  /// Names of materials that no library defines; they are white.
  std::uint64_t undefined_materials = 0;
  std::uint64_t byte_libraries = 0;  ///< libraries whose colours are numbers up to 255
  std::uint64_t other_alphas = 0;  ///< materials whose map_d is another picture than map_Kd: unused
};

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
ObjImport import_obj(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     mesh_io::NamedFiles& files, Textures textures,
                     const mesh_io::AttributeChoice& attributes, const ImportRoom& room);

}  // namespace meshhier::importing
