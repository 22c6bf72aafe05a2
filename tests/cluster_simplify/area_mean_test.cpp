#include "cluster_simplify/area_mean.h"

#include "tests/cluster_simplify/test_tiles.h"

#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(AreaMeanTest, CountsWhatIsFarWithItsArea) {
  AreaMean mean(1);
  mean.add(1, [] { return AreaMean::Patch{6, 1}; });
  mean.add(5, [] { return AreaMean::Patch{2, 16}; });
  EXPECT_DOUBLE_EQ(mean.value(), 2 * 16 / (2.0 + 32 * 6));  // the near one stands for 32
}

TEST(AreaMeanTest, MeasuresFewOfManyThatAreNear) {
  AreaMean mean(1);
  int measured = 0;
  for (int i = 0; i < 3200; ++i) {
    mean.add(0.5, [&] {
      ++measured;
      return AreaMean::Patch{1, 0.25};
    });
  }
  mean.add(2, [] { return AreaMean::Patch{3200, 4}; });
  EXPECT_EQ(measured, 100);
  EXPECT_DOUBLE_EQ(mean.value(), 2);
}

TEST(AreaMeanTest, InfinitelyFarIsInfiniteButWithoutArea) {
  AreaMean mean(1);
  EXPECT_EQ(mean.value(), 0);
  mean.add(kInfinity, [] { return AreaMean::Patch{0, kInfinity}; });
  EXPECT_EQ(mean.value(), 0);
  mean.add(kInfinity, [] { return AreaMean::Patch{1, kInfinity}; });
  EXPECT_EQ(mean.value(), kInfinity);
}

TEST(AreaMeanTest, AVertexHasAThirdOfItsTriangles) {
  const BuildTile tile = tests::tile_of(tests::open_grid(2, 1));  // triangles of 1/2
  std::vector<double> moved(6);
  moved[0] = 9;
  double triangles = 0;
  for (const TileTriangle& t : tile.mesh.interior)
    triangles += raw(t[0]) == 0 || raw(t[1]) == 0 || raw(t[2]) == 0 ? 1 : 0;
  EXPECT_DOUBLE_EQ(mean_over_joined(tile.mesh, moved, {}, 8), 27 * triangles / (triangles + 32));
  const std::vector<LostArea> lost = {{triangles + 32, 30}};
  EXPECT_DOUBLE_EQ(mean_over_joined(tile.mesh, moved, lost, 8),
                   (27 * triangles / (triangles + 32) + 300) / 2);
}

TEST(AreaMeanTest, ASpikeWhoseFootBecameNarrowKeepsItsArea) {
  BuildTile tile = tests::tile_of(tests::open_grid(2, 1));
  const TileTriangle spike = tile.mesh.interior[0];
  std::vector<double> moved(6);
  moved[raw(spike[2])] = 9;
  tile.mesh.vertices.positions[raw(spike[0])] = {0, 0, 0};
  tile.mesh.vertices.positions[raw(spike[1])] = {1e-6F, 0, 0};
  tile.mesh.vertices.positions[raw(spike[2])] = {0, 0, 1e6F};
  EXPECT_GT(mean_over_joined(tile.mesh, moved, {}, 8), 26);  // 27, but for the rest
}

TEST(AreaMeanTest, HalfOfWhatIsCertainIsTypicalWithoutCare) {
  DrawnMean mean(1, 1);
  mean.add(20, [] { return std::array{Vec3f{0, 0, 0}, Vec3f{3, 0, 0}, Vec3f{0, 3, 0}}; });
  EXPECT_DOUBLE_EQ(mean.value(), 100);
}

TEST(AreaMeanTest, ATenthOfWhatIsCertainIsTypicalOfWhatIsDrawn) {
  DrawnMean mean(1);
  const auto corners = [] { return std::array{Vec3f{0, 0, 0}, Vec3f{3, 0, 0}, Vec3f{0, 3, 0}}; };
  mean.add(20, corners);
  EXPECT_DOUBLE_EQ(mean.value(), 4);
  mean.add(9, corners);
  EXPECT_DOUBLE_EQ(mean.value(), 4.0 / 33);
}

}  // namespace
}  // namespace meshhier::cluster_simplify
