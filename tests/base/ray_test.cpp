#include "base/ray.h"

#include "base/triangle_tree.h"
#include "tests/support/meshes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

Vec3d noise_at(std::uint64_t index, std::uint64_t stream) {
  return {tests::hash_noise(index, 3 * stream), tests::hash_noise(index, 3 * stream + 1),
          tests::hash_noise(index, 3 * stream + 2)};
}

Ray towards(Vec3d origin, Vec3d target) {
  const Vec3d way = target - origin;
  return {origin, way * (1 / length(way))};
}

std::optional<double> hit(const Ray& ray, const SurfaceTriangle& t) {
  return ray.hit(t[0], t[1], t[2]);
}

constexpr SurfaceTriangle kFloor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

TEST(RayTest, MeetsATriangleFromEitherSideAndOnItsBorder) {
  EXPECT_EQ(hit(Ray({1, 1, 3}, {0, 0, -1}), kFloor), 3);
  EXPECT_EQ(hit(Ray({1, 1, -3}, {0, 0, 1}), kFloor), 3);
  EXPECT_EQ(hit(Ray({2, 2, 5}, {0, 0, -1}), kFloor), 5) << "an edge";
  EXPECT_EQ(hit(Ray({0, 0, 5}, {0, 0, -1}), kFloor), 5) << "a corner";
  EXPECT_EQ(hit(Ray({1, 1, 0}, {0, 0, -1}), kFloor), 0) << "from where it is";
  EXPECT_NEAR(hit(towards({-3, 1, 4}, {1, 1, 0}), kFloor).value(), std::sqrt(32.0), 1e-14);
}

TEST(RayTest, MissesWhatIsBesideBehindEdgeOnOrFlat) {
  EXPECT_FALSE(hit(Ray({2.001, 2, 5}, {0, 0, -1}), kFloor));
  EXPECT_FALSE(hit(Ray({1, 1, 3}, {0, 0, 1}), kFloor));
  EXPECT_FALSE(hit(Ray({-1, 1, 0}, {1, 0, 0}), kFloor));
  EXPECT_FALSE(hit(Ray({1, 0, 1}, {0, 0, -1}), {{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}}}));
  EXPECT_FALSE(hit(Ray({1, 1, 1}, {0, 0, -1}), {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}}));
}

TEST(RayTest, OneThatStandsStillAlongAnAxisStaysInItsSlab) {
  const Vec3f low{0, 0, 0}, high{1, 1, 1};
  EXPECT_FALSE(Ray({0.5, 0.5, -1}, {0, 0, 1}).span(low, high).is_empty());
  EXPECT_FALSE(Ray({1, 0.5, -1}, {1e-300, 0, 1}).span(low, high).is_empty()) << "on a side";
  EXPECT_TRUE(Ray({1.5, 0.5, -1}, {0, 0, 1}).span(low, high).is_empty());
  EXPECT_TRUE(Ray({0.5, 0.5, 2}, {0, 0, 1}).span(low, high).is_empty()) << "behind";
}

/// Rays at places where triangles meet, which rounding moves to either side.
TEST(RayTest, NoneSlipsThroughBetweenTwoTriangles) {
  tests::TestMesh mesh = tests::sphere(800, 0.01F);
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const tests::MeshTriangle& t = mesh.triangles[i % mesh.triangles.size()];
    const Vec3d a = to_double(mesh.positions[t[0]]), b = to_double(mesh.positions[t[1]]);
    const double along = i % 5 == 0 ? 0 : (tests::hash_noise(i, 7) + 1) / 2;
    const Ray ray = towards(noise_at(i, 1) * 0.3, a + (b - a) * along);
    std::size_t hits = 0;
    for (const tests::MeshTriangle& other : mesh.triangles)
      hits += ray.hit(mesh.positions[other[0]], mesh.positions[other[1]], mesh.positions[other[2]])
                  ? 1
                  : 0;
    EXPECT_GE(hits, 1U) << "a closed surface seen from inside, " << i;
  }
}

TEST(RayTest, ABoxInABoxIsEnteredNoEarlierAndLeftNoLater) {
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const double size = std::ldexp(1, static_cast<int>(i % 60) - 30);
    const Vec3f a = to_float(noise_at(i, 1) * size), b = to_float(noise_at(i, 2) * size);
    const Vec3f low{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
    const Vec3f high{std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
    const auto grow = [&](std::uint64_t stream, float by) {
      return i % 3 == 0 ? 0.0F : by * static_cast<float>(std::abs(tests::hash_noise(i, stream)));
    };
    const auto reach = static_cast<float>(size);
    const Vec3f outer_low{low.x - grow(20, reach), low.y - grow(21, reach), low.z};
    const Vec3f outer_high{high.x, high.y + grow(22, reach), high.z + grow(23, reach)};
    const Ray ray = towards(noise_at(i, 3) * (i % 7 == 0 ? 1e6 : 2 * size), noise_at(i, 4) * size);
    const Ray::Span inner = ray.span(low, high), outer = ray.span(outer_low, outer_high);
    EXPECT_LE(outer.entry, inner.entry) << i;
    EXPECT_GE(outer.exit, inner.exit) << i;
  }
}

TEST(RayTest, ATreeFindsWhatTryingAllFinds) {
  std::vector<SurfaceTriangle> triangles;
  for (std::uint64_t i = 0; i < 900; ++i) {
    const Vec3d a = noise_at(i, 1);
    triangles.push_back({to_float(a), to_float(a + noise_at(i, 2) * 0.3),
                         to_float(a + noise_at(i, 3) * (i % 9 == 0 ? 1e-6 : 0.3))});
  }
  const TriangleTree tree(triangles, 1);
  std::size_t found = 0, looked = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Ray ray = towards(noise_at(i, 4) * (i % 10 == 0 ? 1e5 : 2), noise_at(i, 5));
    double expected = 1e300, least = 1e300;
    for (const SurfaceTriangle& triangle : triangles)
      expected = std::min(expected, hit(ray, triangle).value_or(expected));
    tree.look_nearest(ray, least, [&](std::uint32_t leaf) {
      ++looked;
      least = std::min(least, hit(ray, triangles[tree.triangles(leaf).front()]).value_or(least));
    });
    EXPECT_EQ(least, expected) << i;
    found += expected < 1e300 ? 1 : 0;
  }
  EXPECT_GT(found, 500U);
  EXPECT_LT(looked, 2000U * 90) << "few triangles are tried";
}

}  // namespace
}  // namespace meshhier
