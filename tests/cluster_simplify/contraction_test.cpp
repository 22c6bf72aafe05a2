#include "cluster_simplify/contraction.h"

#include "cluster_simplify/cluster.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

constexpr std::array kAll{Representative::mean, Representative::quadric, Representative::vertex};

BuildTile sphere_tile() {
  const tests::TestMesh mesh = tests::sphere(1500, 0.03F);
  BuildTile tile;
  tile.mesh.vertices.positions = mesh.positions;
  tile.mesh.own_count = static_cast<std::uint32_t>(mesh.positions.size());
  tile.history.weights.assign(mesh.positions.size(), 1);
  tile.history.radii.assign(mesh.positions.size(), 0);
  for (const tests::MeshTriangle& t : mesh.triangles)
    tile.mesh.interior.push_back({TileVertex{t[0]}, TileVertex{t[1]}, TileVertex{t[2]}});
  return tile;
}

TEST(ContractionTargetTest, IsWhatWasAskedWhereThereAreEnoughVertices) {
  EXPECT_EQ(contraction_target(16384, 8192), 8192U);
  EXPECT_EQ(contraction_target(65536, 32768), 32768U);
  EXPECT_EQ(contraction_target(8, 6), 6U);
}

TEST(ContractionTargetTest, IsAlwaysCoarserThanBelow) {
  EXPECT_EQ(contraction_target(40, 50), 30U);
  EXPECT_EQ(contraction_target(50, 50), 37U);
  for (std::uint32_t count = 2; count < 100; ++count) {
    for (const std::uint32_t asked : {4U, 5U, 50U, 32768U})
      EXPECT_LT(contraction_target(count, asked), count);
  }
}

TEST(ContractionTargetTest, IsAtLeastOne) {
  EXPECT_EQ(contraction_target(1, 4), 1U);
  EXPECT_EQ(contraction_target(2, 4), 1U);
}

TEST(ContractTest, ClusterIsTheMethodOfThatName) {
  const BuildTile tile = sphere_tile();
  for (const Representative representative : kAll) {
    const Contraction found = contract(tile, 100, {}, {Method::cluster, representative});
    const Contraction expected = cluster(tile, 100, {}, representative);
    EXPECT_EQ(found.parent_of, expected.parent_of);
    EXPECT_EQ(found.representatives.positions, expected.representatives.positions);
  }
}

TEST(ContractTest, TheParentMapIsOnto) {
  const BuildTile tile = sphere_tile();
  for (const std::uint32_t target : {1U, 2U, 3U, 99U, tile.mesh.own_count}) {
    const Contraction found = contract(tile, target, {}, {});
    ASSERT_EQ(found.parent_of.size(), tile.mesh.own_count);
    ASSERT_EQ(found.representatives.size(), target);
    std::vector<bool> met(target);
    for (const std::uint32_t parent : found.parent_of)
      met.at(parent) = true;
    EXPECT_EQ(std::count(met.begin(), met.end(), true), target);
  }
}

TEST(ContractTest, AsManyRepresentativesAsVerticesMovesNone) {
  const BuildTile tile = sphere_tile();
  for (const Representative representative : kAll) {
    const Contraction found =
        contract(tile, tile.mesh.own_count, {}, {Method::cluster, representative});
    for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i) {
      ASSERT_EQ(found.representatives.positions[found.parent_of[i]],
                tile.mesh.vertices.positions[i]);
    }
  }
}

TEST(ContractTest, TheOrderOfTheTrianglesHardlyMoves) {
  // Sums of planes may round differently, nothing else may change.
  BuildTile tile = sphere_tile();
  const Contraction before = contract(tile, 100, {}, {});
  std::ranges::reverse(tile.mesh.interior);
  const Contraction after = contract(tile, 100, {}, {});
  EXPECT_EQ(before.parent_of, after.parent_of);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_LT(length(before.representatives.positions[i] - after.representatives.positions[i]),
              1e-5F);
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
