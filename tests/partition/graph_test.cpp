#include "partition/graph.h"

#include "hierarchy/tile_mesh.h"
#include "partition/compactness.h"
#include "tests/partition/graph_cases.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

std::vector<Triangle<std::uint32_t>> triangles_of(const tests::TestMesh& mesh) {
  return {mesh.triangles.begin(), mesh.triangles.end()};
}

bool equal(const Graph& a, const Graph& b) {
  return a.first == b.first && a.weight == b.weight && a.center == b.center &&
         std::equal(a.arcs.begin(), a.arcs.end(), b.arcs.begin(), b.arcs.end(),
                    [](const Graph::Arc& x, const Graph::Arc& y) {
                      return x.to == y.to && x.weight == y.weight;
                    });
}

std::uint64_t weight_sum(const Graph& graph) {
  return std::accumulate(graph.arcs.begin(), graph.arcs.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Graph::Arc& arc) { return sum + arc.weight; });
}

/// No loops, no repeated arcs, weights above 0, every arc has its opposite.
void expect_sound(const Graph& graph) {
  ASSERT_EQ(graph.first.size(), graph.size() + 1);
  ASSERT_EQ(graph.center.size(), graph.size());
  ASSERT_EQ(graph.first.back(), graph.arcs.size());
  std::set<std::array<std::uint32_t, 3>> arcs;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    std::set<std::uint32_t> neighbours;
    for (const Graph::Arc& arc : graph.arcs_of(v)) {
      ASSERT_LT(arc.to, graph.size());
      EXPECT_NE(arc.to, v);
      EXPECT_GT(arc.weight, 0U);
      EXPECT_TRUE(neighbours.insert(arc.to).second) << v << " to " << arc.to;
      arcs.insert({v, arc.to, arc.weight});
    }
  }
  for (const auto& [from, to, weight] : arcs)
    EXPECT_TRUE(arcs.contains({to, from, weight})) << from << " to " << to;
}

std::size_t component_count(const Graph& graph) {
  std::vector<char> seen(graph.size());
  std::size_t count = 0;
  for (std::uint32_t start = 0; start < graph.size(); ++start) {
    std::vector<std::uint32_t> open;
    if (seen[start] == 0) {
      ++count;
      open.push_back(start);
      seen[start] = 1;
    }
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const Graph::Arc& arc : graph.arcs_of(v)) {
        if (seen[arc.to] == 0) {
          seen[arc.to] = 1;
          open.push_back(arc.to);
        }
      }
    }
  }
  return count;
}

TEST(SurfaceGraph, HasTheMeshsEdges) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(800, 0.02F), tests::open_grid(9, 7), tests::non_manifold(400),
        tests::duplicates(600), tests::soup(50)}) {
    const Graph graph = graph_of(mesh);
    expect_sound(graph);
    const auto edges = tests::undirected_edges(mesh.triangles);
    const std::set<tests::Edge> expected(edges.begin(), edges.end());
    std::set<tests::Edge> found;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      for (const Graph::Arc& arc : graph.arcs_of(v))
        found.insert({std::min(v, arc.to), std::max(v, arc.to)});
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(SurfaceGraph, RowsAscend) {
  const Graph graph = graph_of(tests::shuffled(tests::genus_n(2, 3000, 0.01F), 5));
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    const auto arcs = graph.arcs_of(v);
    EXPECT_TRUE(
        std::is_sorted(arcs.begin(), arcs.end(),
                       [](const Graph::Arc& a, const Graph::Arc& b) { return a.to < b.to; }));
  }
}

// The graph is worth cutting as its cuts are the perimeter that compactness() measures.
TEST(SurfaceGraph, ACutWeighsThePerimeterOfCompactness) {
  const tests::TestMesh mesh = tests::sphere(3000, 0.02F);
  const Graph graph = graph_of(mesh);
  std::vector<double> weights, perimeters;
  for (const float height : {-0.8F, -0.3F, 0.1F, 0.5F}) {
    std::vector<std::uint32_t> number(mesh.positions.size());
    TileMesh tile;
    const auto inside = [&](std::uint32_t v) { return mesh.positions[v].z < height; };
    for (const bool own : {true, false}) {
      for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
        if (inside(v) != own)
          continue;
        number[v] = static_cast<std::uint32_t>(tile.vertices.size());
        tile.vertices.append(mesh.positions[v], {});
        if (own)
          tile.own_count = static_cast<std::uint32_t>(tile.vertices.size());
      }
    }
    double area = 0;
    for (const tests::MeshTriangle& t : mesh.triangles) {
      TileTriangle corners;
      int own = 0;
      for (int k = 0; k < 3; ++k) {
        corners[k] = static_cast<TileVertex>(number[t[k]]);
        own += inside(t[k]) ? 1 : 0;
      }
      const Vec3d a = to_double(mesh.positions[t[0]]);
      area +=
          own / 6.0 *
          length(cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a));
      if (own == 3)
        tile.interior.push_back(corners);
      else if (own > 0)
        tile.border.push_back(corners);
    }
    perimeters.push_back(std::sqrt(compactness(tile) * 4 * 3.14159265358979 * area));
    double weight = 0;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      for (const Graph::Arc& arc : graph.arcs_of(v))
        weight += inside(v) && !inside(arc.to) ? arc.weight : 0;
    }
    weights.push_back(weight);
  }
  for (std::size_t i = 1; i < weights.size(); ++i)
    EXPECT_NEAR(weights[i] / weights[0], perimeters[i] / perimeters[0],
                0.01 * perimeters[i] / perimeters[0]);
}

