#include "bench/cell_mesh.h"

#include "bench/partitioners.h"
#include "cluster_simplify/kd_cells.h"
#include "hierarchy/error.h"
#include "tests/bench/plain.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using cluster_simplify::Representative;

Parts kd(const PlainMesh& mesh, std::uint32_t count) {
  return {cluster_simplify::kd_cells(mesh.positions, count), count};
}

/// Triangles with the smallest corner first, sorted.
std::vector<MeshTriangle> sorted(std::vector<MeshTriangle> triangles) {
  for (MeshTriangle& t : triangles)
    std::ranges::rotate(t, std::ranges::min_element(t));
  std::ranges::sort(triangles);
  return triangles;
}

TEST(CellMeshTest, CellsOfOneVertexChangeNothing) {
  const PlainMesh mesh = plain(tests::sphere(300, 0.01F));
  for (const Representative how : {Representative::mean, Representative::vertex}) {
    const PlainMesh same = cell_mesh(mesh, single_vertices(mesh), how);
    EXPECT_EQ(same.positions, mesh.positions);
    EXPECT_EQ(same.triangles, sorted(mesh.triangles));
  }
}

TEST(CellMeshTest, TheMeanIsTheMean) {
  const PlainMesh mesh{{{0, 0, 0}, {2, 0, 0}, {1, 3, 0}, {9, 9, 9}}, {{0, 1, 2}}};
  const PlainMesh result = cell_mesh(mesh, {{0, 0, 0, 1}, 2}, Representative::mean);
  EXPECT_EQ(result.positions, (std::vector<Vec3f>{{1, 1, 0}, {9, 9, 9}}));
  EXPECT_TRUE(result.triangles.empty());
}

TEST(CellMeshTest, TheQuadricPointIsAtTheCorner) {
  // Three faces of a cube around the corner (1, 1, 1): their planes meet there and nowhere else.
  const PlainMesh mesh{{{1, 1, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}},
                       {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}};
  const auto distance = [&](Representative how) {
    const PlainMesh result = cell_mesh(mesh, {{0, 0, 0, 0}, 1}, how);
    return length(to_double(result.positions[0]) - Vec3d{1, 1, 1});
  };
  EXPECT_LT(distance(Representative::quadric), 0.01);
  EXPECT_GT(distance(Representative::mean), 0.4);
}

TEST(CellMeshTest, ClosedSurfacesStayClosed) {
  const PlainMesh mesh = plain(tests::torus(5000, 0.01F));
  for (const Parts& cells : {kd(mesh, 200), octree_parts(mesh.positions, 200)}) {
    const PlainMesh result = cell_mesh(mesh, cells, Representative::quadric);
    EXPECT_EQ(result.positions.size(), cells.count);
    EXPECT_FALSE(result.triangles.empty());
    EXPECT_TRUE(tests::boundary_edges(result.triangles).empty());
    EXPECT_EQ(std::ranges::adjacent_find(result.triangles), result.triangles.end());
  }
}

TEST(CellMeshTest, CellsBeyondWhatAContractionTakesAreRefused) {
  const PlainMesh mesh = plain(tests::points(kMostCellVertices + 1));
  EXPECT_EQ(cell_mesh(mesh, kd(mesh, 2), Representative::mean).positions.size(), 2U);
  try {
    cell_mesh(mesh, kd(mesh, 1), Representative::mean);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), testing::HasSubstr("65537"));
  }
}

}  // namespace
}  // namespace meshhier::bench
