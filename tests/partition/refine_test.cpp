#include "partition/refine.h"

#include "tests/partition/graph_cases.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

std::vector<char> all(const Graph& graph) {
  return std::vector<char>(graph.size(), 1);
}

/// Slabs across z, each as large as the others, with `noise` at their borders.
Numbers slabs(const Graph& graph, std::uint32_t parts, float noise) {
  std::vector<std::pair<float, std::uint32_t>> order;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    order.push_back({graph.center[v].z + noise * tests::hash_noise(v, 9), v});
  std::sort(order.begin(), order.end());
  Numbers part_of(graph.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    part_of[order[i].second] = static_cast<std::uint32_t>(i * parts / order.size());
  return part_of;
}

TEST(Refiner, ShortensLinesAndKeepsSizes) {
  for (const tests::TestMesh& mesh :
       {tests::shuffled(tests::sphere(8000, 0.01F), 1), tests::shuffled(tests::torus(8000), 1),
        tests::non_manifold(5000), tests::duplicates(6000)}) {
    const Graph graph = graph_of(mesh);
    for (const std::uint32_t parts : {2U, 3U, 16U, 64U}) {
      Numbers part_of = slabs(graph, parts, 0.03F);
      const Numbers sizes = sizes_of(part_of, parts);
      const std::int64_t before = cut_of(graph, part_of);
      Refiner refiner(graph, part_of, sizes, all(graph));
      refiner.refine_all(4, {0, 2});
      EXPECT_EQ(sizes_of(part_of, parts), sizes);
      EXPECT_LT(cut_of(graph, part_of), before * 9 / 10) << parts;
      for (std::uint32_t part = 0; part < parts; ++part)
        EXPECT_EQ(refiner.excess(part), 0);
    }
  }
}

TEST(Refiner, SwapsAsManyOneWayAsTheOther) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(8000, 0.01F), 1));
  Numbers part_of = slabs(graph, 2, 0.05F);
  const Numbers before = part_of;
  const Numbers sizes = sizes_of(part_of, 2);
  Refiner refiner(graph, part_of, sizes, all(graph));
  refiner.refine_all(1, {0, 2});
  std::array<std::uint64_t, 2> moved_from{};
  for (std::size_t v = 0; v < before.size(); ++v)
    moved_from.at(before[v]) += before[v] != part_of[v] ? 1U : 0U;
  EXPECT_EQ(moved_from[0], moved_from[1]);
  EXPECT_GT(moved_from[0], 0U);
  EXPECT_EQ(moved_from[0] + moved_from[1], refiner.counts().kept_moves);
}

TEST(Refiner, LeavesTheBestLineAlone) {
  const Graph graph = graph_of(tests::open_grid(40, 10));
  Numbers part_of(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    part_of[v] = v % 41 < 20 ? 0 : 1;
  const Numbers expected = part_of;
  const Numbers sizes = sizes_of(part_of, 2);
  Refiner refiner(graph, part_of, sizes, all(graph));
  refiner.refine_all(3, {0, 2});
  EXPECT_EQ(part_of, expected);
  EXPECT_EQ(refiner.counts().kept_moves, 0U);
}

TEST(Refiner, SlackBoundsTheSizes) {
  Graph graph = graph_of(tests::shuffled(tests::sphere(8000, 0.01F), 1));
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    graph.weight[v] = 1 + v % 7;
  Numbers part_of = slabs(graph, 2, 0.05F);
  const auto total = std::accumulate(graph.weight.begin(), graph.weight.end(), 0U);
  const Numbers targets{total / 2, total - total / 2};
  Refiner refiner(graph, part_of, targets, all(graph));
  refiner.refine_all(6, {14, 28});
  EXPECT_LE(std::abs(refiner.excess(0) - refiner.excess(1)), 14);
}

TEST(Refiner, GrowsARegionFromASingleVertex) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(4000, 0.01F), 1));
  Numbers part_of(graph.size());
  part_of[7] = 1;
  const Numbers targets{graph.size() - 400, 400};
  Refiner refiner(graph, part_of, targets, all(graph));
  refiner.refine_all(3, {0, 2});
  EXPECT_EQ(sizes_of(part_of, 2), targets);
  // A disc of 400 of 2000 vertices has about 70 of them around it.
  const std::vector<char> boundary = refiner.boundary();
  EXPECT_LT(std::count(boundary.begin(), boundary.end(), 1), 300);
}

TEST(Refiner, BalancesExactly) {
  for (const tests::TestMesh& mesh :
       {tests::shuffled(tests::sphere(4000, 0.01F), 1), tests::soup(700), tests::points(2000),
        tests::nested_shells(4000)}) {
    const Graph graph = graph_of(mesh);
    for (const std::uint32_t parts : {2U, 5U, 31U, 64U}) {
      Numbers part_of = slabs(graph, parts, 0);
      Numbers targets(parts);
      for (std::uint32_t v = 0; v < graph.size(); ++v)
        ++targets[v * std::uint64_t{v} % parts];  // any that sum up, some 0
      Refiner refiner(graph, part_of, targets, all(graph));
      refiner.balance_exactly(Reach::anywhere);
      EXPECT_EQ(sizes_of(part_of, parts), targets) << parts;
    }
  }
}