TEST(SurfaceGraph, DoesNotDependOnTheOrderOfTrianglesNorOnTheirFirstCorner) {
  const tests::TestMesh mesh = tests::duplicates(3000, 0.02F);
  std::vector<Triangle<std::uint32_t>> triangles = triangles_of(mesh);
  const Graph expected = surface_graph(make_surface(mesh.positions, triangles));
  for (const unsigned seed : {1U, 2U}) {
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(seed));
    for (std::size_t i = 0; i < triangles.size(); i += seed)
      std::rotate(triangles[i].begin(), triangles[i].begin() + 1, triangles[i].end());
    EXPECT_TRUE(equal(surface_graph(make_surface(mesh.positions, triangles)), expected));
  }
}

TEST(SurfaceGraph, DoesNotDependOnScale) {
  const tests::TestMesh mesh = tests::sphere(500, 0.02F);
  const Graph expected = graph_of(mesh);
  for (const float scale : {0x1p-100F, 0x1p-20F, 0x1p100F, 0x1p126F}) {
    tests::TestMesh scaled = mesh;
    for (Vec3f& p : scaled.positions)
      p = p * scale;
    EXPECT_TRUE(equal(graph_of(scaled), expected)) << scale;
  }
}

TEST(SurfaceGraph, LeavesOutTrianglesOfOtherVertices) {
  const tests::TestMesh mesh = tests::sphere(500, 0.02F);
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  const Graph expected = graph_of(mesh);
  for (const std::uint32_t first : {7U, 0xffffffffU - count}) {
    std::vector<Triangle<std::uint32_t>> triangles;
    for (const tests::MeshTriangle& t : mesh.triangles) {
      triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
      triangles.push_back({t[0] + first, first - 1, t[2] + first});
      triangles.push_back({first + count, t[1] + first, t[2] + first});
    }
    EXPECT_TRUE(equal(surface_graph(make_surface(mesh.positions, triangles, first)), expected))
        << first;
  }
}

TEST(SurfaceGraph, EdgesWithoutLengthWeighTheLeast) {
  tests::TestMesh mesh = tests::open_grid(5, 5);
  std::fill(mesh.positions.begin(), mesh.positions.end(), Vec3f{0.3F, -1, 2});
  const Graph graph = graph_of(mesh);
  expect_sound(graph);
  for (const Graph::Arc& arc : graph.arcs)
    EXPECT_LE(arc.weight, 2U);  // one for each triangle
}

TEST(SurfaceGraph, TrianglesThatTurnBackOnThemselvesHaveNoLoops) {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle<std::uint32_t>> triangles{{0, 0, 1}, {1, 1, 1}, {2, 1, 2}};
  const Graph graph = surface_graph(make_surface(positions, triangles));
  expect_sound(graph);
  EXPECT_EQ(graph.arcs.size(), 4U);
}

TEST(SurfaceGraph, ManyTrianglesAVertexAreAChoiceThatTheirOrderDoesNotChange) {
  const tests::TestMesh points = tests::points(60);
  std::vector<Triangle<std::uint32_t>> triangles;
  for (std::uint32_t a = 0; a < 60; ++a) {
    for (std::uint32_t b = a + 1; b < 60; ++b) {
      for (std::uint32_t c = b + 1; c < 60; ++c)
        triangles.push_back({b, c, a});
    }
  }
  const std::vector<Triangle<std::uint32_t>> once = triangles;
  triangles.insert(triangles.end(), once.begin(), once.end());
  const Graph graph = surface_graph(make_surface(points.positions, triangles));
  expect_sound(graph);
  EXPECT_LE(graph.arcs.size(), 2 * 3 * kMostTriangles * 60);
  EXPECT_GT(graph.arcs.size(), kMostTriangles * 60);
  std::shuffle(triangles.begin(), triangles.end(), std::mt19937(3));
  EXPECT_TRUE(equal(surface_graph(make_surface(points.positions, triangles)), graph));
  EXPECT_TRUE(equal(surface_graph(make_surface(points.positions, once)), graph));
}

TEST(SurfaceGraph, WeightsLeaveRoomForSums) {
  // One edge that is longer than all others together, and many triangles.
  tests::TestMesh mesh = tests::sphere(100000);
  mesh.positions[17] = mesh.positions[17] * 1e6F;
  const Graph graph = graph_of(mesh);
  EXPECT_LT(weight_sum(graph) / 2, std::uint64_t{1} << 30);
}

