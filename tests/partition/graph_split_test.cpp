#include "partition/graph_split.h"

#include "tests/partition/graph_cases.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

/// Even sizes, the remainder spread.
Numbers even_sizes(std::uint32_t vertices, std::uint32_t parts) {
  Numbers sizes;
  for (std::uint64_t i = 0; i < parts; ++i)
    sizes.push_back(static_cast<std::uint32_t>((i + 1) * vertices / parts - i * vertices / parts));
  return sizes;
}

TEST(GraphSplit, SizesAreExactForAnyMeshAndAnyNumberOfParts) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(20000, 0.01F), tests::shuffled(tests::torus(9000), 2), tests::soup(3000),
        tests::nested_shells(9000), tests::non_manifold(5000), tests::duplicates(7000),
        tests::open_grid(100, 3), tests::moebius(2000), tests::points(5000)}) {
    const Graph graph = graph_of(mesh);
    for (const std::uint32_t parts : {1U, 2U, 3U, 7U, 33U, 64U}) {
      const Numbers sizes = even_sizes(graph.size(), parts);
      EXPECT_EQ(sizes_of(split_graph(graph, sizes), parts), sizes) << graph.size() << " " << parts;
    }
  }
}

TEST(GraphSplit, SizesMayDiffer) {
  const Graph graph = graph_of(tests::shuffled(tests::sphere(8000), 2));
  Numbers sizes{1, 500, 3, 40, graph.size() - 544};
  EXPECT_EQ(sizes_of(split_graph(graph, sizes), sizes.size()), sizes);
}

TEST(GraphSplit, AVertexEach) {
  const Graph graph = graph_of(tests::sphere(72));
  const Numbers sizes(graph.size(), 1);
  ASSERT_LE(sizes.size(), kMostParts);
  EXPECT_EQ(sizes_of(split_graph(graph, sizes), sizes.size()), sizes);
}

TEST(GraphSplit, ShellsAreTakenApartBeforeTheyAreCut) {
  // Half of the vertices each: no line at all is needed between two parts.
  const Graph graph = graph_of(tests::shuffled(tests::nested_shells(16000, 0.01F), 3));
  const Numbers two = even_sizes(graph.size(), 2);
  EXPECT_EQ(cut_of(graph, split_graph(graph, two)), 0);
}

TEST(GraphSplit, AStripIsCutAcross) {
  const Graph graph = graph_of(tests::shuffled(tests::open_grid(999, 9), 3));
  const Numbers sizes = even_sizes(graph.size(), 10);
  std::int64_t mean = 0;
  for (const Graph::Arc& arc : graph.arcs)
    mean += arc.weight;
  mean /= static_cast<std::int64_t>(graph.arcs.size());
  // Nine straight cuts of about 20 edges.
  EXPECT_LT(cut_of(graph, split_graph(graph, sizes)), 9 * 24 * mean);
}

// Runs of parts are what tiles of coarser levels stand for.
TEST(GraphSplit, RunsOfPartsHaveShortLinesToo) {
  const Graph graph = graph_of(tests::shuffled(tests::open_grid(128, 128), 3));
  const Numbers part_of = split_graph(graph, even_sizes(graph.size(), 16));
  const std::int64_t all = cut_of(graph, part_of);
  for (const std::uint32_t run : {4U, 8U}) {
    Numbers coarse = part_of;
    for (std::uint32_t& part : coarse)
      part /= run;
    // Four by four squares have six inner lines: halves share one and quarters two.
    EXPECT_LT(cut_of(graph, coarse), all * (run == 8 ? 1 : 2) / 6 * 13 / 10) << run;
  }
}

TEST(GraphSplit, WorkIsInProportionToTheMesh) {
  std::vector<double> moves_per_vertex;
  for (const std::size_t triangles : {20000U, 80000U}) {
    const Graph graph = graph_of(tests::sphere(triangles, 0.001F));
    RefineCounts counts;
    split_graph(graph, even_sizes(graph.size(), 16), &counts);
    EXPECT_GT(counts.moves, 0U);
    EXPECT_LE(counts.kept_moves, counts.moves);
    moves_per_vertex.push_back(static_cast<double>(counts.moves) / graph.size());
  }
  EXPECT_LT(moves_per_vertex[1], moves_per_vertex[0]);  // lines grow as the square root
}

TEST(GraphSplit, HubsAndLonelyVerticesTakeNoMoreWorkThanOthers) {
  // A fan around one vertex, a star of single edges to another, and vertices of no triangle.
  tests::TestMesh mesh = tests::points(60000);
  for (std::uint32_t i = 1; i < 20000; ++i)
    mesh.triangles.push_back({0, i, i + 1});
  for (std::uint32_t i = 20002; i < 40000; ++i)
    mesh.triangles.push_back({20001, 20001, i});
  const Graph graph = graph_of(mesh);
  const Numbers sizes = even_sizes(graph.size(), 32);
  RefineCounts counts;
  EXPECT_EQ(sizes_of(split_graph(graph, sizes, &counts), 32), sizes);
  EXPECT_LT(counts.moves, 4 * std::uint64_t{graph.size()});
}

TEST(SurfaceSplit, SizesAreExactForAnyMeshAndAnyNumberOfParts) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(20000, 0.01F), tests::shuffled(tests::torus(9000), 2), tests::soup(3000),
        tests::nested_shells(9000), tests::non_manifold(5000), tests::duplicates(7000),
        tests::open_grid(100, 3), tests::moebius(2000), tests::points(5000)}) {
    const Surface surface = surface_of(mesh);
    for (const std::uint32_t parts : {1U, 2U, 3U, 7U, 33U, 64U}) {
      const Numbers sizes = even_sizes(surface.size(), parts);
      EXPECT_EQ(sizes_of(split_surface(surface, sizes), parts), sizes) << parts;
    }
  }
}

TEST(SurfaceSplit, LinesAreAsShortAsInTheWholeGraph) {
  for (const tests::TestMesh& mesh : {tests::shuffled(tests::sphere(60000, 0.002F), 2),
                                      tests::shuffled(tests::torus(40000), 3)}) {
    const Surface surface = surface_of(mesh);
    const Graph graph = surface_graph(surface);
    const Numbers sizes = even_sizes(surface.size(), 16);
    EXPECT_LT(cut_of(graph, split_surface(surface, sizes)),
              cut_of(graph, split_graph(graph, sizes)) * 106 / 100);
  }
}

TEST(SurfaceSplit, DoesNotDependOnTheOrderOfTriangles) {
  tests::TestMesh mesh = tests::shuffled(tests::torus(20000), 3);
  const Numbers sizes = even_sizes(static_cast<std::uint32_t>(mesh.positions.size()), 8);
  const Numbers expected = split_surface(surface_of(mesh), sizes);
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    std::rotate(mesh.triangles[i].begin(), mesh.triangles[i].begin() + 1, mesh.triangles[i].end());
  EXPECT_EQ(split_surface(surface_of(mesh), sizes), expected);
}

}  // namespace
}  // namespace meshhier::partition
