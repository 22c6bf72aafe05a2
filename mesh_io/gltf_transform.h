// Affine transforms, by which nodes of a glTF document place their meshes.
#pragma once

#include "base/vec.h"

#include <array>

namespace meshhier::mesh_io {

/// p -> linear p + offset.
struct GltfTransform {
  std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d offset;

  friend bool operator==(const GltfTransform&, const GltfTransform&) = default;
};

/// Returns the transform of node.matrix: 16 numbers column by column, whose last row is ignored.
GltfTransform gltf_matrix(const std::array<double, 16>& columns);
/// Returns the transform of node.translation, rotation (a quaternion x y z w, of any length but 0)
/// and scale.
GltfTransform gltf_placement(const Vec3d& translation, const std::array<double, 4>& rotation,
                             const Vec3d& scale);

/// Applies first `inner`, then `outer`.
GltfTransform operator*(const GltfTransform& outer, const GltfTransform& inner);

inline Vec3d transformed(const GltfTransform& t, Vec3d p) {
  return Vec3d{dot(t.rows[0], p), dot(t.rows[1], p), dot(t.rows[2], p)} + t.offset;
}

/// Returns whether it turns left hands into right ones: triangles must be turned round then.
bool is_mirrored(const GltfTransform& t);

/// Returns the matrix for normals, up to a positive factor: the inverse of the transpose. Its
/// cofactors are used, so a transform without an inverse has one, too.
std::array<Vec3d, 3> normal_rows(const GltfTransform& t);

}  // namespace meshhier::mesh_io
