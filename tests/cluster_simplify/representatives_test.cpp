#include "cluster_simplify/representatives.h"

#include "tests/cluster_simplify/collapsing.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::Each;
using testing::ElementsAre;

std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> result(count);
  std::iota(result.begin(), result.end(), 0U);
  return result;
}

Contraction choose(const BuildTile& tile, std::uint32_t target) {
  return tests::Collapsing(tile).choose(target);
}

void expect_onto(const Contraction& found, std::uint32_t target) {
  ASSERT_EQ(found.representatives.size(), target);
  std::vector<bool> met(target);
  for (const std::uint32_t parent : found.parent_of)
    met.at(parent) = true;
  EXPECT_THAT(met, Each(true));
}

TEST(RepresentativesTest, WithoutCollapsesEveryVertexStandsForItself) {
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    SCOPED_TRACE(name);
    BuildTile tile = tests::tile_of(mesh);
    tests::add_attributes(tile);
    const Contraction found = choose(tile, tile.mesh.own_count);
    EXPECT_EQ(found.parent_of, identity(tile.mesh.own_count));
    EXPECT_EQ(found.representatives.positions, mesh.positions);
    EXPECT_EQ(found.representatives.attributes, tile.mesh.vertices.attributes);
    EXPECT_EQ(found.fallbacks.joined, 0U);
  }
}

TEST(RepresentativesTest, CollapsedVerticesGoWhereTheyWent) {
  const BuildTile tile = tests::tile_of(tests::open_grid(3, 1));
  tests::Collapsing collapsing(tile);
  collapsing.collapse(0, 1);
  collapsing.collapse(1, 2);
  collapsing.collapse(4, 5);
  const Contraction found = collapsing.choose(5);
  EXPECT_THAT(found.parent_of, ElementsAre(0U, 0U, 0U, 1U, 2U, 2U, 3U, 4U));
  EXPECT_THAT(
      found.representatives.positions,
      ElementsAre(Vec3f{2, 0, 0}, Vec3f{3, 0, 0}, Vec3f{1, 1, 0}, Vec3f{2, 1, 0}, Vec3f{3, 1, 0}));
  EXPECT_EQ(found.fallbacks.joined, 0U);
}

TEST(RepresentativesTest, ALoneVertexGoesIntoTheNearestThatShows) {
  tests::TestMesh mesh{{{9, 0.2F, 0}, {0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {1, 0.5F, 0}, {1, 8, 0}},
                       {{1, 2, 3}}};
  const Contraction found = choose(tests::tile_of(mesh), 3);
  EXPECT_THAT(found.parent_of, ElementsAre(1U, 0U, 1U, 2U, 0U, 2U));
  EXPECT_THAT(found.representatives.positions,
              ElementsAre(mesh.positions[1], mesh.positions[2], mesh.positions[3]));
  EXPECT_EQ(found.fallbacks.joined, 0U);
}

TEST(RepresentativesTest, LoneVerticesFillTheCountAsWellAsTheyCan) {
  // A triangle, and two heaps of lone vertices far from each other.
  tests::TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (int i = 0; i < 5; ++i)
    mesh.positions.push_back({100, static_cast<float>(i), 0});
  for (int i = 0; i < 5; ++i)
    mesh.positions.push_back({-100, static_cast<float>(i), 0});
  const Contraction found = choose(tests::tile_of(mesh), 5);
  expect_onto(found, 5);
  EXPECT_EQ(found.representatives.positions[3], (Vec3f{100, 2, 0}));  // nearest to the mean
  EXPECT_EQ(found.representatives.positions[4], (Vec3f{-100, 2, 0}));
  for (std::uint32_t v = 3; v < 8; ++v)
    EXPECT_EQ(found.parent_of[v], 3U);
  for (std::uint32_t v = 8; v < 13; ++v)
    EXPECT_EQ(found.parent_of[v], 4U);
}

TEST(RepresentativesTest, PiecesThatCannotCollapseAreJoinedWithTheirNeighbours) {
  // Pairs of vertices, each with a triangle of its own to two ghosts.
  tests::TestMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({static_cast<float>(10 * (i / 2)), static_cast<float>(i % 2), 0});
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 9}, {1, 0, 9}});
  for (std::uint32_t v = 0; v < 8; ++v)
    mesh.triangles.push_back({v, 8, 9});
  const Contraction found = choose(tests::tile_of(mesh, 8), 4);
  expect_onto(found, 4);
  EXPECT_EQ(found.fallbacks.joined, 4U);
  for (std::uint32_t v = 0; v < 8; v += 2) {
    EXPECT_EQ(found.parent_of[v], found.parent_of[v + 1]);
    const Vec3f place = found.representatives.positions[found.parent_of[v]];
    EXPECT_TRUE(place == mesh.positions[v] || place == mesh.positions[v + 1]);
  }
}

TEST(RepresentativesTest, ALoneVertexFollowsTheOneThatWasJoined) {
  tests::TestMesh mesh = tests::soup(10);
  tests::append(mesh, tests::points(20));
  for (const std::uint32_t target : {1U, 2U, 5U, 29U, 30U, 31U, 49U, 50U}) {
    const BuildTile tile = tests::tile_of(mesh);
    const Contraction found = choose(tile, target);
    expect_onto(found, target);
    EXPECT_EQ(found.fallbacks.joined, target < 30 ? 30 - target : 0);
    for (std::uint32_t v = 0; v < 30 && target >= 30; ++v)
      EXPECT_EQ(found.representatives.positions[found.parent_of[v]], mesh.positions[v]);
  }
}

TEST(RepresentativesTest, TakesTheVerticesAsTheyAreNow) {
  const BuildTile tile = tests::tile_of(tests::open_grid(1, 1));
  tests::Collapsing collapsing(tile);
  collapsing.collapse(1, 0, collapsing.frame().to_local(Vec3f{0.5F, -7, 3}));
  const Contraction found = collapsing.choose(3);
  EXPECT_THAT(found.representatives.positions,
              ElementsAre(Vec3f{0.5F, -7, 3}, Vec3f{0, 1, 0}, Vec3f{1, 1, 0}));
  EXPECT_THAT(found.parent_of, ElementsAre(0U, 0U, 1U, 2U));
}

TEST(RepresentativesTest, GhostsAreNeitherChosenNorCounted) {
  // The ghost is nearer to the lone vertex than the own ones.
  const tests::TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {3, 3, 0}, {3, 3, 0.1F}}, {{0, 1, 3}}};
  const Contraction found = choose(tests::tile_of(mesh, 3), 2);
  EXPECT_THAT(found.parent_of, ElementsAre(0U, 1U, 1U));
  EXPECT_THAT(found.representatives.positions, ElementsAre(Vec3f{0, 0, 0}, Vec3f{1, 0, 0}));
}

}  // namespace
}  // namespace meshhier::cluster_simplify
