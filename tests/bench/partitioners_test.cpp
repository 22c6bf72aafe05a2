#include "bench/partitioners.h"

#include "cluster_simplify/kd_cells.h"
#include "hierarchy/bounds.h"
#include "hierarchy/error.h"
#include "partition/top_tree.h"
#include "tests/bench/plain.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using testing::ElementsAre;

std::vector<std::uint64_t> sizes_of(const Parts& parts) {
  std::vector<std::uint64_t> sizes(parts.count);
  for (const std::uint32_t part : parts.part_of)
    ++sizes.at(part);
  return sizes;
}

std::vector<Bounds> boxes_of(std::span<const Vec3f> points, const Parts& parts) {
  std::vector<Bounds> boxes(parts.count);
  for (std::size_t i = 0; i < points.size(); ++i)
    boxes.at(parts.part_of[i]).add(points[i]);
  return boxes;
}

bool overlap(const Bounds& a, const Bounds& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
         a.min.z <= b.max.z && b.min.z <= a.max.z;
}

Parts kd(const PlainMesh& mesh, std::uint32_t count, partition::Axis axis) {
  const auto files = storage::make_posix_file_system();
  return kd_parts(mesh, count, axis, *files);
}

/// Two implementations of the same rule: the build's and the cells of `cluster`.
TEST(KdPartsTest, TheLongestAxisIsSplitAsCellsAre) {
  const PlainMesh small = plain(tests::torus(5000, 0.01F));
  EXPECT_EQ(kd(small, 21, partition::Axis::longest).part_of,
            cluster_simplify::kd_cells(small.positions, 21));
}

TEST(KdPartsTest, ChunksAreSplitAsTheWholeIs) {
  const PlainMesh large = plain(tests::shuffled(tests::sphere(2 * 150'000, 0.001F), 1));
  ASSERT_GT(large.positions.size(), partition::kChunkVertices);
  EXPECT_EQ(kd(large, 50, partition::Axis::longest).part_of,
            cluster_simplify::kd_cells(large.positions, 50));
}

TEST(KdPartsTest, SizesDifferByOne) {
  const PlainMesh mesh = plain(tests::genus_n(2, 4000));
  const Parts parts = kd(mesh, 33, partition::Axis::compactness);
  ASSERT_EQ(parts.count, 33U);
  const auto sizes = sizes_of(parts);
  EXPECT_LE(*std::ranges::max_element(sizes) - *std::ranges::min_element(sizes), 1U);
}

TEST(KdPartsTest, CompactnessBeatsTheLongestAxis) {
  const PlainMesh mesh = plain(tests::genus_n(5, 40'000, 0.001F));
  const auto mean = [&](partition::Axis axis) {
    return measure_parts(mesh, kd(mesh, 64, axis)).mean_compactness;
  };
  EXPECT_LT(mean(partition::Axis::compactness), mean(partition::Axis::longest));
}

TEST(OctreeTest, LeavesAreDisjointAndAsManyAsAsked) {
  const tests::TestMesh mesh = tests::sphere(20'000, 0.001F);
  for (const std::uint32_t asked : {1U, 2U, 64U, 128U, 1000U}) {
    const Parts parts = octree_parts(mesh.positions, asked);
    EXPECT_GE(parts.count, asked);
    EXPECT_LE(parts.count, asked + 6);
    const auto sizes = sizes_of(parts);
    EXPECT_GT(*std::ranges::min_element(sizes), 0U);
    if (asked > 128)
      continue;
    const auto boxes = boxes_of(mesh.positions, parts);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_FALSE(overlap(boxes[i], boxes[j])) << i << " and " << j << " of " << asked;
    }
  }
}

TEST(OctreeTest, CellsAreCutAtTheMiddleOfTheCube) {
  // The cube is [0, 8]^3 although the points span less in y and z.
  const std::vector<Vec3f> points = {{0, 0, 0}, {3.9F, 3.9F, 3.9F}, {4, 0, 0}, {8, 4.1F, 1}};
  EXPECT_THAT(octree_parts(points, 2).part_of, ElementsAre(0, 0, 1, 2));
}

TEST(OctreeTest, TheFullestCellIsCutFirst) {
  std::vector<Vec3f> points;
  for (int corner = 0; corner < 8; ++corner) {
    points.push_back({corner & 4 ? 1.0F : 0.0F, corner & 2 ? 1.0F : 0.0F, corner & 1 ? 1.0F : 0});
  }
  for (int i = 0; i < 20; ++i)
    points.push_back({0.9F, 0.9F, 0.55F + 0.02F * static_cast<float>(i)});
  EXPECT_EQ(sizes_of(octree_parts(points, 8)),
            (std::vector<std::uint64_t>{1, 1, 1, 1, 1, 1, 1, 21}));
  std::vector<Vec3f> more = points;
  for (int i = 0; i < 10; ++i)  // fewer, in a cell that comes earlier
    more.push_back({0.1F, 0.1F, 0.05F + 0.04F * static_cast<float>(i)});
  EXPECT_EQ(sizes_of(octree_parts(more, 9)),
            (std::vector<std::uint64_t>{11, 1, 1, 1, 1, 1, 1, 10, 11}));
  // [0.5, 1]^3 is cut at z = 0.75: ten points below, ten and the corner above.
  EXPECT_EQ(sizes_of(octree_parts(points, 9)),
            (std::vector<std::uint64_t>{1, 1, 1, 1, 1, 1, 1, 10, 11}));
}

TEST(OctreeTest, EqualPointsStayTogether) {
  std::vector<Vec3f> points(100, {1, 2, 3});
  EXPECT_EQ(octree_parts(points, 5).count, 1U);
  points.push_back({1, 2, std::nextafter(3.0F, 4.0F)});
  const Parts parts = octree_parts(points, 5);
  EXPECT_EQ(parts.count, 2U);
  EXPECT_EQ(parts.part_of.back(), 1U);
}

TEST(OctreeTest, ExtremeCoordinatesEnd) {
  const float most = std::numeric_limits<float>::max();
  const float least = std::numeric_limits<float>::denorm_min();
  const std::vector<Vec3f> points = {{-most, 0, 0}, {0, 0, 0}, {least, 0, 0}, {most, most, 1}};
  const Parts parts = octree_parts(points, 4);
  EXPECT_EQ(parts.count, 3U);  // what a cell of 2^-64 of the cube holds counts as one point
  EXPECT_EQ(parts.part_of[1], parts.part_of[2]);
}

/// Each point's part is the first of those whose mean is nearest.
void expect_nearest_means(std::span<const Vec3f> points, const Parts& parts) {
  std::vector<Vec3d> means(parts.count);
  const auto sizes = sizes_of(parts);
  for (std::size_t i = 0; i < points.size(); ++i)
    means[parts.part_of[i]] = means[parts.part_of[i]] + to_double(points[i]);
  for (std::size_t m = 0; m < means.size(); ++m)
    means[m] = means[m] * (1.0 / static_cast<double>(sizes[m]));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto distance = [&](const Vec3d& mean) { return length(to_double(points[i]) - mean); };
    const double least = distance(*std::ranges::min_element(means, {}, distance));
    EXPECT_NEAR(distance(means[parts.part_of[i]]), least, 1e-12) << i;
  }
}

TEST(KMeansTest, AConvergedDivisionHasNearestMeans) {
  const tests::TestMesh mesh = tests::torus(3000, 0.02F);
  const KMeansParts result = kmeans_parts(mesh.positions, 24, 1000);
  ASSERT_TRUE(result.converged);
  EXPECT_GT(result.iterations, 1);
  EXPECT_EQ(result.parts.count, 24U);
  expect_nearest_means(mesh.positions, result.parts);
}

TEST(KMeansTest, FarGroupsAreFound) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 90; ++i) {
    const auto group = static_cast<float>(i % 3);
    points.push_back({100 * group * group, tests::hash_noise(static_cast<std::uint64_t>(i), 0), 0});
  }
  const KMeansParts result = kmeans_parts(points, 3, 50);
  ASSERT_TRUE(result.converged);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_EQ(result.parts.part_of[i] == result.parts.part_of[j], i % 3 == j % 3);
    }
  }
}

