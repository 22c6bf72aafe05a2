#include "partition/eigenvectors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshhier::partition {
namespace {

/// It converges quadratically: 5 sweeps do for three rows, and more change nothing.
constexpr int kSweeps = 8;

struct Rotation {
  double cosine = 1;
  double sine = 0;
};

/// The smaller of the two that make the entry (p, q) zero.
Rotation rotation_for(const Matrix3& matrix, std::size_t p, std::size_t q) {
  if (matrix[p][q] == 0)
    return {};
  const double slope = (matrix[q][q] - matrix[p][p]) / (2 * matrix[p][q]);
  const double tangent = std::copysign(1, slope) / (std::abs(slope) + std::sqrt(slope * slope + 1));
  const double cosine = 1 / std::sqrt(tangent * tangent + 1);
  return {cosine, tangent * cosine};
}

void rotate(double& a, double& b, Rotation by) {
  const double turned = by.cosine * a - by.sine * b;
  b = by.sine * a + by.cosine * b;
  a = turned;
}

/// The matrix from both sides, the columns of `vectors` from one.
void apply(Rotation by, std::size_t p, std::size_t q, Matrix3& matrix, Matrix3& vectors) {
  for (std::size_t k = 0; k < 3; ++k)
    rotate(matrix[k][p], matrix[k][q], by);
  for (std::size_t k = 0; k < 3; ++k)
    rotate(matrix[p][k], matrix[q][k], by);
  matrix[p][q] = matrix[q][p] = 0;
  for (std::size_t k = 0; k < 3; ++k)
    rotate(vectors[k][p], vectors[k][q], by);
}

}  // namespace

std::array<Vec3d, 3> eigenvectors(Matrix3 matrix) {
  Matrix3 vectors{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [p, q] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}})
      apply(rotation_for(matrix, p, q), p, q, matrix, vectors);
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return matrix[a][a] < matrix[b][b]; });
  const auto column = [&](std::size_t k) {
    const Vec3d vector{vectors[0][k], vectors[1][k], vectors[2][k]};
    return vector * (1 / length(vector));
  };
  return {column(order[0]), column(order[1]), column(order[2])};
}

}  // namespace meshhier::partition
