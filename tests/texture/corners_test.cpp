#include "texture/corners.h"

#include "hierarchy/vertex_numbers.h"
#include "tests/texture/random_numbers.h"

#include <array>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

TileTriangle triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {TileVertex{a}, TileVertex{b}, TileVertex{c}};
}

TileMesh mesh_of(std::uint32_t vertices, std::vector<TileTriangle> interior,
                 std::vector<TileTriangle> border = {}) {
  TileMesh mesh;
  mesh.vertices.positions.resize(vertices);
  mesh.own_count = vertices;
  mesh.interior = std::move(interior);
  mesh.border = std::move(border);
  return mesh;
}

/// The coordinates that a shading shows at the corners of interior and border triangles.
std::vector<CornerTexcoords> shown(const TileMesh& mesh, const Shading& shading) {
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  const bool split = !shading.split_of.empty();
  std::vector<CornerTexcoords> result;
  for (const auto& triangles :
       {split ? shading.interior : numbers.numbered(mesh.interior, mesh.interior_wedges),
        split ? shading.border : numbers.numbered(mesh.border, mesh.border_wedges)}) {
    for (const TileTriangle& t : triangles)
      result.push_back({shading.texcoords[raw(t[0])], shading.texcoords[raw(t[1])],
                        shading.texcoords[raw(t[2])]});
  }
  return result;
}

TEST(Corners, VerticesOfOneCoordinateAreNotSplit) {
  const TileMesh mesh = mesh_of(5, {triangle(0, 1, 2)}, {triangle(1, 3, 2)});
  const Vec2f a{0, 0}, b{1, 0}, c{0, 1}, d{1, 1};
  const std::vector<CornerTexcoords> corners = {{a, b, c}, {b, d, c}};
  const Shading shading = with_texcoords(mesh, {}, corners);
  EXPECT_THAT(shading.texcoords, ElementsAre(a, b, c, d, Vec2f{}));
  EXPECT_THAT(shading.normals, IsEmpty());
  EXPECT_THAT(shading.split_of, IsEmpty());
  EXPECT_THAT(shading.interior, IsEmpty());
  EXPECT_THAT(shading.border, IsEmpty());
}

TEST(Corners, EachFurtherCoordinateIsOneSplit) {
  const TileMesh mesh = mesh_of(4, {triangle(0, 1, 2), triangle(0, 2, 3), triangle(0, 3, 1)});
  const Vec2f a{0, 0}, b{1, 0}, c{0, 1}, d{1, 1}, other{0.5f, 0.5f};
  const std::vector<CornerTexcoords> corners = {{a, b, c}, {other, c, d}, {other, d, b}};
  const Shading shading = with_texcoords(mesh, {}, corners);
  EXPECT_THAT(shading.split_of, ElementsAre(0));
  EXPECT_THAT(shading.texcoords, ElementsAre(a, b, c, d, other));
  EXPECT_THAT(shading.interior,
              ElementsAre(triangle(0, 1, 2), triangle(4, 2, 3), triangle(4, 3, 1)));
  EXPECT_EQ(shown(mesh, shading), corners);
}

TEST(Corners, ZerosOfBothSignsAreOneCoordinate) {
  const TileMesh mesh = mesh_of(4, {triangle(0, 1, 2), triangle(0, 2, 3)});
  const Vec2f zero{0, 0}, minus{-0.0f, -0.0f};
  const std::vector<CornerTexcoords> corners = {{zero, zero, zero}, {minus, minus, minus}};
  EXPECT_THAT(with_texcoords(mesh, {}, corners).split_of, IsEmpty());
}

// Vertex 0 has two normals and two coordinates, but only three of the combinations.
TEST(Corners, NormalsAndCoordinatesAreSplitTogether) {
  const TileMesh mesh =
      mesh_of(5, {triangle(0, 1, 2), triangle(0, 2, 3), triangle(0, 3, 4), triangle(0, 4, 1)});
  const NormalCode up{0, 0, 127, 0}, side{127, 0, 0, 0};
  Shading normals;
  normals.normals = {up, up, up, up, up, side};
  normals.split_of = {0};
  normals.interior = {triangle(5, 1, 2), triangle(0, 2, 3), triangle(0, 3, 4), triangle(5, 4, 1)};
  const Vec2f a{0, 0}, b{1, 0}, rest{0.5f, 0.5f};
  const std::vector<CornerTexcoords> corners = {
      {a, rest, rest}, {a, rest, rest}, {b, rest, rest}, {a, rest, rest}};
  const Shading shading = with_texcoords(mesh, normals, corners);
  EXPECT_THAT(shading.split_of, ElementsAre(0, 0));
  EXPECT_THAT(shading.normals, ElementsAre(side, up, up, up, up, up, up));
  EXPECT_THAT(shading.texcoords, ElementsAre(a, rest, rest, rest, rest, a, b));
  EXPECT_THAT(shading.interior, ElementsAre(triangle(0, 1, 2), triangle(5, 2, 3), triangle(6, 3, 4),
                                            triangle(0, 4, 1)));
}

TEST(Corners, CopiesOfAPlaceAreVerticesOfTheirOwn) {
  TileMesh mesh = mesh_of(4, {triangle(0, 1, 2), triangle(0, 2, 3)});
  mesh.copies.places = {0, 2};
  mesh.copies.vertices.positions.resize(2);
  mesh.interior_wedges = {{0, 0, 0}, {1, 0, 1}};
  mesh.interior_wedges[1] = {1, 1, 0};
  const Vec2f a{0, 0}, b{1, 0}, c{0, 1}, d{1, 1};
  const std::vector<CornerTexcoords> corners = {{a, b, c}, {d, a, b}};
  const Shading shading = with_texcoords(mesh, {}, corners);
  EXPECT_THAT(shading.split_of, IsEmpty());
  EXPECT_THAT(shading.texcoords, ElementsAre(a, b, c, b, d, a));
}

TEST(Corners, RandomCornersShowWhatWasAskedFor) {
  RandomNumbers random(1);
  for (int round = 0; round < 20; ++round) {
    std::vector<TileTriangle> triangles;
    std::vector<CornerTexcoords> corners;
    std::set<std::tuple<std::uint32_t, float, float>> looks;
    std::set<std::uint32_t> used;
    for (int t = 0; t < 200; ++t) {
      // Vertex 0 is in every triangle, with many coordinates.
      triangles.push_back(triangle(0, 1 + random.below(30), 31 + random.below(30)));
      CornerTexcoords& at = corners.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto few = static_cast<float>(random.below(k == 0 ? 100 : 2));
        at[k] = {few, 1};
        looks.insert({raw(triangles.back()[k]), few, 1.0f});
        used.insert(raw(triangles.back()[k]));
      }
    }
    const TileMesh mesh = mesh_of(61, {triangles.begin(), triangles.begin() + 120},
                                  {triangles.begin() + 120, triangles.end()});
    const Shading shading = with_texcoords(mesh, {}, corners);
    EXPECT_EQ(shown(mesh, shading), corners);
    EXPECT_THAT(shading.split_of, SizeIs(looks.size() - used.size()));
    EXPECT_TRUE(std::ranges::is_sorted(shading.split_of));
    EXPECT_EQ(shading.texcoords.size(), 61 + shading.split_of.size());
    for (std::size_t t = 0; t < 120; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t number = raw(shading.interior[t][k]);
        EXPECT_EQ(number < 61 ? number : shading.split_of[number - 61], raw(triangles[t][k]));
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::texture