TEST(SurfaceGraph, OfGroupsIsTheContractedGraphOnAnotherScale) {
  const tests::TestMesh mesh = tests::shuffled(tests::sphere(3000, 0.02F), 4);
  const Surface surface = make_surface(mesh.positions, triangles_of(mesh));
  std::vector<std::uint32_t> group_of(surface.size());
  for (std::uint32_t v = 0; v < surface.size(); ++v)
    group_of[v] = static_cast<std::uint32_t>(surface.positions[v].z * 20);
  const Graph expected = contract(surface_graph(surface), group_of, 40);
  const Graph found = surface_graph(surface, group_of, 40);
  expect_sound(found);
  EXPECT_EQ(found.weight, expected.weight);
  EXPECT_EQ(found.first, expected.first);
  const double scale =
      static_cast<double>(weight_sum(found)) / static_cast<double>(weight_sum(expected));
  for (std::uint32_t v = 0; v < found.size(); ++v) {
    for (const Graph::Arc& arc : found.arcs_of(v)) {
      for (const Graph::Arc& other : expected.arcs_of(v)) {
        if (other.to == arc.to) {
          EXPECT_NEAR(arc.weight, other.weight * scale, 0.01 * arc.weight);
        }
      }
    }
  }
}

TEST(Contract, KeepsWeightsAndCutsBetweenClusters) {
  const Graph graph = graph_of(tests::sphere(2000, 0.02F));
  std::vector<std::uint32_t> cluster_of(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    cluster_of[v] = v * 7 % 31;
  const Graph coarse = contract(graph, cluster_of, 31);
  expect_sound(coarse);
  std::array<std::uint32_t, 31> weight{};
  std::uint64_t between = 0;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    ++weight[cluster_of[v]];
    for (const Graph::Arc& arc : graph.arcs_of(v))
      between += cluster_of[v] != cluster_of[arc.to] ? arc.weight : 0;
  }
  EXPECT_TRUE(std::equal(weight.begin(), weight.end(), coarse.weight.begin(), coarse.weight.end()));
  EXPECT_EQ(weight_sum(coarse), between);
}

TEST(Contract, CentresAreMeans) {
  Graph graph;
  graph.first = {0, 0, 0, 0};
  graph.weight = {1, 3, 5};
  graph.center = {{0, 0, 0}, {1, 0, 0}, {0.5F, 0.25F, 1}};
  const std::vector<std::uint32_t> cluster_of{1, 1, 0};
  const Graph coarse = contract(graph, cluster_of, 2);
  EXPECT_EQ(coarse.center[0], (Vec3f{0.5F, 0.25F, 1}));
  EXPECT_EQ(coarse.center[1], (Vec3f{0.75F, 0, 0}));
  EXPECT_EQ(coarse.weight, (std::vector<std::uint32_t>{5, 4}));
}

TEST(Subgraph, IsWhatLiesBetweenTheVerticesListed) {
  const Graph graph = graph_of(tests::sphere(2000, 0.02F));
  std::vector<std::uint32_t> listed;
  for (std::uint32_t v = 5; v < graph.size(); v += 1 + v % 3)
    listed.push_back(v);
  std::vector<std::uint32_t> place(graph.size(), 12345);
  const Graph part = subgraph(graph, listed, place);
  expect_sound(part);
  ASSERT_EQ(part.size(), listed.size());
  std::size_t arcs = 0;
  for (std::uint32_t i = 0; i < part.size(); ++i) {
    EXPECT_EQ(part.center[i], graph.center[listed[i]]);
    for (const Graph::Arc& arc : graph.arcs_of(listed[i]))
      arcs += std::binary_search(listed.begin(), listed.end(), arc.to) ? 1U : 0U;
  }
  EXPECT_EQ(part.arcs.size(), arcs);
}

TEST(LinkComponents, LeavesOneComponentAndAddsNoMoreThanItTakes) {
  for (const tests::TestMesh& mesh :
       {tests::soup(300), tests::nested_shells(800), tests::points(500), tests::sphere(500)}) {
    Graph graph = graph_of(mesh);
    const std::size_t arcs = graph.arcs.size(), components = component_count(graph);
    link_components(graph);
    expect_sound(graph);
    EXPECT_EQ(component_count(graph), 1U);
    EXPECT_EQ(graph.arcs.size(), arcs + 2 * (components - 1));
  }
}

TEST(LinkComponents, LinksWhatIsNear) {
  // A row of points: each is linked to the next.
  std::vector<Vec3f> positions;
  for (std::uint32_t i = 0; i < 50; ++i)
    positions.push_back({static_cast<float>(i * 37 % 50), 0, 0});
  Graph graph = surface_graph(make_surface(positions, {}));
  link_components(graph);
  for (std::uint32_t v = 0; v < 50; ++v) {
    for (const Graph::Arc& arc : graph.arcs_of(v))
      EXPECT_EQ(std::abs(positions[v].x - positions[arc.to].x), 1);
  }
}

}  // namespace
}  // namespace meshhier::partition
