#include "partition/direction.h"

#include "base/bounds.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

using tests::hash_noise;

/// Points in a box of these half lengths, turned by `turn` about z.
std::vector<Vec3f> box_points(std::size_t count, Vec3d half, double turn = 0) {
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = half.x * hash_noise(i, 1);
    const double y = half.y * hash_noise(i, 2);
    const double z = half.z * hash_noise(i, 3);
    points.push_back(to_float(Vec3d{x * std::cos(turn) - y * std::sin(turn),
                                    x * std::sin(turn) + y * std::cos(turn), z}));
  }
  return points;
}

double cosine(Vec3d a, Vec3d b) {
  return std::abs(dot(a, b)) / (length(a) * length(b));
}

TEST(Direction, LongestIsTheLongestAxisOfTheBox) {
  const auto axis_of = [](Vec3d half) {
    return candidate_directions(box_points(100, half), Axis::longest);
  };
  EXPECT_EQ(axis_of({3, 2, 1}), (std::vector<Vec3d>{{1, 0, 0}}));
  EXPECT_EQ(axis_of({1, 3, 2}), (std::vector<Vec3d>{{0, 1, 0}}));
  EXPECT_EQ(axis_of({1, 2, 3}), (std::vector<Vec3d>{{0, 0, 1}}));
}

TEST(Direction, OfEqualAxesTheFirstIsTheLongest) {
  const std::vector<Vec3f> cube{{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(candidate_directions(cube, Axis::longest), (std::vector<Vec3d>{{1, 0, 0}}));
  const std::vector<Vec3f> plate{{0, 0, 0}, {0.5F, 1, 1}};
  EXPECT_EQ(candidate_directions(plate, Axis::longest), (std::vector<Vec3d>{{0, 1, 0}}));
}

TEST(Direction, LongestIsExactForLengthsThatOverflowFloat) {
  const std::vector<Vec3f> points{{-3e38F, -2e38F, 0}, {2e38F, 3.1e38F, 1}};
  EXPECT_EQ(candidate_directions(points, Axis::longest), (std::vector<Vec3d>{{0, 1, 0}}));
}

TEST(Direction, CompactnessHasAxesDiagonalsAndPrincipalAxesAllOfUnitLength) {
  const auto candidates = candidate_directions(box_points(500, {3, 2, 1}, 0.4), Axis::compactness);
  ASSERT_EQ(candidates.size(), 12U);
  for (const Vec3d& direction : candidates)
    EXPECT_NEAR(length(direction), 1, 1e-9);
  for (std::size_t i = 0; i < 9; ++i) {  // all differ, also but for their sign
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_LT(cosine(candidates[i], candidates[j]), 0.9);
  }
}

TEST(Direction, PrincipalAxesAreOrthogonalAndFollowTheCloud) {
  const double turn = 0.4;
  const auto candidates =
      candidate_directions(box_points(2000, {5, 2, 1}, turn), Axis::compactness);
  const Vec3d along{std::cos(turn), std::sin(turn), 0};
  double best = 0;
  for (std::size_t i = 9; i < 12; ++i) {
    best = std::max(best, cosine(candidates[i], along));
    for (std::size_t j = 9; j < i; ++j)
      EXPECT_NEAR(cosine(candidates[i], candidates[j]), 0, 1e-9);
  }
  EXPECT_GT(best, 0.999);
}

TEST(Direction, CandidatesOfTinyAndHugeModelsAreFinite) {
  for (const double scale : {1e-44, 1e-30, 1e30, 1e38}) {
    const auto points = box_points(300, {3 * scale, 2 * scale, scale}, 0.4);
    const auto candidates = candidate_directions(points, Axis::compactness);
    ASSERT_EQ(candidates.size(), 12U) << scale;
    for (const Vec3d& direction : candidates)
      EXPECT_NEAR(length(direction), 1, 1e-6) << scale;
  }
}

TEST(Direction, EqualPointsHaveCandidatesToo) {
  const std::vector<Vec3f> points(10, Vec3f{1, 2, 3});
  for (const Axis axis : {Axis::longest, Axis::compactness}) {
    const auto candidates = candidate_directions(points, axis);
    ASSERT_FALSE(candidates.empty());
    for (const Vec3d& direction : candidates)
      EXPECT_NEAR(length(direction), 1, 1e-9);
  }
  EXPECT_EQ(candidate_directions(std::span(points).first(1), Axis::compactness).size(), 1U);
}

const std::vector<Vec3d> kAxes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(Direction, ThinnestCutsADumbbellAtItsNeck) {
  std::vector<Vec3f> points;
  for (const double side : {-4.0, 4.0}) {
    for (const Vec3f& p : box_points(500, {1, 2, 2}))
      points.push_back(p + to_float(Vec3d{0, side, 0}));
  }
  EXPECT_EQ(thinnest_direction(points, 0.5, kAxes), (Vec3d{0, 1, 0}));
}

TEST(Direction, ThinnestLooksAtTheQuantileAskedFor) {
  // Two clusters along x of a quarter and three quarters; along y the points are evenly spread.
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < 1000; ++i) {
    const float x = (i % 4 == 0 ? 0.0F : 3.0F) + 0.2F * hash_noise(i, 1);
    points.push_back({x, 2 * hash_noise(i, 2), 0});
  }
  const std::vector<Vec3d> candidates{{0, 1, 0}, {1, 0, 0}};
  EXPECT_EQ(thinnest_direction(points, 0.25, candidates), (Vec3d{1, 0, 0}));
  EXPECT_EQ(thinnest_direction(points, 0.6, candidates), (Vec3d{0, 1, 0}));
}

TEST(Direction, ThinnestMeasuresInUnitsOfLength) {
  const auto points = box_points(1000, {2, 1, 1});
  const std::vector<Vec3d> candidates{{0, 1000, 0}, {0.001, 0, 0}};
  EXPECT_EQ(thinnest_direction(points, 0.5, candidates), candidates[1]);
}

TEST(Direction, ThinnestTakesExtremeFractionsAndFewPoints) {
  for (const std::size_t count : {1U, 2U, 3U}) {
    const auto points = box_points(count, {3, 2, 1});
    for (const double fraction : {0.0, 1e-9, 0.5, 1.0}) {
      const Vec3d found = thinnest_direction(points, fraction, kAxes);
      EXPECT_NE(std::find(kAxes.begin(), kAxes.end(), found), kAxes.end());
    }
  }
}

// Only some of many points are looked at; the neck must be seen in them.
TEST(Direction, ThinnestOfManyPointsIsTheNeckToo) {
  std::vector<Vec3f> points;
  for (const double side : {-4.0, 4.0}) {
    for (const Vec3f& p : box_points(60000, {1, 2, 2}))
      points.push_back(p + to_float(Vec3d{0, side, 0}));
  }
  EXPECT_EQ(thinnest_direction(points, 0.5, kAxes), (Vec3d{0, 1, 0}));
}

}  // namespace
}  // namespace meshhier::partition
