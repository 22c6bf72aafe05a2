#include "partition/compactness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

struct Point {
  std::size_t x = 0, y = 0;
};

/// The tile of the k x k vertices in the middle of a grid of unit squares, each cut by the diagonal
/// that rises to the right; around them one ring of ghosts.
TileMesh square_tile(std::size_t k, Vec3f x_axis = {1, 0, 0}, Vec3f y_axis = {0, 1, 0}) {
  const auto is_own = [&](Point p) { return p.x >= 1 && p.x <= k && p.y >= 1 && p.y <= k; };
  TileMesh tile;
  std::vector<std::uint32_t> index((k + 2) * (k + 2));
  for (const bool own : {true, false}) {
    for (std::size_t y = 0; y < k + 2; ++y) {
      for (std::size_t x = 0; x < k + 2; ++x) {
        if (is_own({x, y}) != own)
          continue;
        index[y * (k + 2) + x] = static_cast<std::uint32_t>(tile.vertices.size());
        tile.vertices.append(x_axis * static_cast<float>(x) + y_axis * static_cast<float>(y), {});
        if (!own)
          tile.ghosts.push_back({1, static_cast<std::uint32_t>(tile.ghosts.size())});
      }
    }
  }
  tile.own_count = static_cast<std::uint32_t>(k * k);
  tile.boundary_count = tile.own_count;
  const auto add = [&](Point a, Point b, Point c) {
    const auto corner = [&](Point p) {
      return static_cast<TileVertex>(index[p.y * (k + 2) + p.x]);
    };
    const int own = is_own(a) + is_own(b) + is_own(c);
    if (own == 3)
      tile.interior.push_back({corner(a), corner(b), corner(c)});
    else if (own > 0)
      tile.border.push_back({corner(a), corner(b), corner(c)});
  };
  for (std::size_t y = 0; y <= k; ++y) {
    for (std::size_t x = 0; x <= k; ++x) {
      add({x, y}, {x + 1, y}, {x + 1, y + 1});
      add({x, y}, {x + 1, y + 1}, {x, y + 1});
    }
  }
  return tile;
}

/// Worked out by hand. A triangle that is cut has two pieces of the line: from the midpoint of a
/// unit edge to the centroid, sqrt(5)/6, and from that of the diagonal, sqrt(2)/6. Along the sides
/// of the square, and at the two corners the diagonals point to, both triangles of a square are cut
/// like that; at the two other corners one triangle is, through its unit edges. Every own vertex
/// has its whole unit of area.
double square_compactness(double k) {
  const double side = (std::sqrt(5.0) + std::sqrt(2.0)) / 3;
  const double perimeter = (4 * (k - 1) + 2) * side + 2 * std::sqrt(5.0) / 3;
  return perimeter * perimeter / (4 * std::numbers::pi * k * k);
}

TEST(Compactness, OfSquaresOfAFlatGridIsKnown) {
  for (const std::size_t k : {1U, 2U, 3U, 10U, 40U}) {
    EXPECT_NEAR(compactness(square_tile(k)), square_compactness(static_cast<double>(k)), 1e-9) << k;
  }
}

TEST(Compactness, DependsOnNeitherSizeNorPlace) {
  const double expected = square_compactness(6);
  EXPECT_NEAR(compactness(square_tile(6, {1000, 0, 0}, {0, 1000, 0})), expected, 1e-9);
  EXPECT_NEAR(compactness(square_tile(6, {0, 0, 0.125F}, {0.125F, 0, 0})), expected, 1e-9);
  TileMesh moved = square_tile(6);
  for (Vec3f& p : moved.vertices.positions)
    p = p + Vec3f{64, -128, 32};
  EXPECT_NEAR(compactness(moved), expected, 1e-9);
}

TEST(Compactness, GrowsWithElongation) {
  const double square = compactness(square_tile(8));
  const double stretched = compactness(square_tile(8, {4, 0, 0}, {0, 1, 0}));
  const double drawn_out = compactness(square_tile(8, {16, 0, 0}, {0, 1, 0}));
  EXPECT_GT(stretched, 1.3 * square);
  EXPECT_GT(drawn_out, 3 * stretched);
}

TileMesh lone_triangle(std::uint32_t own_count) {
  TileMesh tile;
  for (const Vec3f p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}})
    tile.vertices.append(p, {});
  tile.own_count = own_count;
  tile.boundary_count = own_count;
  for (std::uint32_t i = own_count; i < 3; ++i)
    tile.ghosts.push_back({1, i});
  tile.border.push_back({TileVertex{0}, TileVertex{1}, TileVertex{2}});
  return tile;
}

// The triangle's centroid is (1/3, 1/3); the line runs there from two midpoints of edges.
TEST(Compactness, OfATrianglesPartsIsKnown) {
  const double area = 0.5 / 3;
  const double to_legs = 2 * std::sqrt(5.0) / 6;  // midpoints (1/2, 0) and (0, 1/2)
  EXPECT_NEAR(compactness(lone_triangle(1)), to_legs * to_legs / (4 * std::numbers::pi * area),
              1e-12);
  const double leg_and_long_edge = std::sqrt(5.0) / 6 + std::sqrt(2.0) / 6;  // and (1/2, 1/2)
  EXPECT_NEAR(compactness(lone_triangle(2)),
              leg_and_long_edge * leg_and_long_edge / (4 * std::numbers::pi * 2 * area), 1e-12);
}

TEST(Compactness, OfAClosedPieceWithoutNeighboursIsZero) {
  TileMesh tile = lone_triangle(3);
  std::swap(tile.interior, tile.border);
  EXPECT_EQ(compactness(tile), 0.0);
}

TEST(Compactness, WithoutAreaIsZero) {
  EXPECT_EQ(compactness(TileMesh{}), 0.0);
  TileMesh points = lone_triangle(3);
  points.border.clear();
  EXPECT_EQ(compactness(points), 0.0);
  TileMesh flat = lone_triangle(1);
  flat.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_EQ(compactness(flat), 0.0);
}

}  // namespace
}  // namespace meshhier::partition
