#include "outline/polyline.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace meshhier::outline {
namespace {

using Segments = std::vector<std::array<std::uint32_t, 2>>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::vector<std::uint32_t>> traced(std::uint32_t nodes, const Segments& segments) {
  const Chains chains = trace_chains(nodes, segments);
  std::vector<std::vector<std::uint32_t>> result;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    result.emplace_back(chains[i].begin(), chains[i].end());
  }
  return result;
}

using Paths = std::vector<std::vector<std::uint32_t>>;

TEST(TraceChains, NothingAndNodesWithoutSegments) {
  EXPECT_EQ(traced(0, {}), Paths{});
  EXPECT_EQ(traced(5, {}), Paths{});
}

TEST(TraceChains, AnOpenChainStartsAtItsLesserEnd) {
  EXPECT_EQ(traced(5, {{4, 0}, {2, 0}, {1, 2}}), (Paths{{1, 2, 0, 4}}));
}

TEST(TraceChains, ALoopStartsAtItsLeastNodeAndRepeatsIt) {
  EXPECT_EQ(traced(6, {{5, 2}, {3, 5}, {1, 3}, {2, 1}}), (Paths{{1, 2, 5, 3, 1}}));
}

TEST(TraceChains, JunctionsEndChains) {
  // A theta: nodes 0 and 3 are joined by three ways.
  const Segments theta = {{0, 1}, {1, 3}, {0, 2}, {2, 3}, {0, 3}};
  EXPECT_EQ(traced(4, theta), (Paths{{0, 1, 3}, {0, 2, 3}, {0, 3}}));
}

TEST(TraceChains, ALoopThroughAJunctionIsTracedOnce) {
  // A flag: the loop 1 2 3 on the pole 0 1.
  EXPECT_EQ(traced(4, {{0, 1}, {1, 2}, {2, 3}, {3, 1}}), (Paths{{0, 1}, {1, 2, 3, 1}}));
  // A figure of eight.
  EXPECT_EQ(traced(5, {{2, 0}, {0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 2}}),
            (Paths{{2, 0, 1, 2}, {2, 3, 4, 2}}));
}

TEST(TraceChains, TheOrderOfSegmentsAndTheirEndsDoesNotMatter) {
  Segments segments;
  for (std::uint32_t i = 0; i < 300; ++i) {  // a random simple graph of degrees 0 to about 6
    const auto a = static_cast<std::uint32_t>((tests::hash_noise(i, 1) + 1) * 100);
    const auto b = static_cast<std::uint32_t>((tests::hash_noise(i, 2) + 1) * 100);
    if (a != b)
      segments.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(segments.begin(), segments.end());
  segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
  const Paths expected = traced(200, segments);
  std::size_t covered = 0;
  for (const auto& path : expected)
    covered += path.size() - 1;
  EXPECT_EQ(covered, segments.size());
  std::reverse(segments.begin(), segments.end());
  for (std::size_t i = 0; i < segments.size(); i += 2)
    std::swap(segments[i][0], segments[i][1]);
  EXPECT_EQ(traced(200, segments), expected);
}

TEST(DistanceToSegment, InsideBeyondTheEndsAndOfAPoint) {
  const Vec3d a{0, 0, 0}, b{10, 0, 0};
  EXPECT_DOUBLE_EQ(distance_to_segment({5, 3, 4}, a, b), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment({-3, 4, 0}, a, b), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment({13, 0, 4}, a, b), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment({3, 4, 0}, a, a), 5);
}

TEST(LengthOf, SumsTheSegments) {
  EXPECT_DOUBLE_EQ(length_of(std::vector<Vec3f>{{0, 0, 0}}), 0);
  EXPECT_DOUBLE_EQ(length_of(std::vector<Vec3f>{{0, 0, 0}, {3, 4, 0}, {3, 4, 2}}), 7);
}

std::vector<Vec3f> random_walk(std::size_t count, std::uint64_t seed) {
  std::vector<Vec3f> points = {{0, 0, 0}};
  while (points.size() < count) {
    const std::size_t i = points.size();
    points.push_back(points.back() + Vec3f{tests::hash_noise(i, seed) + 0.3f,
                                           tests::hash_noise(i, seed + 100),
                                           tests::hash_noise(i, seed + 200)});
  }
  return points;
}

/// Douglas & Peucker as in the book.
void douglas_peucker(const std::vector<Vec3f>& points, std::size_t first, std::size_t last,
                     double tolerance, std::vector<bool>& kept) {
  kept[first] = kept[last] = true;
  std::size_t split = first;
  double farthest = tolerance;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double d = distance_to_segment(to_double(points[i]), to_double(points[first]),
                                         to_double(points[last]));
    if (d > farthest) {
      farthest = d;
      split = i;
    }
  }
  if (split == first)
    return;
  douglas_peucker(points, first, split, tolerance, kept);
  douglas_peucker(points, split, last, tolerance, kept);
}

