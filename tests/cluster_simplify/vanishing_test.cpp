#include "cluster_simplify/vanishing.h"

#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::AllOf;
using testing::Each;
using testing::Gt;
using testing::Lt;

constexpr float kNever = std::numeric_limits<float>::infinity();

std::vector<float> distances_of(const BuildTile& tile) {
  return vanishing_distances(tile.mesh, tile.mesh.vertices.positions);
}

std::vector<float> part(const std::vector<float>& all, std::size_t begin, std::size_t end) {
  return {all.begin() + static_cast<std::ptrdiff_t>(begin),
          all.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// A strip of (columns + 1) * 2 vertices, one edge wide.
tests::TestMesh strip(std::size_t columns) {
  return tests::open_grid(columns, 1);
}

/// The mean squared distance from the vertices in [begin, end) to the nearest of the first `count`.
double mean_squared(const std::vector<Vec3f>& positions, std::size_t count, std::size_t begin,
                    std::size_t end) {
  const std::vector<Vec3f> others(positions.begin(),
                                  positions.begin() + static_cast<std::ptrdiff_t>(count));
  double sum = 0;
  for (std::size_t v = begin; v < end; ++v) {
    const double away = tests::distance_to_nearest(positions[v], others);
    sum += away * away;
  }
  return sum / static_cast<double>(end - begin);
}

TEST(VanishingTest, ASpeckIsAsFarFromTheNextSurfaceAsItsVerticesInTheMean) {
  tests::TestMesh mesh = tests::open_grid(9, 9);
  const std::size_t large = mesh.positions.size();
  for (const float height : {0.1F, 2.0F, 30.0F})
    tests::append(mesh, strip(3), {3, 4, height});
  const std::vector<float> found = distances_of(tests::tile_of(mesh));
  EXPECT_THAT(part(found, 0, large), Each(kNever));
  for (std::size_t begin = large; begin < found.size(); begin += 8) {
    const double expected = mean_squared(mesh.positions, large, begin, begin + 8);
    EXPECT_THAT(part(found, begin, begin + 8),
                Each(testing::FloatNear(static_cast<float>(expected),
                                        static_cast<float>(expected) * 1e-5F)));
  }
}

TEST(VanishingTest, SpecksDoNotCountAsSurfaceForEachOther) {
  tests::TestMesh mesh = tests::open_grid(9, 9);
  const std::size_t large = mesh.positions.size();
  tests::append(mesh, strip(1), {0, 0, 5});
  tests::append(mesh, strip(1), {0, 0, 5.01F});
  const std::vector<float> found = distances_of(tests::tile_of(mesh));
  EXPECT_THAT(part(found, large, found.size()), Each(testing::FloatNear(25, 0.2F)));
}

TEST(VanishingTest, ThirtyTwoVerticesAreSmallThirtyThreeAreNot) {
  tests::TestMesh mesh = tests::open_grid(9, 9);
  const std::size_t large = mesh.positions.size();
  tests::append(mesh, strip(15), {0, 0, 1});
  const std::size_t middle = mesh.positions.size();
  ASSERT_EQ(middle, large + 32);
  tests::append(mesh, strip(15), {0, 0, 2});
  mesh.positions.push_back({0, 3, 2});
  mesh.triangles.push_back({static_cast<std::uint32_t>(middle + 16),
                            static_cast<std::uint32_t>(middle + 17),
                            static_cast<std::uint32_t>(middle + 32)});
  const std::vector<float> found = distances_of(tests::tile_of(mesh));
  EXPECT_THAT(part(found, large, middle), Each(testing::Lt(kNever)));
  EXPECT_THAT(part(found, middle, found.size()), Each(kNever));
}

TEST(VanishingTest, APieceThatReachesANeighbourTileMayBeLarge) {
  tests::TestMesh mesh = tests::open_grid(9, 9);
  const std::size_t large = mesh.positions.size();
  tests::append(mesh, strip(1), {0, 0, 1});
  mesh.positions.push_back({-1, 0, 1});
  const auto ghost = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.triangles.push_back(
      {ghost, static_cast<std::uint32_t>(large), static_cast<std::uint32_t>(large + 2)});
  EXPECT_THAT(distances_of(tests::tile_of(mesh, ghost)), Each(kNever));
}

TEST(VanishingTest, AGhostIsSurfaceToGoTo) {
  // A speck of own vertices, and a neighbour's piece with one own vertex.
  tests::TestMesh mesh = strip(1);
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 7}, {0.25F, 0.25F, 2}, {9, 9, 9}});
  mesh.triangles.push_back({4, 5, 6});
  const std::vector<float> found = distances_of(tests::tile_of(mesh, 5));
  // (0, 0, 0) is nearest to the ghost at (0.25, 0.25, 2), and so are the others.
  const float expected = 4 + (2 * 0.0625F + 2 * (0.0625F + 0.5625F) + 2 * 0.5625F) / 4;
  EXPECT_THAT(part(found, 0, 4), Each(testing::FloatNear(expected, 1e-5F)));
  EXPECT_THAT(part(found, 4, 7), Each(kNever));
}

