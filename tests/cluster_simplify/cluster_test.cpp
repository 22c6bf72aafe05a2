#include "cluster_simplify/cluster.h"

#include "base/srgb.h"
#include "cluster_simplify/kd_cells.h"
#include "cluster_simplify/quadric.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::Each;
using tests::tile_of;
using tests::tile_triangle;

constexpr std::array kAll{Representative::mean, Representative::quadric, Representative::vertex};

/// Appends a vertex that belongs to another tile.
std::uint32_t add_ghost(BuildTile& tile, Vec3f position) {
  const auto vertex = static_cast<std::uint32_t>(tile.mesh.vertices.size());
  tile.mesh.ghosts.push_back({1, vertex - tile.mesh.own_count});
  tile.mesh.vertices.positions.push_back(position);
  return vertex;
}

/// Three faces of the unit cube that meet in (1, 1, 1), as one grid of (n + 1)^2 vertices each,
/// not joined.
tests::TestMesh cube_corner(std::uint32_t n) {
  tests::TestMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t i = 0; i <= n; ++i) {
      for (std::uint32_t j = 0; j <= n; ++j) {
        const float u = static_cast<float>(i) / static_cast<float>(n);
        const float v = static_cast<float>(j) / static_cast<float>(n);
        mesh.positions.push_back(axis == 0   ? Vec3f{1, u, v}
                                 : axis == 1 ? Vec3f{v, 1, u}
                                             : Vec3f{u, v, 1});
        if (i == n || j == n)
          continue;
        const std::uint32_t a = first + i * (n + 1) + j;
        mesh.triangles.push_back({a, a + n + 1, a + 1});
        mesh.triangles.push_back({a + 1, a + n + 1, a + n + 2});
      }
    }
  }
  return mesh;
}

double distance(Vec3f a, Vec3f b) {
  return length(to_double(a) - to_double(b));
}

/// Unweighted means of the cells' own vertices.
std::vector<Vec3d> cell_means(const BuildTile& tile, const Contraction& contraction) {
  std::vector<Vec3d> sums(contraction.representatives.size());
  std::vector<double> counts(sums.size());
  for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i) {
    Vec3d& sum = sums[contraction.parent_of[i]];
    sum = sum + to_double(tile.mesh.vertices.positions[i]);
    ++counts[contraction.parent_of[i]];
  }
  for (std::size_t cell = 0; cell < sums.size(); ++cell)
    sums[cell] = sums[cell] * (1 / counts[cell]);
  return sums;
}

TEST(ClusterTest, CellsAreTheKdCellsOfTheOwnVertices) {
  BuildTile tile = tile_of(tests::sphere(800, 0.05F));
  add_ghost(tile, {100, 100, 100});  // must not attract cells
  const std::vector<Vec3f> own(tile.mesh.vertices.positions.begin(),
                               tile.mesh.vertices.positions.end() - 1);
  for (const Representative representative : kAll) {
    const Contraction found = cluster(tile, 57, {}, representative);
    EXPECT_EQ(found.parent_of, kd_cells(own, 57));
    EXPECT_EQ(found.representatives.size(), 57U);
  }
}

TEST(ClusterTest, AMeanCountsEveryOriginalVertex) {
  BuildTile tile = tile_of({{{0, 0, 0}, {4, 0, 0}, {8, 8, 0}}, {}});
  tile.history.weights = {1, 2, 5};
  const Contraction found = cluster(tile, 1, {}, Representative::mean);
  EXPECT_EQ(found.representatives.positions[0], (Vec3f{6, 5, 0}));
}

TEST(ClusterTest, AQuadricFindsTheCornerThatAMeanRoundsOff) {
  const BuildTile tile = tile_of(cube_corner(8));
  const Vec3f corner{1, 1, 1};
  const auto one = [&](Representative r) {
    return cluster(tile, 1, {}, r).representatives.positions[0];
  };
  EXPECT_GT(distance(one(Representative::mean), corner), 0.5);
  EXPECT_LT(distance(one(Representative::quadric), corner), 0.01);
  EXPECT_EQ(one(Representative::vertex), corner);
}