TEST(Significance, IsDouglasPeuckerForEveryTolerance) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const std::vector<Vec3f> points = random_walk(400, seed);
    const std::vector<double> values = significance(points, false, 0.05);
    for (const double tolerance : {0.05, 0.1, 0.5, 1.0, 3.0, 100.0}) {
      std::vector<bool> expected(points.size(), false), kept;
      douglas_peucker(points, 0, points.size() - 1, tolerance, expected);
      for (const double value : values)
        kept.push_back(value > tolerance);
      EXPECT_EQ(kept, expected) << "seed " << seed << ", tolerance " << tolerance;
    }
  }
}

TEST(Significance, ALoopKeepsATriangleWhateverTheTolerance) {
  std::vector<Vec3f> circle;
  for (int i = 0; i < 100; ++i) {
    const float angle = static_cast<float>(i) * 0.0628318f;
    circle.push_back({std::cos(angle), std::sin(angle), 0});
  }
  circle.push_back(Vec3f(circle.front()));
  const std::vector<double> values = significance(circle, true, 0.001);
  EXPECT_EQ(std::count(values.begin(), values.end(), kInfinity), 4);
  EXPECT_EQ(values[0], kInfinity);
  EXPECT_EQ(values[50], kInfinity);  // the farthest
  EXPECT_EQ(values[100], kInfinity);
}

TEST(Significance, AStraightLineAndTwoPoints) {
  const std::vector<Vec3f> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}};
  EXPECT_EQ(significance(line, false, 0), (std::vector<double>{kInfinity, 0, 0, kInfinity}));
  EXPECT_EQ(significance(std::span(line).first(2), false, 0),
            (std::vector<double>{kInfinity, kInfinity}));
}

TEST(Significance, PointsInOnePlaceAreNoObstacle) {
  const std::vector<Vec3f> same(50, Vec3f{1, 2, 3});
  const std::vector<double> values = significance(same, true, 0);
  EXPECT_EQ(std::count(values.begin(), values.end(), kInfinity), 4);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0.0), 46);
}

TEST(Significance, ALopsidedLineKeepsItsTolerance) {
  std::vector<Vec3f> comb;  // every split is at the end of its range: 20,000 levels
  for (int i = 0; i < 20'000; ++i) {
    const float height = i % 2 == 0 ? 0.0f : 1.0f + static_cast<float>(i);
    comb.push_back({static_cast<float>(i), height, 0});
  }
  const std::vector<double> values = significance(comb, false, 0.5);
  EXPECT_EQ(std::count_if(values.begin(), values.end(), [](double v) { return v > 0.5; }), 20'000);
  const double tolerance = 10'000;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] > tolerance)
      kept.push_back(i);
  }
  EXPECT_LT(kept.size(), 20'000u);
  for (std::size_t k = 1; k < kept.size(); ++k) {
    for (std::size_t i = kept[k - 1] + 1; i < kept[k]; ++i) {
      EXPECT_LE(distance_to_segment(to_double(comb[i]), to_double(comb[kept[k - 1]]),
                                    to_double(comb[kept[k]])),
                tolerance);
    }
  }
}

}  // namespace
}  // namespace meshhier::outline
