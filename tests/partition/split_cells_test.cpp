#include "partition/split_cells.h"

#include "partition/split_plane.h"
#include "tests/support/meshes.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

using Split = SplitCells::Split;

/// Windows of about a hundredth of the box around planes of all kinds of directions.
std::vector<Split> splits_of(std::size_t count, Vec3f middle, float extent) {
  std::vector<Split> splits;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d direction{tests::hash_noise(i, 1), tests::hash_noise(i, 2),
                          tests::hash_noise(i, 3)};
    const double at = dot(direction, to_double(middle)) + tests::hash_noise(i, 4) * extent * 0.5;
    splits.push_back(
        {direction, ordered_bits(at - extent * 0.01), ordered_bits(at + extent * 0.01)});
  }
  return splits;
}

/// The node at which the way of a point from `node` on ends: at a leaf or in a window.
std::uint32_t end_of_way(const std::vector<Split>& splits, std::uint32_t node, Vec3f point) {
  while (node < splits.size()) {
    const std::uint64_t at = key_along(splits[node].direction, point, 0).projection;
    if (at >= splits[node].low && at <= splits[node].high)
      break;
    node = 2 * node + (at > splits[node].high ? 2 : 1);
  }
  return node;
}

/// The places of points do not matter: beside the box, far off, on its faces.
void expect_same_ways(Vec3f middle, float extent) {
  const std::vector<Split> splits = splits_of(127, middle, extent);
  const Vec3f half{extent / 2, extent / 2, extent / 2};
  const SplitCells cells(splits, {middle - half, middle + half});
  std::size_t skipped = 0;
  for (std::size_t i = 0; i < 100'000; ++i) {
    const float reach = i % 10 == 0 ? extent * 2 : extent / 2;
    Vec3f p =
        middle +
        Vec3f{tests::hash_noise(i, 5), tests::hash_noise(i, 6), tests::hash_noise(i, 7)} * reach;
    if (i % 7 == 0)
      p.x = middle.x - half.x;
    const std::uint32_t start = cells.start(p);
    skipped += start > 0 ? 1U : 0U;
    ASSERT_EQ(end_of_way(splits, start, p), end_of_way(splits, 0, p)) << i;
  }
  EXPECT_GT(skipped, 50'000U);
}

TEST(SplitCellsTest, WaysEndWhereTheyEndFromTheRoot) {
  expect_same_ways({0, 0, 0}, 2);
  expect_same_ways({100, -200, 300}, 1e-3F);  // a few units in the last place
  expect_same_ways({0, 0, 0}, 1e30F);
  expect_same_ways({1e-38F, 0, 0}, 1e-37F);
}

TEST(SplitCellsTest, FlatAndEmptyBoxes) {
  const std::vector<Split> splits = splits_of(31, {}, 1);
  for (const Bounds& box : {Bounds{{-1, -1, 0}, {1, 1, 0}}, Bounds{{0, 0, 0}, {0, 0, 0}}, Bounds{},
                            Bounds{{1e30F, 0, 0}, {1e30F, 1, 1}}}) {
    const SplitCells cells(splits, box);
    for (std::size_t i = 0; i < 10'000; ++i) {
      const Vec3f p{tests::hash_noise(i, 5), tests::hash_noise(i, 6),
                    i % 2 == 0 ? 0 : tests::hash_noise(i, 7)};
      ASSERT_EQ(end_of_way(splits, cells.start(p), p), end_of_way(splits, 0, p)) << i;
    }
    EXPECT_EQ(cells.start({3e38F, 3e38F, -3e38F}), 0U);
  }
}

TEST(SplitCellsTest, WithoutSplitsThereIsOneLeaf) {
  EXPECT_EQ(SplitCells({}, {{0, 0, 0}, {1, 1, 1}}).start({0.5F, 0.5F, 0.5F}), 0U);
}

}  // namespace
}  // namespace meshhier::partition