TEST(ClusterTest, AQuadricPointStaysWithinItsCellsSphere) {
  for (const float noise : {0.0F, 0.3F}) {
    const BuildTile tile = tile_of(tests::sphere(3000, noise));
    const Contraction found = cluster(tile, 200, {}, Representative::quadric);
    const std::vector<Vec3d> means = cell_means(tile, found);
    std::vector<double> radii(means.size());
    for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i) {
      double& radius = radii[found.parent_of[i]];
      radius = std::max(
          radius, length(to_double(tile.mesh.vertices.positions[i]) - means[found.parent_of[i]]));
    }
    for (std::size_t cell = 0; cell < means.size(); ++cell) {
      const Vec3d point = to_double(found.representatives.positions[cell]);
      EXPECT_LE(length(point - means[cell]), radii[cell] + 1e-6) << "cell " << cell;
    }
  }
}

TEST(ClusterTest, PlanesThatMeetFarAwayDoNotMakeASpike) {
  // Two faces like a roof's whose ridge would be at x = 5.
  const BuildTile tile = tile_of(
      {{{0, 0, 0.5F}, {1, 0, 0.4F}, {0, 1, 0.5F}, {0, 0, -0.5F}, {1, 0, -0.4F}, {0, 1, -0.5F}},
       {{0, 1, 2}, {3, 5, 4}}});
  const Vec3f found = cluster(tile, 1, {}, Representative::quadric).representatives.positions[0];
  const Vec3f mean = {1.0F / 3, 1.0F / 3, 0};
  EXPECT_GT(found.x, mean.x);
  EXPECT_NEAR(distance(found, mean), distance({0, 1, 0.5F}, mean), 1e-6);
}

TEST(ClusterTest, AVertexRepresentativeIsTheBestOfItsCell) {
  const BuildTile tile = tile_of(tests::torus(3000, 0.02F));
  const Contraction found = cluster(tile, 90, {}, Representative::vertex);
  const std::vector<Vec3d> means = cell_means(tile, found);
  std::vector<Quadric> quadrics(90);
  for (const TileTriangle& t : tile.mesh.interior) {
    std::vector<std::uint32_t> cells;
    for (const TileVertex v : t)
      cells.push_back(found.parent_of[raw(v)]);
    std::ranges::sort(cells);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    const auto at = [&](int k, std::uint32_t cell) {
      return to_double(tile.mesh.vertices.positions[raw(t[static_cast<std::size_t>(k)])]) -
             means[cell];
    };
    for (const std::uint32_t cell : cells)
      quadrics[cell].add_triangle(at(0, cell), at(1, cell), at(2, cell));
  }
  std::vector<double> least(90, std::numeric_limits<double>::infinity());
  std::vector<double> chosen(90, std::numeric_limits<double>::infinity());
  for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i) {
    const std::uint32_t cell = found.parent_of[i];
    const Vec3f position = tile.mesh.vertices.positions[i];
    const double error = quadrics[cell].at(to_double(position) - means[cell]);
    least[cell] = std::min(least[cell], error);
    if (position == found.representatives.positions[cell])
      chosen[cell] = error;
  }
  for (std::size_t cell = 0; cell < 90; ++cell) {
    ASSERT_TRUE(std::isfinite(chosen[cell])) << "cell " << cell << " shows none of its vertices";
    // The pull towards the mean may prefer a vertex that is worse by a thousandth of the radius.
    const double planes = quadrics[cell].xx + quadrics[cell].yy + quadrics[cell].zz;
    EXPECT_LE(chosen[cell], least[cell] + 1e-3 * planes / 3) << "cell " << cell;
  }
}

TEST(ClusterTest, WithoutPlanesTheVertexNearestToTheMeanStands) {
  const BuildTile tile = tile_of({{{0, 0, 0}, {1, 0, 0}, {8, 0, 0}}, {}});
  EXPECT_EQ(cluster(tile, 1, {}, Representative::vertex).representatives.positions[0],
            (Vec3f{1, 0, 0}));
  EXPECT_EQ(cluster(tile, 1, {}, Representative::quadric).representatives.positions[0],
            (Vec3f{3, 0, 0}));
}

TEST(ClusterTest, BorderTrianglesShapeTheCell) {
  // A flat patch; only the ghosts' triangles say that there is a ridge at z = 1.
  BuildTile tile = tile_of({{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}}, {{0, 1, 2}}});
  tile.mesh.boundary_count = 4;
  const std::uint32_t a = add_ghost(tile, {0, 5, 1});
  const std::uint32_t b = add_ghost(tile, {1, 5, 1});
  const auto z = [&] {
    return cluster(tile, 1, {}, Representative::quadric).representatives.positions[0].z;
  };
  EXPECT_NEAR(z(), 0.5, 1e-6);
  tile.mesh.border = {tile_triangle(2, 3, a), tile_triangle(3, b, a)};
  EXPECT_NEAR(z(), 1, 0.01);
}

