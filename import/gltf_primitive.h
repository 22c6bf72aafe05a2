// The data of a primitive of a glTF file: its accessors, or a codec's output.
#pragma once

#include "mesh_io/gltf_draco.h"
#include "mesh_io/gltf_elements.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/mesh_blocks.h"

#include <cstdint>
#include <optional>
#include <string>

namespace meshhier::importing {

/// The elements of one primitive. For one thread.
class PrimitiveSources {
 public:
  /// Decodes it, if it is compressed. Both must outlive it. Throws as mesh_io::decode_draco().
  PrimitiveSources(mesh_io::GltfFile& file, const mesh_io::GltfPrimitive& primitive);

  /// Returns the attribute, with `least` to `most` components; nothing if the primitive does not
  /// have it. Throws Error(input) naming the accessor if it is of another type.
  std::optional<mesh_io::GltfElementSource> attribute(const std::string& name, std::uint32_t least,
                                                      std::uint32_t most) const;
  std::optional<mesh_io::GltfElementSource> indices() const;
  /// Hands out the triangles in blocks, without degenerate ones, and counts both. `position`: the
  /// attribute of that name. Throws Error(input) naming the accessor if an index is not below its
  /// count, or a list does not end with a triangle.
  mesh_io::FaceCounts read_triangles(const mesh_io::GltfElementSource& position,
                                     const mesh_io::TriangleVisitor& take) const;

  mesh_io::GltfFile& file() const { return file_; }
  const mesh_io::GltfPrimitive& primitive() const { return primitive_; }

 private:
  template <class Corner>
  void assemble(const mesh_io::GltfElementSource& corners, mesh_io::TriangleBlocks& blocks,
                const Corner& corner) const;
  /// Returns how indices make triangles: Draco's are a list, even if they were a strip.
  mesh_io::GltfPrimitive::Mode mode() const;

  mesh_io::GltfFile& file_;
  const mesh_io::GltfPrimitive& primitive_;
  mesh_io::GltfDracoMesh draco_;
};

}  // namespace meshhier::importing
