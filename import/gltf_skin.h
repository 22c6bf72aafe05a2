// Skinned meshes of a glTF file in the pose that its nodes have (glTF 2.0 specification, 3.7.3.3):
// a vertex is placed by the joints of its skin, each by its weight, and not by the mesh's node.
#pragma once

#include "import/gltf_primitive.h"
#include "mesh_io/gltf_elements.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_scene.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::importing {

/// Returns for each joint of a skin the transform of the vertices that it moves: its place times
/// its inverse bind matrix. Throws Error(input) naming the accessor if these are no matrices, fewer
/// than the joints, or not finite.
std::vector<mesh_io::GltfTransform> joint_matrices(mesh_io::GltfFile& file,
                                                   const mesh_io::GltfSkin& skin,
                                                   const mesh_io::GltfScene& scene);

/// Returns whether most of them turn left hands into right ones.
bool are_mirrored(const std::vector<mesh_io::GltfTransform>& matrices);

/// Returns whether a primitive says which joints its vertices hang on.
bool is_skinned(const mesh_io::GltfPrimitive& primitive);

/// Places the vertices of a primitive of which is_skinned() is true. For one thread.
class GltfSkinning {
 public:
  /// `matrices`: those of the joints, one or more. All arguments must outlive it. Throws
  /// Error(input) naming the accessor if it is of no type that joints or weights may have, or has
  /// not `count` elements.
  GltfSkinning(mesh_io::GltfFile& file, const mesh_io::GltfPrimitive& primitive,
               const PrimitiveSources& sources, const std::vector<mesh_io::GltfTransform>& matrices,
               std::uint64_t count);

  /// Returns a vertex's transform: the mean of its joints' matrices by its weights, whatever their
  /// sum is. Weights that are no numbers, or below 0, are 0; where all are 0 the first joint
  /// counts. `vertex` never falls from one call to the next. Throws Error(input) naming the
  /// accessor if a joint that counts is beyond the skin.
  mesh_io::GltfTransform at(std::uint32_t vertex);

 private:
  /// JOINTS_n and WEIGHTS_n: four of each.
  struct Set {
    mesh_io::GltfElements joints, weights;
  };
  mesh_io::GltfElements elements(const PrimitiveSources& sources, const std::string& name,
                                 std::uint64_t count);
  const mesh_io::GltfTransform& matrix(const mesh_io::GltfElements& joints, std::uint32_t vertex,
                                       double joint) const;

  mesh_io::GltfFile& file_;
  const std::vector<mesh_io::GltfTransform>& matrices_;
  std::vector<Set> sets_;
};

}  // namespace meshhier::importing
