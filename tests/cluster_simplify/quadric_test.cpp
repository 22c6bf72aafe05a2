#include "cluster_simplify/quadric.h"

#include "tests/support/meshes.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

constexpr double kPull = 1e-3;

Vec3d random_point(std::uint64_t index, std::uint64_t stream) {
  return {double{tests::hash_noise(index, stream)}, double{tests::hash_noise(index, stream + 1)},
          double{tests::hash_noise(index, stream + 2)}};
}

void expect_near(Vec3d found, Vec3d expected, double tolerance) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.z, expected.z, tolerance);
}

/// The planes x = 1, y = 2, z = 3, each by a triangle of area 1/2.
Quadric corner_planes() {
  Quadric q;
  q.add_triangle({1, 0, 0}, {1, 1, 0}, {1, 0, 1});
  q.add_triangle({0, 2, 0}, {0, 2, 1}, {1, 2, 0});
  q.add_triangle({0, 0, 3}, {1, 0, 3}, {0, 1, 3});
  return q;
}

TEST(QuadricTest, ErrorIsTheAreaTimesTheSquaredDistanceToThePlane) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Vec3d a = random_point(i, 1);
    const Vec3d b = random_point(i, 4);
    const Vec3d c = random_point(i, 7);
    const Vec3d x = random_point(i, 10);
    const Vec3d normal = cross(b - a, c - a);
    const double distance = dot(normal, x - a) / length(normal);
    Quadric q;
    q.add_triangle(a, b, c);
    EXPECT_NEAR(q.at(x), length(normal) / 2 * distance * distance, 1e-12);
  }
}

TEST(QuadricTest, ErrorsOfSeveralTrianglesAddUp) {
  Quadric both;
  double sum = 0;
  const Vec3d x{0.3, -0.2, 0.9};
  for (std::uint64_t i = 0; i < 10; ++i) {
    Quadric one;
    one.add_triangle(random_point(i, 20), random_point(i, 23), random_point(i, 26));
    both.add_triangle(random_point(i, 20), random_point(i, 23), random_point(i, 26));
    sum += one.at(x);
  }
  EXPECT_NEAR(both.at(x), sum, 1e-12);
}

TEST(QuadricTest, OrientationDoesNotMatter) {
  Quadric q;
  Quadric mirrored;
  q.add_triangle({0, 0, 1}, {1, 0, 2}, {0, 1, 3});
  mirrored.add_triangle({0, 0, 1}, {0, 1, 3}, {1, 0, 2});
  EXPECT_DOUBLE_EQ(q.at({3, 4, 5}), mirrored.at({3, 4, 5}));
}

TEST(QuadricTest, TrianglesWithoutAreaAddNothing) {
  Quadric q;
  q.add_triangle({1, 1, 1}, {1, 1, 1}, {2, 3, 4});
  q.add_triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  EXPECT_EQ(q.at({5, 6, 7}), 0);
}

TEST(QuadricTest, ThreePlanesMeetInTheirCorner) {
  expect_near(corner_planes().minimum({0, 0, 0}, 1e-9), {1, 2, 3}, 1e-6);
}

TEST(QuadricTest, APlaneLeavesThePointAboveTheAnchorsPlaceInIt) {
  Quadric q;
  q.add_triangle({0, 0, 3}, {1, 0, 3}, {0, 1, 3});
  expect_near(q.minimum({7, -8, 2.9}, 1e-6), {7, -8, 3}, 1e-5);
}

TEST(QuadricTest, TwoPlanesLeaveTheAnchorsPlaceOnTheirLine) {
  Quadric q;
  q.add_triangle({1, 0, 0}, {1, 1, 0}, {1, 0, 1});
  q.add_triangle({0, 2, 0}, {0, 2, 1}, {1, 2, 0});
  expect_near(q.minimum({0.9, 2.1, 5}, 1e-6), {1, 2, 5}, 1e-5);
}

TEST(QuadricTest, WithoutPlanesTheAnchorIsTheMinimum) {
  EXPECT_EQ(Quadric().minimum({1, 2, 3}, kPull), (Vec3d{1, 2, 3}));
}

TEST(QuadricTest, NoPointIsBetterThanTheMinimum) {
  const Vec3d anchor{0.1, 0.2, -0.1};
  for (std::uint64_t round = 0; round < 20; ++round) {
    Quadric q;
    for (std::uint64_t i = 0; i < 12; ++i) {
      const std::uint64_t index = round * 100 + i;
      q.add_triangle(random_point(index, 30), random_point(index, 33), random_point(index, 36));
    }
    const double pull = kPull * (q.xx + q.yy + q.zz) / 3;
    const auto energy = [&](Vec3d x) { return q.at(x) + pull * dot(x - anchor, x - anchor); };
    const Vec3d best = q.minimum(anchor, kPull);
    for (std::uint64_t i = 0; i < 100; ++i) {
      const double step = std::exp2(-static_cast<double>(i % 20));
      ASSERT_LE(energy(best), energy(best + random_point(i, 50 + round) * step) + 1e-12);
    }
  }
}

TEST(QuadricTest, ExtremeUnitsGiveTheSamePoint) {
  for (const double unit : {1e-30, 1e30}) {
    Quadric q;
    q.add_triangle(Vec3d{1, 0, 0} * unit, Vec3d{1, 1, 0} * unit, Vec3d{1, 0, 1} * unit);
    q.add_triangle(Vec3d{0, 2, 0} * unit, Vec3d{0, 2, 1} * unit, Vec3d{1, 2, 0} * unit);
    q.add_triangle(Vec3d{0, 0, 3} * unit, Vec3d{1, 0, 3} * unit, Vec3d{0, 1, 3} * unit);
    expect_near(q.minimum({}, 1e-9) * (1 / unit), {1, 2, 3}, 1e-6);
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
