#include "partition/coarsen.h"

#include "tests/partition/graph_cases.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

/// A centre with so many leaves.
Graph star(std::uint32_t leaves) {
  Graph graph;
  graph.first.push_back(0);
  for (std::uint32_t v = 1; v <= leaves; ++v)
    graph.arcs.push_back({v, 5});
  graph.first.push_back(leaves);
  for (std::uint32_t v = 1; v <= leaves; ++v) {
    graph.arcs.push_back({0, 5});
    graph.first.push_back(leaves + v);
  }
  graph.weight.assign(leaves + 1, 1);
  graph.center.assign(leaves + 1, Vec3f{});
  return graph;
}

std::vector<std::vector<std::uint32_t>> members_of(const Clusters& clusters) {
  std::vector<std::vector<std::uint32_t>> members(clusters.count);
  for (std::uint32_t v = 0; v < clusters.of.size(); ++v)
    members.at(clusters.of[v]).push_back(v);
  return members;
}

bool touch(const Graph& graph, std::uint32_t a, std::uint32_t b) {
  const auto arcs = graph.arcs_of(a);
  return std::any_of(arcs.begin(), arcs.end(), [b](const Graph::Arc& arc) { return arc.to == b; });
}

const std::vector<tests::TestMesh>& meshes() {
  static const std::vector<tests::TestMesh> kMeshes{
      tests::shuffled(tests::sphere(4000, 0.02F), 3), tests::open_grid(40, 30),
      tests::non_manifold(2000), tests::soup(300), tests::points(100)};
  return kMeshes;
}

TEST(StarClusters, AreVerticesWithNeighbours) {
  for (const tests::TestMesh& mesh : meshes()) {
    const Graph graph = graph_of(mesh);
    for (const std::vector<std::uint32_t>& members : members_of(star_clusters(graph))) {
      ASSERT_FALSE(members.empty());
      const bool centred = std::any_of(members.begin(), members.end(), [&](std::uint32_t centre) {
        return std::all_of(members.begin(), members.end(),
                           [&](std::uint32_t v) { return v == centre || touch(graph, centre, v); });
      });
      EXPECT_TRUE(centred);
    }
  }
}

TEST(StarClusters, LeaveAThirdOfASurfacesVerticesOrLess) {
  const Graph graph = graph_of(tests::shuffled(tests::torus(20000, 0.01F), 1));
  EXPECT_LT(3 * star_clusters(graph).count, graph.size());
}

TEST(StarClusters, OfAHubAreSmall) {
  const auto members = members_of(star_clusters(star(500)));
  for (const std::vector<std::uint32_t>& cluster : members)
    EXPECT_LE(cluster.size(), 16U);
}

TEST(MatchedPairs, AreNeighboursWithinTheWeight) {
  for (const tests::TestMesh& mesh : meshes()) {
    Graph graph = graph_of(mesh);
    for (std::uint32_t v = 0; v < graph.size(); ++v)
      graph.weight[v] = 1 + v % 5;
    for (const std::vector<std::uint32_t>& members : members_of(matched_pairs(graph, 6))) {
      ASSERT_FALSE(members.empty());
      ASSERT_LE(members.size(), 2U);
      if (members.size() == 2) {
        EXPECT_LE(graph.weight[members[0]] + graph.weight[members[1]], 6U);
        const auto near = graph.arcs_of(members[0]);
        EXPECT_TRUE(touch(graph, members[0], members[1]) ||
                    std::any_of(near.begin(), near.end(), [&](const Graph::Arc& arc) {
                      return touch(graph, arc.to, members[1]);
                    }));
      }
    }
  }
}

TEST(MatchedPairs, NearlyHalveASurface) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(8000, 0.02F), 3));
  EXPECT_LT(matched_pairs(graph, 2).count, graph.size() * 11 / 20);
}

TEST(MatchedPairs, NearlyHalveAStar) {
  EXPECT_LT(matched_pairs(star(1000), 2).count, 510U);
}

TEST(MatchedPairs, PreferHeavyEdges) {
  // A path 0 - 1 - 2 - 3 with a heavy edge in the middle.
  Graph graph;
  graph.first = {0, 1, 3, 5, 6};
  graph.arcs = {{1, 10}, {0, 10}, {2, 90}, {1, 90}, {3, 10}, {2, 10}};
  graph.weight = {1, 1, 1, 1};
  graph.center.assign(4, Vec3f{});
  // Vertex 0 comes first and has no choice; from the middle on the heavy edge is taken.
  graph.weight[0] = 3;
  const Clusters clusters = matched_pairs(graph, 3);
  EXPECT_EQ(clusters.of[1], clusters.of[2]);
}

TEST(MatchedPairs, OfVerticesWithoutArcsThereAreNone) {
  const Graph graph = graph_of(tests::points(100));
  EXPECT_EQ(matched_pairs(graph, 10).count, 100U);
  EXPECT_EQ(star_clusters(graph).count, 100U);
}

TEST(StarClusters, OfASurfaceAreThoseOfItsGraph) {
  tests::TestMesh fans = tests::points(4000);
  for (std::uint32_t i = 1; i < 2000; ++i)
    fans.triangles.push_back({i, 0, i + 1});
  for (std::uint32_t i = 2001; i < 4000; ++i)
    fans.triangles.push_back({i, i, 3999});
  for (const tests::TestMesh& mesh :
       {tests::shuffled(tests::sphere(4000, 0.01F), 2), tests::non_manifold(900), tests::soup(50),
        tests::duplicates(900), fans}) {
    const Surface surface =
        make_surface(mesh.positions, {mesh.triangles.begin(), mesh.triangles.end()});
    const Clusters found = star_clusters(surface);
    const Clusters expected = star_clusters(surface_graph(surface));
    EXPECT_EQ(found.of, expected.of);
    EXPECT_EQ(found.count, expected.count);
  }
}

}  // namespace
}  // namespace meshhier::partition
