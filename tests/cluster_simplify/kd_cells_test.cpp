#include "cluster_simplify/kd_cells.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::ElementsAre;

std::vector<Vec3f> random_points(std::size_t count, std::uint64_t seed) {
  std::vector<Vec3f> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = {tests::hash_noise(i, seed), tests::hash_noise(i, seed + 1),
                 tests::hash_noise(i, seed + 2)};
  }
  return points;
}

/// The contract once more, by whole sorts: what kd_cells() must return.
class ReferenceCells {
 public:
  ReferenceCells(std::span<const Vec3f> points, std::uint32_t cells)
      : points_(points), cells_(cells), order_(points.size()), cell_of_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    split(0, cells);
  }
  const std::vector<std::uint32_t>& cell_of() const { return cell_of_; }

 private:
  std::size_t place(std::uint32_t cell) const {
    return std::uint64_t{cell} * points_.size() / cells_;
  }

  int longest_axis(std::span<const std::uint32_t> part) const {
    int best = 0;
    float longest = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] =
          std::ranges::minmax_element(part, {}, [&](std::uint32_t i) { return points_[i][axis]; });
      const float size = points_[*high][axis] - points_[*low][axis];
      if (size > longest) {
        longest = size;
        best = axis;
      }
    }
    return best;
  }

  void split(std::uint32_t begin, std::uint32_t end) {
    const std::span<std::uint32_t> part =
        std::span(order_).subspan(place(begin), place(end) - place(begin));
    if (end - begin == 1) {
      for (const std::uint32_t i : part)
        cell_of_[i] = begin;
      return;
    }
    const int axis = longest_axis(part);
    std::ranges::sort(part);
    std::ranges::stable_sort(part, {}, [&](std::uint32_t i) { return points_[i][axis]; });
    const std::uint32_t middle = begin + (end - begin + 1) / 2;
    split(begin, middle);
    split(middle, end);
  }

  std::span<const Vec3f> points_;
  std::uint32_t cells_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> cell_of_;
};

std::vector<std::uint32_t> sizes_of(const std::vector<std::uint32_t>& cell_of,
                                    std::uint32_t cells) {
  std::vector<std::uint32_t> sizes(cells);
  for (const std::uint32_t cell : cell_of)
    ++sizes.at(cell);
  return sizes;
}

TEST(KdCellsTest, SizesDifferByAtMostOneForAnyPairOfCounts) {
  for (const std::uint32_t count : {1U, 2U, 3U, 7U, 64U, 100U, 257U}) {
    const std::vector<Vec3f> points = random_points(count, 3);
    for (std::uint32_t cells = 1; cells <= count; ++cells) {
      const std::vector<std::uint32_t> sizes = sizes_of(kd_cells(points, cells), cells);
      ASSERT_GE(*std::ranges::min_element(sizes), count / cells) << count << " in " << cells;
      ASSERT_LE(*std::ranges::max_element(sizes), (count + cells - 1) / cells)
          << count << " in " << cells;
    }
  }
}

TEST(KdCellsTest, SplitsAtExactMediansAlongTheLongestAxis) {
  for (const std::uint32_t cells : {1U, 2U, 3U, 10U, 333U, 1000U}) {
    const std::vector<Vec3f> points = random_points(1000, 40 + cells);
    EXPECT_EQ(kd_cells(points, cells), ReferenceCells(points, cells).cell_of())
        << cells << " cells";
  }
}

TEST(KdCellsTest, EqualCoordinatesAreOrderedByIndex) {
  const std::vector<Vec3f> same(7, Vec3f{2, 2, 2});
  EXPECT_THAT(kd_cells(same, 3), ElementsAre(0, 0, 1, 1, 2, 2, 2));

  std::vector<Vec3f> lattice;  // many ties in every axis
  for (int i = 0; i < 512; ++i) {
    lattice.push_back({static_cast<float>(i * 5 % 8), static_cast<float>(i * 3 / 8 % 8),
                       static_cast<float>(i / 64)});
  }
  EXPECT_EQ(kd_cells(lattice, 37), ReferenceCells(lattice, 37).cell_of());
}

TEST(KdCellsTest, CellsAreNumberedAlongTheSplitAxis) {
  const std::vector<Vec3f> line = {{0, 3, 0}, {0, 0, 0}, {0, 2, 0}, {0, 1, 0}};
  EXPECT_THAT(kd_cells(line, 4), ElementsAre(3, 0, 2, 1));
}

TEST(KdCellsTest, EveryPointItsOwnCellIsAPermutation) {
  const std::vector<Vec3f> points = random_points(300, 8);
  std::vector<std::uint32_t> cells = kd_cells(points, 300);
  std::ranges::sort(cells);
  std::vector<std::uint32_t> all(300);
  std::iota(all.begin(), all.end(), 0U);
  EXPECT_EQ(cells, all);
}

TEST(KdCellsTest, TheOrderOfThePointsDoesNotMatterWithoutTies) {
  const std::vector<Vec3f> points = random_points(500, 21);
  const std::vector<Vec3f> reversed(points.rbegin(), points.rend());
  std::vector<std::uint32_t> cells = kd_cells(reversed, 60);
  std::ranges::reverse(cells);
  EXPECT_EQ(cells, kd_cells(points, 60));
}

TEST(KdCellsTest, ExtremeCoordinatesDoNotMatter) {
  constexpr float kHuge = 3e38F;  // differences overflow to infinity
  std::vector<Vec3f> points = random_points(100, 5);
  for (Vec3f& p : points)
    p = p * kHuge;
  EXPECT_THAT(sizes_of(kd_cells(points, 10), 10), testing::Each(10U));
  for (Vec3f& p : points)
    p = p * 1e-38F * 1e-38F;
  EXPECT_THAT(sizes_of(kd_cells(points, 10), 10), testing::Each(10U));
}

}  // namespace
}  // namespace meshhier::cluster_simplify
