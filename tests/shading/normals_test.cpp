// The normals of a tile: of its own vertices, and of all of them.
#include "base/error.h"
#include "hierarchy/vertex_numbers.h"
#include "shading/own_normals.h"
#include "shading/tile_shading.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/cluster_simplify/wedge_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::shading {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

BoundaryShading no_neighbour(std::uint32_t) {
  throw std::logic_error("there is no neighbour");
}

/// The code that a corner of an interior triangle shows.
NormalCode shown(const TileMesh& mesh, const Shading& shading, std::size_t t, std::size_t k) {
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  const auto plain = numbers.numbered(mesh.interior, mesh.interior_wedges);
  return shading.normals[raw(shading.interior.empty() ? plain[t][k] : shading.interior[t][k])];
}

/// A triangle's own normal.
NormalCode flat(const TileMesh& mesh, std::size_t t) {
  const auto at = [&](std::size_t k) {
    return to_double(mesh.vertices.positions[raw(mesh.interior[t][k])]);
  };
  return normal_code(cross(at(1) - at(0), at(2) - at(0)));
}

std::vector<tests::NamedMesh> meshes() {
  std::vector<tests::NamedMesh> all = tests::nasty_meshes();
  all.push_back({"cube", tests::cube(5)});
  all.push_back({"torus", tests::torus(600, 0.05F)});
  return all;
}

/// The mesh with a texture that jumps: every third triangle is its own chart.
tests::WedgeMesh with_charts(const tests::TestMesh& mesh) {
  return tests::welded(tests::soup_of(mesh, 2, [](std::uint32_t t, Vec3f p) {
    return std::vector<float>{t % 3 == 0 ? p.x : p.y + 7, static_cast<float>(t % 3)};
  }));
}

TEST(ShadeOwn, ACubeHasThreeNormalsAtACornerTwoAtAnEdge) {
  const TileMesh mesh = tests::tile_of(tests::cube(4)).mesh;
  const OwnShading own = shade(mesh);
  EXPECT_EQ(own.split_of.size(), 8U * 2 + 12U * 3);
  EXPECT_TRUE(std::is_sorted(own.split_of.begin(), own.split_of.end()));
  EXPECT_EQ(own.normals.size(), mesh.own_count + own.split_of.size());
  const Shading all = shade_tile(mesh, own, no_neighbour);
  for (std::size_t t = 0; t < mesh.interior.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(shown(mesh, all, t, k), flat(mesh, t)) << t;
  }
}

TEST(ShadeOwn, ASphereIsSmooth) {
  const TileMesh mesh = tests::tile_of(tests::sphere(5000)).mesh;
  const OwnShading own = shade(mesh);
  EXPECT_THAT(own.split_of, IsEmpty());
  for (std::size_t v = 0; v < mesh.own_count; ++v) {
    const Vec3d radial = to_double(mesh.vertices.positions[v]);
    const Vec3d normal = to_double(normal_of(own.normals[v]));
    ASSERT_GT(dot(radial, normal) / length(radial) / length(normal), std::cos(0.03)) << v;
  }
  EXPECT_TRUE(shade_tile(mesh, own, no_neighbour).interior.empty());
}

// As some modelling programs write them, so that both sides are seen.
TEST(ShadeOwn, EachSideOfASheetWithTwoSidesHasItsOwnNormals) {
  tests::TestMesh sheet = tests::open_grid(12, 12, 0.1F);
  const std::size_t count = sheet.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const auto [a, b, c] = sheet.triangles[t];
    sheet.triangles.push_back({a, c, b});
  }
  const TileMesh mesh = tests::tile_of(sheet).mesh;
  const OwnShading own = shade(mesh);
  EXPECT_EQ(own.split_of.size(), mesh.own_count);
  const Shading all = shade_tile(mesh, own, no_neighbour);
  for (std::size_t t = 0; t < mesh.interior.size(); ++t) {
    const Vec3d side = to_double(normal_of(flat(mesh, t)));
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_GT(dot(to_double(normal_of(shown(mesh, all, t, k))), side), 0.5) << t;
  }
}

