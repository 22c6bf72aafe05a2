// glTF files as meshes: the triangles of all primitives that the scene shows, at their places.
#pragma once

#include "import/gltf_place.h"
#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/zeroed.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::importing {

struct GltfImport {
  AttributeLayout layout;
  bool fits_float = true;
  std::uint64_t material_colours = 0;  ///< materials' colours that vertices have
  bool is_painted = false;             ///< vertices have no other colours
  std::uint64_t triangles = 0;         ///< as primitives declare them
  std::uint64_t degenerate_triangles = 0;
  std::vector<SourceCount> counts;  ///< things that were filled in, left out or ignored
  mesh_io::ZeroedCounts zeroed;
};

/// A file that was read apart, to a mesh of its own.
struct MeshApart {
  explicit MeshApart(storage::ScratchFile& scratch) : mesh(scratch) {}
  RawMesh mesh;
  GltfImport import{};
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
GltfImport import_gltf(mesh_io::GltfFile& file, const GltfPlace& place, RawMesh& mesh,
                       Textures textures, const mesh_io::AttributeChoice& attributes,
                       const ImportRoom& room);

}  // namespace meshhier::importing
