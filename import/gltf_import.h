// glTF files as meshes: the triangles of all primitives that the scene shows, at their places.
#pragma once

#include "import/added_file.h"
#include "import/gltf_place.h"
#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/gltf_file.h"

#include <cstdint>
#include <optional>

namespace meshhier::importing {

/// A file that was read apart, to a mesh of its own.
struct MeshApart {
  explicit MeshApart(storage::ScratchFile& scratch) : mesh(scratch) {}
  RawMesh mesh;
  AddedFile added{};
  std::optional<std::uint64_t> checksum{};  ///< of the file, if all of it was read
};

/// Appends the mesh of a file to `mesh`, but for its layout, with its scene at `place`:
/// primitive by primitive in the order of the scene, each with the vertices that its triangles use,
/// in their order. The mesh is textured if `textures` are used and a primitive's base colour has a
/// picture that is there and coordinates. If it is not, and no primitive has vertex colours, the
/// vertices have the base colours, if they are to be seen (PlainColours). Attributes that a
/// primitive does not have, but another has, are filled in and counted. Values are those of
/// GltfValues, objects those of GltfObjects. Throws Error(input) naming the accessor, node or view,
/// and as GltfFile.
AddedFile import_gltf(mesh_io::GltfFile& file, const GltfPlace& place, RawMesh& mesh,
                      Textures textures, const mesh_io::AttributeChoice& attributes,
                      const ImportRoom& room);

}  // namespace meshhier::importing
