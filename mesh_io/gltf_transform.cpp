#include "mesh_io/gltf_transform.h"

namespace meshhier::mesh_io {
namespace {

Vec3d column(const GltfTransform& t, int axis) {
  return {t.rows[0][axis], t.rows[1][axis], t.rows[2][axis]};
}

double determinant(const GltfTransform& t) {
  return dot(t.rows[0], cross(t.rows[1], t.rows[2]));
}

}  // namespace

GltfTransform gltf_matrix(const std::array<double, 16>& columns) {
  const auto row = [&](std::size_t i) { return Vec3d{columns[i], columns[4 + i], columns[8 + i]}; };
  return {{row(0), row(1), row(2)}, {columns[12], columns[13], columns[14]}};
}

GltfTransform gltf_placement(const Vec3d& translation, const std::array<double, 4>& rotation,
                             const Vec3d& scale) {
  const auto [x, y, z, w] = rotation;
  const double s = 2 / (x * x + y * y + z * z + w * w);
  const auto scaled = [&](Vec3d row) {
    return Vec3d{row.x * scale.x, row.y * scale.y, row.z * scale.z};
  };
  return {{scaled({1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)}),
           scaled({s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)}),
           scaled({s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)})},
          translation};
}

GltfTransform operator*(const GltfTransform& outer, const GltfTransform& inner) {
  GltfTransform product;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& row = outer.rows[i];
    product.rows[i] = {dot(row, column(inner, 0)), dot(row, column(inner, 1)),
                       dot(row, column(inner, 2))};
  }
  product.offset = transformed(outer, inner.offset);
  return product;
}

bool is_mirrored(const GltfTransform& t) {
  return determinant(t) < 0;
}

std::array<Vec3d, 3> normal_rows(const GltfTransform& t) {
  const double sign = is_mirrored(t) ? -1 : 1;
  return {cross(t.rows[1], t.rows[2]) * sign, cross(t.rows[2], t.rows[0]) * sign,
          cross(t.rows[0], t.rows[1]) * sign};
}

}  // namespace meshhier::mesh_io
