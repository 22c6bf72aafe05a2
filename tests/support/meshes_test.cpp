// The test meshes are what their header says: other tests build on it.
#include "tests/support/meshes.h"

#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <set>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

void expect_valid(const TestMesh& mesh) {
  for (const MeshTriangle& t : mesh.triangles) {
    for (std::uint32_t corner : t)
      ASSERT_LT(corner, mesh.positions.size());
    ASSERT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
  }
}

/// Six times the enclosed volume: positive if the triangles face outward.
double signed_volume(const TestMesh& mesh) {
  double sum = 0;
  for (const MeshTriangle& t : mesh.triangles) {
    sum += dot(to_double(mesh.positions[t[0]]),
               cross(to_double(mesh.positions[t[1]]), to_double(mesh.positions[t[2]])));
  }
  return sum;
}

TEST(TestMeshes, ClosedShapesAreClosedAndOfTheirGenus) {
  const std::vector<std::pair<TestMesh, std::int64_t>> shapes = {
      {sphere(1), 2},          {sphere(2000, 0.01f), 2},     {torus(1000, 0.005f), 0},
      {genus_n(0, 100), 2},    {genus_n(1, 100), 0},         {genus_n(5, 3000, 0.01f), -8},
      {nested_shells(500), 4}, {shuffled(torus(100), 7), 0},
  };
  for (const auto& [mesh, euler] : shapes) {
    expect_valid(mesh);
    EXPECT_TRUE(is_closed(mesh.triangles));
    EXPECT_TRUE(boundary_edges(mesh.triangles).empty());
    EXPECT_EQ(euler_characteristic(mesh.triangles), euler);
    EXPECT_GT(signed_volume(mesh), 0);
  }
  EXPECT_EQ(component_count(nested_shells(500)), 2u);
  EXPECT_EQ(component_count(genus_n(5, 100)), 1u);
}

TEST(TestMeshes, CountsAreAtLeastWhatWasAskedFor) {
  EXPECT_EQ(sphere(1000).triangles.size(), 8u * 12 * 12);
  EXPECT_EQ(sphere(1000).positions.size(), 4u * 12 * 12 + 2);
  EXPECT_EQ(torus(1000).triangles.size(), 6u * 13 * 13);
  EXPECT_GE(genus_n(5, 10000).triangles.size(), 10000u);
  EXPECT_EQ(open_grid(7, 5).triangles.size(), 70u);
  EXPECT_EQ(open_grid(7, 5).positions.size(), 48u);
  EXPECT_EQ(non_manifold(100).triangles.size(), 6u * 4 * 4 + 16);
  EXPECT_EQ(soup(10).positions.size(), 30u);
  EXPECT_EQ(points(10).positions.size(), 10u);
  EXPECT_TRUE(points(10).triangles.empty());
}

TEST(TestMeshes, OpenShapesHaveTheirBorders) {
  EXPECT_EQ(boundary_edges(open_grid(7, 5).triangles).size(), 24u);
  EXPECT_EQ(euler_characteristic(open_grid(7, 5).triangles), 1);
  const TestMesh band = moebius(1000);
  expect_valid(band);
  EXPECT_EQ(euler_characteristic(band.triangles), 0);
  EXPECT_EQ(boundary_edges(band.triangles).size(), 2u * 8 * 8);   // once around and once more
  EXPECT_GT(unmatched_edges(band.triangles).size(), 2u * 8 * 8);  // and the seam turns over
  EXPECT_EQ(boundary_edges(soup(10).triangles).size(), 30u);
}

TEST(TestMeshes, NonManifoldHasThreeTrianglesOnAnEdgeAndTwoConesOnAVertex) {
  const TestMesh mesh = non_manifold(100);
  expect_valid(mesh);
  const std::vector<Edge> edges = undirected_edges(mesh.triangles);
  std::size_t triple = 0;
  for (std::size_t i = 2; i < edges.size(); ++i)
    triple += edges[i] == edges[i - 2] ? 1 : 0;
  EXPECT_EQ(triple, 4u);
  EXPECT_EQ(component_count(mesh), 2u);
  EXPECT_EQ(boundary_edges(mesh.triangles).size(), 3u * 12 + 16);
}

TEST(TestMeshes, DuplicatesRepeatTrianglesAndVertices) {
  const TestMesh plain = sphere(1000), mesh = duplicates(1000);
  expect_valid(mesh);
  EXPECT_GT(mesh.triangles.size(), plain.triangles.size());
  EXPECT_EQ(mesh.positions.size(), plain.positions.size() + (plain.positions.size() + 4) / 5);
  const std::set<MeshTriangle> unique(mesh.triangles.begin(), mesh.triangles.end());
  EXPECT_LT(unique.size(), mesh.triangles.size());
}

TEST(TestMeshes, NoiseIsBoundedAndRepeatable) {
  const TestMesh plain = sphere(500), noisy = sphere(500, 0.01f);
  EXPECT_EQ(noisy.positions, sphere(500, 0.01f).positions);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < plain.positions.size(); ++i) {
    const Vec3f d = noisy.positions[i] - plain.positions[i];
    EXPECT_LE(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), 0.01001f);
    moved += d == Vec3f{} ? 0 : 1;
  }
  EXPECT_EQ(moved, plain.positions.size());
}

TEST(TestMeshes, WritesPlyOfTheExactSize) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.path() / "test_mesh.ply";
  const TestMesh mesh = open_grid(3, 2);
  write_ply(mesh, path);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 12\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_EQ(std::filesystem::file_size(path), header.size() + 12 * 12 + 12 * 13);
  EXPECT_THROW(write_ply(mesh, path / "no" / "such"), std::runtime_error);
}

}  // namespace
}  // namespace meshhier::tests
