// Eigenvectors of symmetric matrices, by arithmetic whose result IEEE 754 fixes.
#pragma once

#include "base/vec.h"

#include <array>

namespace meshhier::partition {

/// Three rows of a matrix.
using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Unit vectors, perpendicular to each other, by ascending eigenvalue. `matrix` is symmetric, and
/// its entries are about 1 or less. Jacobi's rotations, with square roots as the only functions:
/// the C library's arc tangent differs between processors. Golub & Van Loan, Matrix Computations,
/// 8.5.
std::array<Vec3d, 3> eigenvectors(Matrix3 matrix);

}  // namespace meshhier::partition
