#include "cluster_simplify/nearest.h"

#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::Each;
using testing::ElementsAre;

double squared_distance(Vec3f a, Vec3f b) {
  const Vec3d away = to_double(a) - to_double(b);
  return dot(away, away);
}

/// All candidates are looked at.
void expect_nearest(const std::vector<Vec3f>& positions,
                    const std::vector<std::uint32_t>& candidates,
                    const std::vector<std::uint32_t>& asked) {
  const std::vector<std::uint32_t> found = nearest_of(positions, candidates, asked);
  ASSERT_EQ(found.size(), asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : candidates)
      least = std::min(least, squared_distance(positions[v], positions[asked[i]]));
    ASSERT_TRUE(std::ranges::count(candidates, found[i]) == 1);
    ASSERT_EQ(squared_distance(positions[found[i]], positions[asked[i]]), least);
  }
}

/// Every third vertex is a candidate, the others ask.
std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>> split(std::size_t count) {
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint32_t> asked;
  for (std::uint32_t v = 0; v < count; ++v)
    (v % 3 == 0 ? candidates : asked).push_back(v);
  return {candidates, asked};
}

TEST(NearestTest, IsTheNearestOfAll) {
  for (const tests::TestMesh& mesh :
       {tests::points(900), tests::sphere(1000), tests::open_grid(30, 20), tests::open_grid(400, 0),
        tests::duplicates(800)}) {
    const auto [candidates, asked] = split(mesh.positions.size());
    expect_nearest(mesh.positions, candidates, asked);
  }
}

TEST(NearestTest, HoldsAtAllMagnitudes) {
  for (const float unit : {1e30F, 1e-30F, 3e38F, 1e-44F}) {
    std::vector<Vec3f> positions = tests::points(300).positions;
    for (Vec3f& p : positions)
      p = p * unit;
    const auto [candidates, asked] = split(positions.size());
    expect_nearest(positions, candidates, asked);
  }
}

TEST(NearestTest, AsksInTheOrderGiven) {
  const std::vector<Vec3f> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 0, 0}, {10, 0, 0}};
  const std::vector<std::uint32_t> candidates = {4, 0};
  const std::vector<std::uint32_t> asked = {3, 1, 2, 3, 0};
  EXPECT_THAT(nearest_of(line, candidates, asked), ElementsAre(4U, 0U, 0U, 4U, 0U));
}

TEST(NearestTest, OneCandidateIsNearestToAll) {
  const std::vector<Vec3f> positions = tests::points(50).positions;
  std::vector<std::uint32_t> asked(50);
  std::iota(asked.begin(), asked.end(), 0U);
  EXPECT_THAT(nearest_of(positions, std::vector<std::uint32_t>{17}, asked), Each(17U));
}

TEST(NearestTest, NobodyAskedNobodyAnswered) {
  const std::vector<Vec3f> positions(1);
  EXPECT_TRUE(nearest_of(positions, std::vector<std::uint32_t>{0}, {}).empty());
}

TEST(NearestTest, ThousandsInOnePlaceAreFoundAndAlwaysTheSame) {
  const std::vector<Vec3f> positions(3000, Vec3f{1, 2, 3});
  const auto [candidates, asked] = split(positions.size());
  const std::vector<std::uint32_t> first = nearest_of(positions, candidates, asked);
  for (const std::uint32_t v : first)
    ASSERT_EQ(v % 3, 0U);
  EXPECT_EQ(nearest_of(std::vector<Vec3f>(positions), candidates, asked), first);
}

TEST(NearestTest, OfEquallyNearOnesTheFirstIsFound) {
  const tests::TestMesh grid = tests::open_grid(60, 60);  // every third vertex: ties everywhere
  const auto [candidates, asked] = split(grid.positions.size());
  const std::vector<std::uint32_t> found = nearest_of(grid.positions, candidates, asked);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const auto away = [&](std::uint32_t v) {
      return squared_distance(grid.positions[v], grid.positions[asked[i]]);
    };
    ASSERT_EQ(found[i], *std::ranges::min_element(candidates, {}, away));
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