TEST(Refiner, BalancingCostsLittleWhereLittleIsOff) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(8000, 0.01F), 1));
  Numbers part_of = slabs(graph, 8, 0);
  Numbers targets = sizes_of(part_of, 8);
  targets[0] += 10;
  targets[7] -= 10;
  Refiner refiner(graph, part_of, targets, all(graph));
  refiner.balance_exactly(Reach::anywhere);
  EXPECT_EQ(sizes_of(part_of, 8), targets);
  EXPECT_LE(refiner.counts().moves, 70U);  // ten across each of seven lines
}

TEST(Refiner, LooksOnlyWhereItIsTold) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(4000, 0.01F), 1));
  Numbers part_of = slabs(graph, 2, 0.05F);
  const Numbers before = part_of, sizes = sizes_of(part_of, 2);
  const std::vector<char> none(graph.size());
  Refiner refiner(graph, part_of, sizes, none);
  refiner.refine_all(3, {0, 2});
  EXPECT_EQ(part_of, before);
  EXPECT_EQ(refiner.counts().pairs, 0U);
}

TEST(Refiner, NumbersOfPartsDoNotMatterToTwo) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(4000, 0.01F), 1));
  Numbers low = slabs(graph, 2, 0.05F), high = low;
  for (std::uint32_t& part : high)
    part += 5;
  const Numbers sizes = sizes_of(low, 2);
  Numbers high_sizes(7);
  std::copy(sizes.begin(), sizes.end(), high_sizes.begin() + 5);
  Refiner(graph, low, sizes, all(graph)).refine_all(3, {0, 2});
  Refiner(graph, high, high_sizes, all(graph)).refine_all(3, {0, 2});
  for (std::size_t v = 0; v < low.size(); ++v)
    ASSERT_EQ(low[v] + 5, high[v]);
}

/// A hub of all vertices in a ring, which triangles join to it.
tests::TestMesh fan(std::uint32_t count) {
  tests::TestMesh mesh;
  mesh.positions.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < count; ++i)
    mesh.positions.push_back({tests::hash_noise(i, 1), tests::hash_noise(i, 2), 1});
  for (std::uint32_t i = 0; i < count; ++i)
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  return mesh;
}

TEST(Refiner, MovesStayInProportionOnBadMeshes) {
  for (const tests::TestMesh& mesh : {fan(20000), tests::soup(7000), tests::duplicates(20000)}) {
    const Graph graph = graph_of(mesh);
    Numbers part_of(graph.size());
    for (std::uint32_t v = 0; v < graph.size(); ++v)
      part_of[v] = v * 2654435761U % 64;  // every vertex on a boundary with many parts
    const Numbers sizes = sizes_of(part_of, 64);
    const std::int64_t before = cut_of(graph, part_of);
    Refiner refiner(graph, part_of, sizes, all(graph));
    refiner.refine_all(2, {0, 2});
    EXPECT_EQ(sizes_of(part_of, 64), sizes);
    EXPECT_LT(cut_of(graph, part_of), before);
    // Two rounds; a vertex is a seed for each part it touches, and a seed is good for 8 moves.
    EXPECT_LT(refiner.counts().moves, 2 * (8 * graph.arcs.size() + 64 * 64 * 12));
  }
}

TEST(Refiner, HubsStayWhereTheyAre) {
  const Graph graph = graph_of(fan(5000));
  ASSERT_GT(graph.degree(0), Refiner::kHubDegree);
  Numbers part_of(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    part_of[v] = v == 0 ? 0 : v % 10 == 0 ? 0 : 1;
  const Numbers sizes = sizes_of(part_of, 2);
  Refiner(graph, part_of, sizes, all(graph)).refine_all(4, {0, 2});
  EXPECT_EQ(part_of[0], 0U);
  EXPECT_EQ(sizes_of(part_of, 2), sizes);
}

TEST(Refiner, LeavesVerticesBeyondThoseToLookAtWhereTheyAre) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(8000, 0.01F), 1));
  Numbers part_of = slabs(graph, 4, 0.05F);
  const Numbers before = part_of, sizes = sizes_of(part_of, 4);
  const std::size_t movable = graph.size() / 2;
  Refiner refiner(graph, part_of, sizes, std::vector<char>(movable, 1));
  EXPECT_TRUE(refiner.balance_exactly(Reach::neighbours));
  refiner.refine_all(3, {0, 2});
  EXPECT_GT(refiner.counts().kept_moves, 0U);
  EXPECT_TRUE(std::equal(part_of.begin() + static_cast<std::ptrdiff_t>(movable), part_of.end(),
                         before.begin() + static_cast<std::ptrdiff_t>(movable)));
}

TEST(Refiner, SaysWhenNeighboursDoNotSufficeForExactSizes) {
  // Two components, each a part of its own, and one that should be larger.
  const Graph graph = graph_of(tests::soup(2));
  Numbers part_of{0, 0, 0, 1, 1, 1};
  const Numbers sizes{4, 2};
  Refiner near(graph, part_of, sizes, all(graph));
  EXPECT_FALSE(near.balance_exactly(Reach::neighbours));
  Refiner far(graph, part_of, sizes, all(graph));
  EXPECT_TRUE(far.balance_exactly(Reach::anywhere));
  EXPECT_EQ(sizes_of(part_of, 2), sizes);
}

}  // namespace
}  // namespace meshhier::partition
