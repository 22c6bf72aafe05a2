#include "cluster_simplify/vertex_quadric.h"

#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

Vec3f random_vector(std::uint64_t index, std::uint64_t stream) {
  return {tests::hash_noise(index, stream), tests::hash_noise(index, stream + 1),
          tests::hash_noise(index, stream + 2)};
}

Vec3f unit(Vec3f v) {
  return v * (1 / length(v));
}

/// Planes through the centre, turned at random, then moved so that b and c count, too.
VertexQuadric random_quadric(std::uint64_t seed) {
  VertexQuadric q;
  for (std::uint64_t i = 0; i < 4; ++i) {
    VertexQuadric plane;
    plane.add_plane(unit(random_vector(i, 20 + 3 * seed)), 1 + 0.5F * tests::hash_noise(i, seed));
    q += plane.about(random_vector(i, 120 + 3 * seed));
  }
  return q;
}

std::vector<VertexQuadric> quadrics_of(const tests::TestMesh& mesh) {
  return vertex_quadrics(CollapseMesh(tests::tile_of(mesh).mesh), mesh.positions);
}

/// The sum over the triangles around the vertex in double precision.
double plane_error(const tests::TestMesh& mesh, std::uint32_t vertex, Vec3f offset) {
  double sum = 0;
  for (const tests::MeshTriangle& t : mesh.triangles) {
    const Vec3d normal = tests::doubled_normal(mesh, t);
    const double doubled_area = length(normal);
    if (std::ranges::find(t, vertex) == t.end() || doubled_area == 0)
      continue;
    const double along = dot(normal, to_double(offset)) / doubled_area;
    sum += doubled_area * along * along;
  }
  return sum;
}

double area_around(const tests::TestMesh& mesh, std::uint32_t vertex) {
  double sum = 0;
  for (const tests::MeshTriangle& t : mesh.triangles) {
    if (std::ranges::find(t, vertex) != t.end())
      sum += length(tests::doubled_normal(mesh, t));
  }
  return sum;
}

TEST(VertexQuadricTest, APlaneCostsItsWeightTimesTheSquaredDistance) {
  VertexQuadric q;
  q.add_plane(unit({1, 2, -2}), 6);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Vec3f x = random_vector(i, 1);
    const float away = (x.x + 2 * x.y - 2 * x.z) / 3;
    EXPECT_NEAR(q.at(x), 6 * away * away, 1e-5);
  }
  EXPECT_EQ(q.at({}), 0);
}

TEST(VertexQuadricTest, AboutAnotherCentreIsTheSameFunction) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const VertexQuadric q = random_quadric(seed);
    const Vec3f offset = random_vector(seed, 500);
    const VertexQuadric moved = q.about(offset);
    for (std::uint64_t i = 0; i < 10; ++i) {
      const Vec3f x = random_vector(i, 600);
      EXPECT_NEAR(moved.at(x), q.at(x + offset), 1e-4);
    }
    EXPECT_EQ(moved.area, q.area);
  }
}

TEST(VertexQuadricTest, SumsAreSumsOfFunctions) {
  VertexQuadric a = random_quadric(1);
  VertexQuadric b = random_quadric(2);
  a.area = 3;
  b.area = 4;
  VertexQuadric sum = a;
  sum += b;
  EXPECT_EQ(sum.area, 7);
  for (std::uint64_t i = 0; i < 20; ++i) {
    const Vec3f x = random_vector(i, 700);
    EXPECT_NEAR(sum.at(x), a.at(x) + b.at(x), 1e-4);
  }
}

TEST(VertexQuadricTest, OfAClosedMeshAreThePlanesOfItsTriangles) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(200, 0.05F), tests::torus(150, 0.02F), tests::cube(4)}) {
    const std::vector<VertexQuadric> quadrics = quadrics_of(mesh);
    ASSERT_EQ(quadrics.size(), mesh.positions.size());
    for (std::uint32_t v = 0; v < quadrics.size(); ++v) {
      EXPECT_NEAR(quadrics[v].area, area_around(mesh, v), 1e-5);
      for (std::uint64_t i = 0; i < 4; ++i) {
        const Vec3f offset = random_vector(i, 900) * 0.1F;
        ASSERT_NEAR(quadrics[v].at(offset), plane_error(mesh, v, offset), 1e-6) << "vertex " << v;
      }
    }
  }
}

TEST(VertexQuadricTest, AnOpenBorderHoldsItsVerticesMoreFirmlyThanTheSurface) {
  const std::vector<VertexQuadric> quadrics = quadrics_of(tests::open_grid(4, 4));
  const VertexQuadric& border = quadrics[2];  // y = 0
  const VertexQuadric& corner = quadrics[0];  // x = y = 0
  const VertexQuadric& inside = quadrics[12];
  EXPECT_NEAR(inside.at({0.1F, 0.1F, 0}), 0, 1e-6);
  EXPECT_NEAR(border.at({0.1F, 0, 0}), 0, 1e-6);  // free along the border
  EXPECT_GT(border.at({0, 0.1F, 0}), 3 * border.at({0, 0, 0.1F}));
  EXPECT_GT(corner.at({0.1F, 0, 0}), 3 * corner.at({0, 0, 0.1F}));
  EXPECT_GT(corner.at({0, 0.1F, 0}), 3 * corner.at({0, 0, 0.1F}));
  EXPECT_EQ(border.area, 3);  // twice that of its triangles; what holds borders does not count
}