TEST(VanishingTest, VerticesWithoutTrianglesDoNotVanishAndAreNoSurface) {
  tests::TestMesh mesh = strip(1);
  mesh.positions.push_back({0, 0, 0.5F});
  const std::vector<float> alone = distances_of(tests::tile_of(mesh));
  EXPECT_THAT(part(alone, 0, 4), Each(Lt(1)));  // to its middle: there is nothing else
  EXPECT_EQ(alone.back(), kNever);
  const std::size_t base = mesh.positions.size();
  tests::append(mesh, tests::open_grid(9, 9), {0, 0, 3});
  const std::vector<float> found = distances_of(tests::tile_of(mesh));
  EXPECT_THAT(part(found, 0, 4), Each(9));
  EXPECT_EQ(found[base - 1], kNever);
}

TEST(VanishingTest, WhereAllPiecesAreSmallTheSmallestGoFirst) {
  tests::TestMesh mesh;
  tests::append(mesh, strip(5), {0, 0, 0});
  tests::append(mesh, strip(1), {100, 0, 0});
  const std::vector<float> found = distances_of(tests::tile_of(mesh));
  const std::size_t large = found.size() - 4;
  EXPECT_THAT(part(found, 0, large), Each(AllOf(Gt(found.back()), Lt(kNever))));
  EXPECT_THAT(part(found, large, found.size()), Each(found.back()));
  EXPECT_THAT(distances_of(tests::tile_of(tests::soup(50))), Each(Lt(kNever)));
  EXPECT_THAT(distances_of(tests::tile_of(tests::points(50))), Each(kNever));
  EXPECT_TRUE(distances_of({}).empty());
}

TEST(VanishingTest, PiecesAreFoundInAnyOrderOfVertices) {
  tests::TestMesh mesh = tests::open_grid(9, 9);
  for (int i = 0; i < 20; ++i)
    tests::append(mesh, strip(static_cast<std::size_t>(1 + i % 5)),
                  {0, 0, 1 + static_cast<float>(i)});
  const std::vector<float> before = distances_of(tests::tile_of(mesh));
  const tests::TestMesh turned = tests::shuffled(mesh, 3);
  const std::vector<float> after = distances_of(tests::tile_of(turned));
  std::vector<std::pair<float, float>> expected;
  std::vector<std::pair<float, float>> found;
  for (std::size_t v = 0; v < before.size(); ++v) {
    expected.emplace_back(mesh.positions[v].z, std::min(before[v], 1e6F));
    found.emplace_back(turned.positions[v].z, std::min(after[v], 1e6F));
  }
  std::ranges::sort(expected);
  std::ranges::sort(found);
  for (std::size_t v = 0; v < before.size(); ++v)
    ASSERT_NEAR(found[v].second, expected[v].second, 1e-5F * expected[v].second);
}

}  // namespace
}  // namespace meshhier::cluster_simplify