TEST(KMeansTest, FewerDistinctPointsMakeFewerParts) {
  std::vector<Vec3f> points(10, {1, 1, 1});
  points.resize(15, {2, 2, 2});
  const KMeansParts result = kmeans_parts(points, 4, 50);
  EXPECT_EQ(result.parts.count, 2U);
  EXPECT_NE(result.parts.part_of.front(), result.parts.part_of.back());
}

TEST(KMeansTest, IterationsAreLimited) {
  const tests::TestMesh mesh = tests::sphere(5000);
  const KMeansParts result = kmeans_parts(mesh.positions, 40, 1);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_FALSE(result.converged);
  EXPECT_NE(result.parts.part_of, kmeans_parts(mesh.positions, 40, 20).parts.part_of);
}

TEST(PartitionersTest, MorePartsThanPointsAreRefused) {
  const PlainMesh mesh = plain(tests::points(5));
  EXPECT_THROW(kd(mesh, 6, partition::Axis::longest), Error);
  EXPECT_THROW(octree_parts(mesh.positions, 6), Error);
  EXPECT_THROW(kmeans_parts(mesh.positions, 6, 10), Error);
  EXPECT_EQ(kd(mesh, 5, partition::Axis::longest).count, 5U);
  EXPECT_EQ(octree_parts(mesh.positions, 5).count, 5U);
  EXPECT_EQ(kmeans_parts(mesh.positions, 5, 10).parts.count, 5U);
}

/// The figures that docs/performance.md compares with.
TEST(PartitionersTest, TheDragonHasItsKnownCompactness) {
  const std::filesystem::path path = std::filesystem::path(MESHHIER_MODELS_DIR) / "dragon_vrip.ply";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << path << " is not there";
  const auto files = storage::make_posix_file_system();
  const PlainMesh mesh = plain_mesh(load_mesh(*mesh_io::open_mesh(*files, path)));
  const PartFigures longest = measure_parts(mesh, kd(mesh, 128, partition::Axis::longest));
  EXPECT_NEAR(longest.mean_compactness, 4.89, 0.005);
  EXPECT_EQ(longest.most_vertices - longest.least_vertices, 1U);
  EXPECT_LT(measure_parts(mesh, kd(mesh, 128, partition::Axis::compactness)).mean_compactness, 3.9);
}

}  // namespace
}  // namespace meshhier::bench
