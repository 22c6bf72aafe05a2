// Vertices of glTF's primitives, with all attributes that the mesh has.
#pragma once

#include "import/added_file.h"
#include "import/gltf_materials.h"
#include "import/gltf_primitive.h"
#include "import/gltf_skin.h"
#include "import/gltf_values.h"
#include "import/raw_mesh.h"
#include "import/split_corners.h"

#include <string>
#include <vector>

namespace meshhier::importing {

/// Returns the name of an attribute in glTF; empty: it has none. `texcoords`: the set that is
/// shown.
std::string gltf_name(const AttributeKindRow& row, const std::string& texcoords);

/// The sources of a primitive's vertices.
struct GltfVertexSources {
  const PrimitiveSources& primitive;
  const mesh_io::GltfElementSource& position;
  const GltfMaterials& materials;
  const std::vector<GltfValue>& values;  ///< those of the layout, in its order
  bool widens_colours = false;           ///< from 8 bits to 16
};

/// The place of vertices: where a skin puts them, or a transform if there is none.
struct GltfVertexPlace {
  const mesh_io::GltfTransform& transform;
  GltfSkinning* skin = nullptr;
};

/// Appends those vertices of a primitive that are `used`, ascending, to `mesh`, with the attributes
/// of `added.layout`, and their materials' colours if `added` has such. Counts in `added` what is
/// filled in or is no number, and whether positions are floats. Throws Error(input) naming the
/// accessor if it has another number of elements than POSITION, or a number is out of range.
void append_vertices(const GltfVertexSources& from, const References& used,
                     const GltfVertexPlace& place, AddedFile& added, RawMesh& mesh,
                     const ImportRoom& room);

}  // namespace meshhier::importing
