#include "bench/parts.h"

#include "hierarchy/error.h"
#include "tests/bench/plain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using testing::ElementsAre;

/// Vertices of a grid of (width + 1) columns: part 0 left of column `first_right`, else part 1.
Parts columns(const PlainMesh& mesh, float first_right) {
  Parts parts{{}, 2};
  for (const Vec3f p : mesh.positions)
    parts.part_of.push_back(p.x < first_right ? 0 : 1);
  return parts;
}

/// A division into parts that look like noise: every kind of triangle occurs.
Parts scattered(const PlainMesh& mesh, std::uint32_t count) {
  Parts parts{{}, count};
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    parts.part_of.push_back(static_cast<std::uint32_t>((v * v + v / 3) % count));
  return without_empty_parts(std::move(parts.part_of), count);
}

TEST(PartsTest, EmptyPartsGoAndTheOthersKeepTheirOrder) {
  const Parts parts = without_empty_parts({5, 2, 2, 7, 5}, 9);
  EXPECT_EQ(parts.count, 3U);
  EXPECT_THAT(parts.part_of, ElementsAre(1, 0, 0, 2, 1));
}

TEST(PartsTest, MorePartsThanPointsAreRefused) {
  EXPECT_NO_THROW(check_part_count(3, 1));
  EXPECT_NO_THROW(check_part_count(3, 3));
  for (const std::uint32_t count : {0U, 4U}) {
    try {
      check_part_count(3, count);
      ADD_FAILURE() << count;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
    }
  }
}

TEST(PartsTest, DoubleCoordinatesKeepTheirDigits) {
  LoadedMesh mesh;
  mesh.positions = {{1e9, 5, 0}, {1e9 + 0.25, 5, 0}, {1e9 + 0.5, 5, 1}};
  mesh.double_coordinates = true;
  const PlainMesh plain = plain_mesh(mesh);
  EXPECT_EQ(plain.positions[0], (Vec3f{-0.25F, 0, -0.5F}));
  EXPECT_EQ(plain.positions[1], (Vec3f{0, 0, -0.5F}));
  mesh.double_coordinates = false;
  mesh.positions = {{3, 4, 5}};
  EXPECT_EQ(plain_mesh(mesh).positions[0], (Vec3f{3, 4, 5}));
}

TEST(PartTilesTest, EveryTriangleIsInAllPartsItTouches) {
  const PlainMesh mesh = plain(tests::sphere(500));
  const Parts parts = scattered(mesh, 7);
  const PartTiles tiles(mesh, parts);
  ASSERT_EQ(tiles.count(), parts.count);
  std::size_t own = 0;
  for (std::uint32_t part = 0; part < tiles.count(); ++part) {
    const BuildTile tile = tiles.tile(part);
    own += tile.mesh.own_count;
    std::size_t touching = 0;
    std::size_t inside = 0;
    for (const MeshTriangle& t : mesh.triangles) {
      const auto mine = std::ranges::count(t, part, [&](auto v) { return parts.part_of[v]; });
      touching += mine > 0 ? 1 : 0;
      inside += mine == 3 ? 1 : 0;
    }
    EXPECT_EQ(tile.mesh.interior.size(), inside);
    EXPECT_EQ(tile.mesh.border.size(), touching - inside);
    EXPECT_EQ(tile.mesh.vertices.size(), tile.mesh.own_count + tile.mesh.ghosts.size());
    EXPECT_TRUE(std::ranges::is_sorted(tile.mesh.ghosts));
    EXPECT_EQ(std::ranges::adjacent_find(tile.mesh.ghosts), tile.mesh.ghosts.end());
  }
  EXPECT_EQ(own, mesh.positions.size());
}

TEST(PartTilesTest, TrianglesKeepTheirCornersInSpace) {
  const PlainMesh mesh = plain(tests::torus(300));
  const Parts parts = scattered(mesh, 5);
  const PartTiles tiles(mesh, parts);
  for (std::uint32_t part = 0; part < tiles.count(); ++part) {
    std::vector<std::array<float, 9>> expected;
    std::vector<std::array<float, 9>> found;
    const auto add = [](auto& list, Vec3f a, Vec3f b, Vec3f c) {
      list.push_back({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z});
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      if (parts.part_of[a] == part || parts.part_of[b] == part || parts.part_of[c] == part)
        add(expected, mesh.positions[a], mesh.positions[b], mesh.positions[c]);
    }
    const BuildTile tile = tiles.tile(part);
    const auto& positions = tile.mesh.vertices.positions;
    for (const auto* list : {&tile.mesh.interior, &tile.mesh.border}) {
      for (const auto& [a, b, c] : *list)
        add(found, positions[raw(a)], positions[raw(b)], positions[raw(c)]);
    }
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
  }
}

TEST(PartFiguresTest, TheBorderBetweenTwoHalvesOfAGridIsKnown) {
  constexpr int kWidth = 5;  // columns 0, 1, 2 and 3, 4, 5: the halves are equal
  constexpr int kHeight = 8;
  const PlainMesh mesh = plain(tests::open_grid(kWidth, kHeight));
  const PartFigures figures = measure_parts(mesh, columns(mesh, 2.5F));
  // In each triangle along the cut from the midpoint of a straight edge over the centroid to the
  // midpoint of the diagonal: (sqrt 5 + sqrt 2) / 6; two triangles a row.
  const double perimeter = kHeight * (std::sqrt(5.0) + std::sqrt(2.0)) / 3;
  const double area = kWidth * kHeight / 2.0;
  EXPECT_EQ(figures.count, 2U);
  EXPECT_NEAR(figures.mean_compactness, perimeter * perimeter / (4 * std::numbers::pi * area),
              1e-12);
}

TEST(PartFiguresTest, SizesAndMeansAreOfAllParts) {
  const PlainMesh mesh = plain(tests::open_grid(9, 4));
  const PartFigures figures = measure_parts(mesh, columns(mesh, 1.5F));
  EXPECT_EQ(figures.least_vertices, 10U);
  EXPECT_EQ(figures.most_vertices, 40U);
  EXPECT_DOUBLE_EQ(figures.mean_vertices, 25);
  EXPECT_EQ(figures.without_area, 0U);
  // Of two values the lower one: the mean is between it and the other.
  EXPECT_GT(figures.median_compactness, 0);
  EXPECT_LT(figures.median_compactness, figures.mean_compactness);
}

TEST(PartFiguresTest, PartsWithoutAreaAreLeftOutOfTheMean) {
  PlainMesh mesh = plain(tests::open_grid(5, 8));
  const double alone = measure_parts(mesh, columns(mesh, 2.5F)).mean_compactness;
  Parts parts = columns(mesh, 2.5F);
  mesh.positions.push_back({100, 100, 100});
  parts.part_of.push_back(2);
  parts.count = 3;
  const PartFigures figures = measure_parts(mesh, parts);
  EXPECT_EQ(figures.without_area, 1U);
  EXPECT_EQ(figures.least_vertices, 1U);
  EXPECT_DOUBLE_EQ(figures.mean_compactness, alone);
}

TEST(PartFiguresTest, PointsAloneHaveNoCompactness) {
  const PlainMesh mesh = plain(tests::points(20));
  const PartFigures figures = measure_parts(mesh, scattered(mesh, 4));
  EXPECT_EQ(figures.without_area, figures.count);
  EXPECT_EQ(figures.mean_compactness, 0);
}

}  // namespace
}  // namespace meshhier::bench