TEST(VertexQuadricTest, AFoldIsHeldButLessThanABorder) {
  // A closed book: vertices 0 to 2 its back, then one cover, then the other.
  tests::TestMesh book{{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0}}, {}};
  book.triangles = {{0, 3, 1}, {3, 4, 1}, {1, 4, 2}, {4, 5, 2}};
  const float border = quadrics_of(book)[1].at({0.1F, 0, 0});
  for (std::uint32_t v = 3; v < 6; ++v)
    book.positions.push_back(Vec3f(book.positions[v]));
  book.triangles.insert(book.triangles.end(), {{0, 1, 6}, {6, 1, 7}, {1, 2, 7}, {7, 2, 8}});
  const VertexQuadric fold = quadrics_of(book)[1];
  EXPECT_NEAR(fold.at({0, 0.1F, 0}), 0, 1e-6);  // free along the fold
  EXPECT_GE(fold.at({0.1F, 0, 0}), fold.at({0, 0, 0.1F}) / 2);
  EXPECT_LT(fold.at({0.1F, 0, 0}), border);
}

TEST(VertexQuadricTest, ARightAngleIsNoFold) {
  // Two sheets that meet in the line x = z = 0.
  const tests::TestMesh roof{{{0, 0, 0}, {0, 1, 0}, {1, 0.5F, 0}, {0, 0.5F, -1}},
                             {{0, 2, 1}, {0, 1, 3}}};
  const tests::TestMesh sheet{roof.positions, {{0, 2, 1}}};
  const VertexQuadric both = quadrics_of(roof)[0];
  // The edge 0-1 is not held: what x costs comes from the plane of the other sheet and the borders.
  const VertexQuadric one = quadrics_of(sheet)[0];
  EXPECT_LT(both.at({-0.1F, 0, 0}), one.at({-0.1F, 0, 0}));
}

std::vector<VertexQuadric> quadrics_with(const tests::TestMesh& mesh,
                                         std::vector<PlaceEdge> seams) {
  std::ranges::sort(seams);
  return vertex_quadrics(CollapseMesh(tests::tile_of(mesh).mesh), mesh.positions, seams);
}

TEST(VertexQuadricTest, ASeamIsHeldButLessThanABorder) {
  const tests::TestMesh grid = tests::open_grid(4, 4);  // 12 is its middle
  const std::vector<VertexQuadric> plain = quadrics_of(grid);
  const std::vector<VertexQuadric> held = quadrics_with(grid, {{7, 12}, {12, 17}});
  EXPECT_NEAR(held[12].at({0, 0.1F, 0}), 0, 1e-6);  // free along the seam
  EXPECT_GT(held[12].at({0.1F, 0, 0}), 0.05F * held[12].at({0, 0, 0.1F}));
  EXPECT_LT(held[12].at({0.1F, 0, 0}), plain[2].at({0, 0.1F, 0}));
  EXPECT_EQ(held[12].area, plain[12].area);
  EXPECT_EQ(held[6].at({1, 1, 1}), plain[6].at({1, 1, 1}));
}

TEST(VertexQuadricTest, WhereMostEdgesAreSeamsNoneIsALine) {
  const tests::TestMesh grid = tests::open_grid(4, 4);
  std::vector<PlaceEdge> all;
  for (const CollapseMesh::Edge& edge : CollapseMesh(tests::tile_of(grid).mesh).edges())
    all.push_back({edge.a, edge.b});
  const std::vector<VertexQuadric> held = quadrics_with(grid, all);
  EXPECT_EQ(held[12].at({0.1F, 0.2F, 0}), quadrics_of(grid)[12].at({0.1F, 0.2F, 0}));
}

TEST(VertexQuadricTest, TrianglesWithoutAreaSayNothing) {
  const std::vector<VertexQuadric> quadrics =
      quadrics_of({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {1, 2, 3}}});
  for (const VertexQuadric& q : quadrics) {
    EXPECT_EQ(q.at({1, 2, 3}), 0);
    EXPECT_EQ(q.area, 0);
  }
}

TEST(VertexQuadricTest, IsFiniteForTheSmallestTriangles) {
  for (const float size : {1e-3F, 1e-10F, 1e-18F, 1e-22F, 1e-30F, 1e-44F}) {
    tests::TestMesh mesh = tests::open_grid(3, 3);
    for (Vec3f& p : mesh.positions)
      p = p * size;
    for (const VertexQuadric& q : quadrics_of(mesh))
      EXPECT_TRUE(std::isfinite(q.at({1, 1, 1})));
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
