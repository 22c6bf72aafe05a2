// What one primitive of a glTF file reads: its accessors, or what a codec made of them.
#pragma once

#include "mesh_io/gltf_draco.h"
#include "mesh_io/gltf_elements.h"
#include "mesh_io/gltf_file.h"

#include <cstdint>
#include <optional>
#include <string>

namespace meshhier::importing {

class PrimitiveSources {
 public:
  /// Decodes it, if it is compressed. Both must outlive it. Throws as mesh_io::decode_draco().
  PrimitiveSources(mesh_io::GltfFile& file, const mesh_io::GltfPrimitive& primitive);

  /// The attribute, of so many components; nothing if the primitive does not have it. Throws
  /// Error(input) naming the accessor if it is of another type.
  std::optional<mesh_io::GltfElementSource> attribute(const std::string& name, std::uint32_t least,
                                                      std::uint32_t most) const;
  std::optional<mesh_io::GltfElementSource> indices() const;
  /// Draco's triangles are a list of them, even if they were a strip.
  mesh_io::GltfPrimitive::Mode mode() const;

 private:
  mesh_io::GltfFile& file_;
  const mesh_io::GltfPrimitive& primitive_;
  mesh_io::GltfDracoMesh draco_;
};

}  // namespace meshhier::importing