// The seam of a texture is none of the surface.
TEST(ShadeOwn, VerticesOfAPlaceAgreeWhereTheSurfaceIsSmooth) {
  const TileMesh mesh = tests::tile_of(with_charts(tests::sphere(3000))).mesh;
  ASSERT_FALSE(mesh.copies.empty());
  const OwnShading own = shade(mesh);
  EXPECT_THAT(own.split_of, IsEmpty());
  for (std::size_t i = 0; i < mesh.copies.size(); ++i)
    ASSERT_EQ(own.normals[mesh.own_count + i], own.normals[mesh.copies.places[i]]);
}

TEST(ShadeOwn, WhatHasNoAreaLooksAlongZ) {
  tests::TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}}, {{0, 1, 2}}};
  EXPECT_THAT(shade(tests::tile_of(mesh).mesh).normals,
              testing::AllOf(SizeIs(4), testing::Each(kNoDirection)));
}

TEST(ShadeTile, EveryCornerHasOneOfItsVertexsNormals) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    const TileMesh tile = tests::tile_of(with_charts(mesh)).mesh;
    const OwnShading own = shade(tile);
    const Shading all = shade_tile(tile, own, no_neighbour);
    const std::size_t count = tile.vertices.size() + tile.copies.size();
    ASSERT_EQ(all.normals.size(), count + all.split_of.size());
    // Without ghosts the numbers are the same.
    ASSERT_TRUE(std::equal(own.normals.begin(),
                           own.normals.begin() + static_cast<std::ptrdiff_t>(count),
                           all.normals.begin()));
    const VertexNumbers numbers(static_cast<std::uint32_t>(tile.vertices.size()),
                                tile.copies.places);
    const auto plain = numbers.numbered(tile.interior, tile.interior_wedges);
    for (std::size_t t = 0; t < all.interior.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = raw(all.interior[t][k]);
        const std::uint32_t vertex = corner < count ? corner : all.split_of.at(corner - count);
        ASSERT_EQ(vertex, raw(plain[t][k]));
      }
    }
  }
}

// A tile of one triangle over an edge that a neighbour owns, as that sees it.
TEST(ShadeTile, AGhostTakesTheNormalOfItsOwnTileThatIsNearest) {
  const BuildTile whole = tests::tile_of(tests::cube(1), 7);
  TileMesh mesh = whole.mesh;
  ASSERT_THAT(mesh.ghosts, SizeIs(1));
  mesh.ghosts[0] = {3, 1};
  BoundaryShading there;
  there.boundary_count = 2;
  const auto code = [](const Vec3f& p, int axis) {
    NormalCode normal{};
    normal[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(p[axis] > 0 ? 127 : -127);
    return normal;
  };
  const Vec3f corner = mesh.vertices.positions[7];
  there.shading.normals = {kNoDirection, code(corner, 0), code(corner, 1), code(corner, 2)};
  there.shading.split_of = {1, 1};
  const Shading all = shade_tile(mesh, shade(mesh), [&](std::uint32_t tile) {
    EXPECT_EQ(tile, 3U);
    return there;
  });
  ASSERT_EQ(all.border.size(), mesh.border.size());
  std::set<NormalCode> seen;
  for (std::size_t t = 0; t < mesh.border.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (mesh.is_own(mesh.border[t][k]))
        continue;
      const auto at = [&](std::size_t i) {
        return to_double(mesh.vertices.positions[raw(mesh.border[t][i])]);
      };
      EXPECT_EQ(all.normals[raw(all.border[t][k])],
                normal_code(cross(at(1) - at(0), at(2) - at(0))));
      seen.insert(all.normals[raw(all.border[t][k])]);
    }
  }
  EXPECT_THAT(seen, SizeIs(3));
}

