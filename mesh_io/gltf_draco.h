// KHR_draco_mesh_compression: primitives as streams of Google's Draco.
#pragma once

#include "mesh_io/gltf_elements.h"
#include "mesh_io/gltf_file.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A primitive's decoded data in a scratch file. A primitive is in memory only while it is decoded,
/// one at a time.
struct GltfDracoMesh {
  GltfElementSource indices;                            ///< u32
  std::map<std::string, GltfElementSource> attributes;  ///< names that the stream has
  /// Owners of the bytes that the sources read.
  std::vector<std::unique_ptr<GltfSpoolBytes>> bytes;
};

/// Decodes a primitive that has `draco`. Attributes get the component types of their accessors.
/// Throws Error(input) naming the view if it is no such stream or does not have what the
/// accessors say, Error(budget) if it takes more memory than there is; and as GltfFile::view().
GltfDracoMesh decode_draco(GltfFile& file, const GltfPrimitive& primitive);

}  // namespace meshhier::mesh_io
