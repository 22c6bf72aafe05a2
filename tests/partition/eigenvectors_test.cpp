#include "partition/eigenvectors.h"

#include "storage/io/hash.h"
#include "tests/support/meshes.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

Vec3d times(const Matrix3& m, Vec3d v) {
  const auto row = [&](std::size_t k) { return m[k][0] * v.x + m[k][1] * v.y + m[k][2] * v.z; };
  return {row(0), row(1), row(2)};
}

/// Unit, perpendicular, only scaled by the matrix, and in order.
void expect_eigenvectors(const Matrix3& matrix) {
  const std::array<Vec3d, 3> vectors = eigenvectors(matrix);
  double last = -10;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(length(vectors[i]), 1, 1e-15);
    const Vec3d image = times(matrix, vectors[i]);
    const double value = dot(image, vectors[i]);
    EXPECT_NEAR(length(image - vectors[i] * value), 0, 1e-14);
    EXPECT_GE(value, last - 1e-15);
    last = value;
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_NEAR(dot(vectors[i], vectors[j]), 0, 1e-14);
  }
}

TEST(EigenvectorsTest, AreThoseOfAnySymmetricMatrix) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto entry = [&](std::uint64_t k) { return double{tests::hash_noise(6 * i + k, 5)}; };
    expect_eigenvectors({{{entry(0), entry(1), entry(2)},
                          {entry(1), entry(3), entry(4)},
                          {entry(2), entry(4), entry(5)}}});
  }
}

// Another value means another compiler or processor, or other code: hierarchies would differ, too.
TEST(EigenvectorsTest, TheBitsAreTheSameEverywhere) {
  std::vector<Vec3d> vectors;
  for (int i = 0; i < 1000; ++i) {
    const auto entry = [&](int k) { return ((6 * i + k) * 7919 % 2047 - 1023) / 1024.0; };
    const auto found = eigenvectors({{{entry(0), entry(1), entry(2)},
                                      {entry(1), entry(3), entry(4)},
                                      {entry(2), entry(4), entry(5)}}});
    vectors.insert(vectors.end(), found.begin(), found.end());
  }
  EXPECT_EQ(storage::checksum(std::as_bytes(std::span(vectors))), 1528851835302944222U);
}

TEST(EigenvectorsTest, AreThoseOfMatricesWithEqualOrNoEigenvalues) {
  expect_eigenvectors({});
  expect_eigenvectors({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  expect_eigenvectors({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}});
  expect_eigenvectors({{{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}});
  expect_eigenvectors({{{1, 1e-200, 0}, {1e-200, 0.5, 1e-300}, {0, 1e-300, 1e-310}}});
}

}  // namespace
}  // namespace meshhier::partition