TEST(ShadeTile, AGhostBeyondTheBoundaryIsRefused) {
  TileMesh mesh = tests::tile_of(tests::cube(1), 7).mesh;
  mesh.ghosts[0] = {3, 2};
  BoundaryShading there;
  there.boundary_count = 2;
  there.shading.normals.resize(2);
  EXPECT_THROW(shade_tile(mesh, shade(mesh), [&](std::uint32_t) { return there; }), Error);
}

TEST(ShadeTile, SplitsThatNoCornerTakesAreLeftOut) {
  const TileMesh mesh = tests::tile_of(tests::cube(1)).mesh;
  OwnShading own = shade(mesh);
  const Shading before = shade_tile(mesh, own, no_neighbour);
  EXPECT_LE(before.split_of.size(), most_splits(mesh.interior.size(), mesh.border.size()));
  // Vertex 0 has two splits more, opposite to its first normal: before and behind those it had.
  NormalCode opposite = own.normals[0];
  for (std::int8_t& axis : opposite)
    axis = static_cast<std::int8_t>(-axis);
  const std::ptrdiff_t had = std::ranges::count(own.split_of, 0U);
  ASSERT_GT(had, 0);
  for (const std::ptrdiff_t at : {had, std::ptrdiff_t{0}}) {
    own.split_of.insert(own.split_of.begin(), 0);
    own.normals.insert(own.normals.begin() + mesh.own_count + at, opposite);
  }
  EXPECT_EQ(shade_tile(mesh, own, no_neighbour), before);
}

TEST(RenumberedShading, BelongsToTheSameVertices) {
  const TileMesh mesh = tests::tile_of(with_charts(tests::cube(3))).mesh;
  const OwnShading own = shade(mesh);
  std::vector<std::uint32_t> place(mesh.own_count);
  for (std::uint32_t v = 0; v < mesh.own_count; ++v)
    place[v] = mesh.own_count - 1 - v;
  TileMesh turned = mesh;
  VertexArray vertices{{}, {}, mesh.vertices.channels};
  for (std::uint32_t v = mesh.own_count; v-- > 0;)
    vertices.append(mesh.vertices, v, v + 1);
  turned.vertices = vertices;
  for (TileTriangle& t : turned.interior) {
    for (TileVertex& corner : t)
      corner = TileVertex{place[raw(corner)]};
  }
  turned.copies = meshhier::renumbered(mesh.copies, place);
  const OwnShading moved = renumbered(own, mesh.copies.places, place, mesh.own_count);
  const Shading before = shade_tile(mesh, own, no_neighbour);
  const Shading after = shade_tile(turned, moved, no_neighbour);
  for (std::size_t t = 0; t < mesh.interior.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(shown(mesh, before, t, k), shown(turned, after, t, k)) << t;
  }
}

TEST(BoundaryNormals, AreThoseOfTheBoundarysVertices) {
  TileMesh mesh = tests::tile_of(with_charts(tests::cube(3))).mesh;
  mesh.boundary_count = 20;
  const OwnShading own = shade(mesh);
  const BoundaryShading boundary = boundary_of(own, mesh);
  const std::size_t copies = mesh.copies.first_of(20);
  EXPECT_EQ(boundary.boundary_count, 20U);
  EXPECT_THAT(boundary.copy_places, SizeIs(copies));
  ASSERT_EQ(boundary.shading.normals.size(), 20 + copies + boundary.shading.split_of.size());
  for (std::size_t v = 0; v < 20; ++v)
    EXPECT_EQ(boundary.shading.normals[v], own.normals[v]);
  for (std::size_t i = 0; i < copies; ++i)
    EXPECT_EQ(boundary.shading.normals[20 + i], own.normals[mesh.own_count + i]);
  std::size_t expected = 0;
  for (const std::uint32_t v : own.split_of)
    expected += std::size_t{v < 20 || (v >= mesh.own_count && v - mesh.own_count < copies)};
  EXPECT_THAT(boundary.shading.split_of, SizeIs(expected));
  EXPECT_TRUE(std::is_sorted(boundary.shading.split_of.begin(), boundary.shading.split_of.end()));
}

}  // namespace
}  // namespace meshhier::shading