TEST(ClusterTest, ATriangleCountsOnceInACellHoweverManyCornersItHasThere) {
  // Equal areas in the planes z = 0 (two corners in the cell) and z = 1 (one corner).
  BuildTile tile = tile_of({{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {}});
  tile.mesh.boundary_count = 3;
  const std::uint32_t a = add_ghost(tile, {0, 1, 0});
  const std::uint32_t b = add_ghost(tile, {1, 0, 1});
  const std::uint32_t c = add_ghost(tile, {0, 1, 1});
  tile.mesh.border = {tile_triangle(0, 1, a), tile_triangle(2, b, c)};
  const Contraction found = cluster(tile, 1, {}, Representative::quadric);
  EXPECT_NEAR(found.representatives.positions[0].z, 0.5, 1e-3);
}

TEST(ClusterTest, AttributesAreMeansOverTheOriginalVertices) {
  AttributeLayout layout;
  layout.normals = true;
  layout.colour = ColourType::u8;
  layout.alpha = true;
  layout.texcoords = true;
  BuildTile tile = tile_of({{{0, 0, 0}, {1, 0, 0}}, {}});
  tile.mesh.vertices.channels = layout.channels();
  tile.mesh.vertices.attributes = {1, 0, 0, 10, 20, 30, 255, 0, 1,  //
                                   0, 1, 0, 50, 60, 70, 55,  1, 0};
  tile.history.weights = {3, 1};
  const Contraction found = cluster(tile, 1, layout, Representative::mean);
  const auto values = found.representatives.attributes_of(0);
  const std::array<float, 9> expected = {
      3 / std::sqrt(10.0F), 1 / std::sqrt(10.0F), 0, 20, 30, 40, 205, 0.25F, 0.75F};
  ASSERT_EQ(values.size(), expected.size());
  for (const std::size_t k : {0U, 1U, 2U, 6U, 7U, 8U})
    EXPECT_NEAR(values[k], expected[k], 1e-5) << "channel " << k;
  // The mean is one of light, which is more than that of the numbers.
  for (std::size_t k = 3; k < 6; ++k) {
    const std::span<const float> all = tile.mesh.vertices.attributes;
    const double mean = (3 * light_of(all[k] / 255.0) + light_of(all[9 + k] / 255.0)) / 4;
    EXPECT_NEAR(light_of(values[k] / 255.0), mean, 1e-6) << "channel " << k;
    EXPECT_GT(values[k], expected[k] + 2);
  }
  layout.space = ColourSpace::linear;
  const Contraction linear = cluster(tile, 1, layout, Representative::mean);
  for (std::size_t k = 3; k < 6; ++k)
    EXPECT_NEAR(linear.representatives.attributes_of(0)[k], expected[k], 1e-5);
}

TEST(ClusterTest, OppositeNormalsLeaveAZeroNormal) {
  AttributeLayout layout;
  layout.normals = true;
  BuildTile tile = tile_of({{{0, 0, 0}, {1, 0, 0}}, {}});
  tile.mesh.vertices.channels = 3;
  tile.mesh.vertices.attributes = {0, 0, 1, 0, 0, -1};
  EXPECT_THAT(cluster(tile, 1, layout, Representative::mean).representatives.attributes,
              Each(0.0F));
}

TEST(ClusterTest, ManyEqualVerticesHaveTheirPlace) {
  const BuildTile tile = tile_of({std::vector<Vec3f>(50, Vec3f{3, 4, 5}), {{0, 1, 2}, {7, 8, 9}}});
  for (const Representative representative : kAll) {
    EXPECT_THAT(cluster(tile, 7, {}, representative).representatives.positions,
                Each(Vec3f{3, 4, 5}));
  }
}

TEST(ClusterTest, ExtremeCoordinatesStayFiniteAndInTheirBox) {
  for (const float unit : {1e30F, 1e-30F, 1e38F}) {
    tests::TestMesh mesh = tests::sphere(500, 0.1F);
    for (Vec3f& p : mesh.positions)
      p = p * unit;
    const BuildTile tile = tile_of(mesh);
    for (const Representative representative : kAll) {
      for (const Vec3f p : cluster(tile, 40, {}, representative).representatives.positions) {
        ASSERT_LE(std::abs(p.x), 1.5F * unit);
        ASSERT_LE(std::abs(p.y), 1.5F * unit);
        ASSERT_LE(std::abs(p.z), 1.5F * unit);
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
