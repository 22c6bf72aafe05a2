#include "cluster_simplify/wedges.h"

#include "cluster_simplify/contraction.h"
#include "hierarchy/scalar_value.h"
#include "hierarchy/tile_mesh.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/cluster_simplify/wedge_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using tests::WedgeMesh;
using Attributes = std::vector<float>;

constexpr AttributeLayout kTexturedWedges{.texcoords = true};
constexpr AttributeLayout kShadedWedges{.normals = true};
constexpr AttributeLayout kColoured{.colour = ColourType::u8};

Attributes to_vector(std::span<const float> values) {
  return {values.begin(), values.end()};
}

/// A tile, what a method made of it, and its wedges.
struct ContractedTile {
  BuildTile tile;
  Contraction contraction;
  ContractedWedges wedges;
  AttributeLayout layout;

  std::uint32_t place(std::uint32_t old_place) const { return contraction.parent_of[old_place]; }
  std::uint32_t count_at(std::uint32_t new_place) const {
    const auto& places = wedges.copies.places;
    return 1 + static_cast<std::uint32_t>(std::ranges::count(places, new_place));
  }
  Attributes at(std::uint32_t new_place, std::uint32_t wedge) const {
    if (wedge > 0)
      return to_vector(
          wedges.copies.vertices.attributes_of(wedges.copies.first_of(new_place) + wedge - 1));
    const auto width = static_cast<std::ptrdiff_t>(layout.channels());
    const auto begin = wedges.attributes.begin() + new_place * width;
    return {begin, begin + width};
  }
  Attributes image(std::uint32_t old_place, std::uint32_t wedge) const {
    return at(place(old_place), wedges.map(old_place, wedge));
  }
};

/// Calls visit(place, wedge, whether it is own) for the corners of each triangle that survives.
template <class Visit>
void for_each_survivor(const ContractedTile& c, const Visit& visit) {
  const TileMesh& mesh = c.tile.mesh;
  const auto image = [&](TileVertex v) {
    return mesh.is_own(v) ? c.place(raw(v)) : raw(v) + 1000000;
  };
  const auto look = [&](const auto& triangles, const auto& wedges) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const TileTriangle& t = triangles[i];
      if (!is_degenerate(Triangle<std::uint32_t>{image(t[0]), image(t[1]), image(t[2])}))
        visit(t, wedges.empty() ? CornerWedges{} : wedges[i]);
    }
  };
  look(mesh.interior, mesh.interior_wedges);
  look(mesh.border, mesh.border_wedges);
}

/// All that holds whatever the tile: sizes, order, a total map, no wedge that nothing shows.
void expect_sound(const ContractedTile& c) {
  const auto& [attributes, copies, map] = c.wedges;
  const VertexArray& representatives = c.contraction.representatives;
  ASSERT_EQ(attributes.size(), representatives.attributes.size());
  ASSERT_EQ(copies.vertices.size(), copies.places.size());
  ASSERT_EQ(copies.vertices.channels, representatives.channels);
  ASSERT_EQ(copies.vertices.attributes.size(),
            copies.size() * static_cast<std::size_t>(representatives.channels));
  ASSERT_TRUE(std::ranges::is_sorted(copies.places));
  for (std::size_t i = 0; i < copies.size(); ++i)
    ASSERT_EQ(copies.vertices.positions[i], representatives.positions.at(copies.places[i]));

  const TileMesh& mesh = c.tile.mesh;
  ASSERT_EQ(map.firsts.size(), mesh.own_count);
  ASSERT_EQ(map.copies.size(), mesh.copies.first_of(mesh.own_count));
  std::vector<std::uint32_t> counts(representatives.size(), 1);
  for (const std::uint32_t place : copies.places)
    ++counts[place];
  for (std::uint32_t p = 0; p < mesh.own_count; ++p)
    ASSERT_LT(map(p, 0), counts[c.place(p)]);
  for (std::size_t i = 0; i < map.copies.size(); ++i) {
    ASSERT_EQ(map.places[i], mesh.copies.places[i]);
    ASSERT_LT(map.copies[i], counts[c.place(map.places[i])]);
  }

  std::set<std::pair<std::uint32_t, std::uint32_t>> shown;
  for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (mesh.is_own(t[k]))
        shown.emplace(c.place(raw(t[k])), map(raw(t[k]), wedges[k]));
    }
  });
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const auto number = static_cast<std::uint32_t>(i - copies.first_of(copies.places[i])) + 1;
    ASSERT_TRUE(shown.contains({copies.places[i], number})) << "nothing shows this copy";
    ASSERT_TRUE(shown.contains({copies.places[i], 0}));
  }
}

ContractedTile contracted(BuildTile tile, Contraction contraction, const AttributeLayout& layout,
                          const WedgeOptions& options = {}) {
  ContractedWedges wedges = contract_wedges(tile, contraction, layout, options);
  ContractedTile result{std::move(tile), std::move(contraction), std::move(wedges), layout};
  expect_sound(result);
  return result;
}

/// Attributes that no test mesh has: where they are found, nothing was done.
constexpr float kUntouched = -77;

/// The contraction to given places.
Contraction contraction_to(std::vector<std::uint32_t> parent_of, std::vector<Vec3f> positions,
                           int channels) {
  Contraction contraction;
  contraction.parent_of = std::move(parent_of);
  contraction.representatives = {std::move(positions), {}, channels};
  contraction.representatives.attributes.assign(
      contraction.representatives.size() * static_cast<std::size_t>(channels), kUntouched);
  return contraction;
}

/// Each own place for itself.
Contraction identity(const BuildTile& tile) {
  std::vector<std::uint32_t> parent_of;
  for (std::uint32_t p = 0; p < tile.mesh.own_count; ++p)
    parent_of.push_back(p);
  const auto begin = tile.mesh.vertices.positions.begin();
  return contraction_to(parent_of, {begin, begin + tile.mesh.own_count},
                        tile.mesh.vertices.channels);
}

struct NamedMethod {
  std::string name;
  ContractionOptions options;
};

std::vector<NamedMethod> methods() {
  return {{"edge_collapse", {}},
          {"half_edge", {Method::half_edge}},
          {"melax", {Method::half_edge, {}, HalfEdgeCost::melax}},
          {"mean", {Method::cluster, Representative::mean}},
          {"quadric", {Method::cluster, Representative::quadric}},
          {"vertex", {Method::cluster, Representative::vertex}}};
}

ContractedTile contracted(BuildTile tile, std::uint32_t target, const AttributeLayout& layout,
                          const NamedMethod& method) {
  Contraction contraction = contract(tile, target, layout, method.options);
  return contracted(std::move(tile), std::move(contraction), layout);
}

// ---- texture coordinates -------------------------------------------------------------------

constexpr float kSeam = 6;

/// Two charts, of x <= kSeam and of more, each an affine image of the plane.
std::array<float, 2> chart_point(bool right, Vec3f p) {
  return {right ? 0.6F + 0.03F * (p.x - kSeam) : 0.05F * p.x, 0.5F + 0.02F * p.y};
}

/// A flat strip, 12 x 8 quads, a seam of its texture down the middle.
WedgeMesh textured_strip() {
  const tests::TestMesh grid = tests::open_grid(12, 8);
  return tests::welded(tests::soup_of(grid, 2, [&](std::uint32_t t, Vec3f p) {
    const auto right = std::ranges::any_of(
        grid.triangles[t], [&](std::uint32_t v) { return grid.positions[v].x > kSeam; });
    const auto uv = chart_point(right, p);
    return Attributes{uv[0], uv[1]};
  }));
}

bool is_right(std::span<const float> uv) {
  return uv[0] >= 0.55F;
}

/// Every corner that is left of a triangle is in the triangle's chart.
void expect_charts_kept(const ContractedTile& c) {
  const TileMesh& mesh = c.tile.mesh;
  for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
    const bool right = is_right(tests::wedge_of(mesh, raw(t[0]), wedges[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      if (!mesh.is_own(t[k]))
        continue;
      const Attributes uv = c.image(raw(t[k]), wedges[k]);
      EXPECT_EQ(is_right(uv), right);
      EXPECT_GE(uv[0], chart_point(right, {right ? kSeam : 0, 0, 0})[0]);
      EXPECT_LE(uv[0], chart_point(right, {right ? 12 : kSeam, 0, 0})[0]);
    }
  });
}

TEST(WedgesTest, ATexturesSeamStaysASeamWithAnyMethod) {
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    for (const float limit : {100.0F, 9.0F, 6.0F, 4.0F}) {
      const BuildTile tile = tests::tile_of(textured_strip(), limit);
      const ContractedTile c = contracted(tile, tile.mesh.own_count / 2, kTexturedWedges, method);
      expect_charts_kept(c);
      EXPECT_EQ(c.wedges.copies.empty(), limit < kSeam);
    }
  }
}

TEST(WedgesTest, TextureCoordinatesAreThoseOfTheSurfaceWhereAPlaceComesToLie) {
  for (const NamedMethod& method : methods()) {
    if (method.options.method == Method::cluster)
      continue;  // a cell may hold places of a chart that no edge connects
    SCOPED_TRACE(method.name);
    const ContractedTile c =
        contracted(tests::tile_of(textured_strip()), 58, kTexturedWedges, method);
    for (std::uint32_t p = 0; p < 58; ++p) {
      for (std::uint32_t k = 0; k < c.count_at(p) && c.count_at(p) > 1; ++k) {
        const Vec3f position = c.contraction.representatives.positions[p];
        const Attributes uv = c.at(p, k);
        Vec3f nearest = position;  // the other chart's points are not to be had
        nearest.x = is_right(uv) ? std::max(nearest.x, kSeam) : std::min(nearest.x, kSeam);
        EXPECT_NEAR(uv[0], chart_point(is_right(uv), nearest)[0], 1e-5);
        EXPECT_NEAR(uv[1], chart_point(is_right(uv), nearest)[1], 1e-5);
      }
    }
  }
}

TEST(WedgesTest, HalfEdgeKeepsTheAttributesOfVerticesThatStayBitForBit) {
  // The strip with normals and colours that differ from place to place, less than what is apart.
  const WedgeMesh strip = textured_strip();
  WedgeMesh mesh{9, {}, {}, strip.triangles};
  for (std::uint32_t v = 0; v < strip.positions.size(); ++v) {
    const Vec3f at = strip.positions[v];
    const float noise = tests::hash_noise(static_cast<std::uint64_t>(100 * at.x + at.y), 5);
    const Vec3f normal = Vec3f{0.2F * noise, 0.1F, 1} * (1 / std::sqrt(1.01F + 0.04F * noise));
    mesh.add(at, {normal.x, normal.y, normal.z, 100 + 5 * noise, 20, 30, 255,
                  strip.attributes[2 * v], strip.attributes[2 * v + 1]});
  }
  for (const HalfEdgeCost cost : {HalfEdgeCost::quadric, HalfEdgeCost::melax}) {
    const ContractedTile c = contracted(tests::tile_of(mesh), 58, tests::kAllAttributes,
                                        {"", {Method::half_edge, {}, cost}});
    const TileMesh& tile = c.tile.mesh;
    std::size_t stay = 0;
    for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t old = raw(t[k]);
        const Vec3f now = c.contraction.representatives.positions[c.place(old)];
        if (tile.vertices.positions[old] != now)
          continue;
        EXPECT_EQ(c.image(old, wedges[k]), to_vector(tests::wedge_of(tile, old, wedges[k])));
        stay += c.count_at(c.place(old)) > 1 ? 1 : 0;
      }
    });
    EXPECT_GT(stay, 0U);
  }
}

/// A square of four triangles around a middle, vertex 0 of the mesh, whose place has two wedges:
/// 0 in two of the triangles, 1 in the others. All corners of the square are at places of their
/// own.
struct SplitMiddle {
  WedgeMesh mesh;
  std::array<std::uint32_t, 2> middle;  ///< vertices
  std::array<std::uint32_t, 4> corners;

  SplitMiddle(int channels, const Attributes& first, const Attributes& second) {
    mesh.channels = channels;
    middle = {mesh.add({0, 0, 0}, first), mesh.add({0, 0, 0}, second)};
    const std::array<Vec3f, 4> positions{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}};
    for (std::size_t k = 0; k < 4; ++k)
      corners[k] = mesh.add(positions[k], k < 2 ? first : second);
    for (std::uint32_t k = 0; k < 4; ++k)
      mesh.triangles.push_back({middle[k / 2], corners[k], corners[(k + 1) % 4]});
  }
};

TEST(WedgesTest, CoordinatesThatDifferInTheSignOfAZeroAreOne) {
  const SplitMiddle split(2, {0.0F, 0.5F}, {-0.0F, 0.5F});
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  EXPECT_THAT(c.wedges.copies.places, IsEmpty());
  EXPECT_THAT(c.at(0, 0), ElementsAre(0.0F, 0.5F));
}

TEST(WedgesTest, EqualPositionsWithZerosOfEitherSignAreOnePlace) {
  SplitMiddle split(2, {0.25F, 0.5F}, {0.75F, 0.5F});
  split.mesh.positions[split.middle[1]] = {-0.0F, 0, -0.0F};
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  EXPECT_EQ(c.at(0, c.wedges.map(0, 0)), (Attributes{0.25F, 0.5F}));
  EXPECT_EQ(c.at(0, c.wedges.map(0, 1)), (Attributes{0.75F, 0.5F}));
}

TEST(WedgesTest, TrianglesWithoutPlacesOfTheirOwnTieNoSidesTogether) {
  SplitMiddle split(2, {0.25F, 0.5F}, {0.75F, 0.5F});
  split.mesh.triangles.push_back({split.middle[0], split.middle[1], split.corners[1]});
  const BuildTile tile = tests::tile_of(split.mesh);
  ASSERT_THAT(tile.mesh.interior, SizeIs(5));
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  EXPECT_EQ(c.image(0, 0), (Attributes{0.25F, 0.5F}));
  EXPECT_EQ(c.image(0, 1), (Attributes{0.75F, 0.5F}));
}

TEST(WedgesTest, CoordinatesThatAreNotFiniteStayWithTheirWedges) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const SplitMiddle split(2, {0.25F, 0.5F}, {nan, infinite});
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  EXPECT_EQ(c.image(0, 0), (Attributes{0.25F, 0.5F}));
  EXPECT_TRUE(std::isnan(c.image(0, 1)[0]));
  EXPECT_EQ(c.image(0, 1)[1], infinite);
}

TEST(WedgesTest, AChartThatVanishesGoesToAWedgeOfItsPlace) {
  // A grid with a chart of two triangles in its middle, which shrinks to a point.
  const tests::TestMesh grid = tests::open_grid(5, 5);
  const WedgeMesh mesh = tests::welded(tests::soup_of(grid, 2, [&](std::uint32_t t, Vec3f p) {
    const bool inside = std::ranges::all_of(grid.triangles[t], [&](std::uint32_t v) {
      const Vec3f q = grid.positions[v];
      return q.x >= 2 && q.x <= 3 && q.y >= 2 && q.y <= 3;
    });
    return inside ? Attributes{0.9F + 0.01F * p.x, 0.9F} : Attributes{0.1F * p.x, 0.1F * p.y};
  }));
  const BuildTile tile = tests::tile_of(mesh);
  std::vector<std::uint32_t> parent_of;
  std::vector<Vec3f> positions{{2.5F, 2.5F, 0}};
  for (std::uint32_t p = 0; p < tile.mesh.own_count; ++p) {
    const bool shrinks = tile.mesh.copies.first_of(p) < tile.mesh.copies.first_of(p + 1);
    parent_of.push_back(shrinks ? 0 : tests::count_of(positions));
    if (!shrinks)
      positions.push_back(tile.mesh.vertices.positions[p]);
  }
  ASSERT_EQ(positions.size(), 33U);
  const ContractedTile c =
      contracted(tile, contraction_to(parent_of, positions, 2), kTexturedWedges);
  EXPECT_THAT(c.wedges.copies.places, IsEmpty());
  const Attributes uv = c.at(0, 0);
  EXPECT_LE(uv[0], 0.5F);
  EXPECT_GE(uv[0], 0.2F);
}

TEST(WedgesTest, AWedgeWithoutATriangleStaysInItsChart) {
  // Place 0 goes into place 1. Its triangle vanishes; its chart does not, but has other coordinates
  // there, and the chart beside it has its.
  WedgeMesh mesh{2, {}, {}, {}};
  const auto gone = mesh.add({0, 0, 0}, {0.5F, 0});
  const auto kept = mesh.add({1, 0, 0}, {0.1F, 0});
  const auto beside = mesh.add({1, 0, 0}, {0.5F, 0});
  const auto above = mesh.add({0, 1, 0}, {0.1F, 0.1F});
  const auto right = mesh.add({2, 0, 0}, {0.2F, 0});
  const auto below = mesh.add({1, -1, 0}, {0.5F, 0.1F});
  mesh.triangles = {{gone, kept, above}, {kept, right, above}, {beside, below, right}};
  const ContractedTile c =
      contracted(tests::tile_of(mesh),
                 contraction_to({0, 0, 1, 2, 3}, {{1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, -1, 0}}, 2),
                 kTexturedWedges);
  EXPECT_EQ(c.image(1, 0), (Attributes{0.1F, 0}));
  EXPECT_EQ(c.image(1, 1), (Attributes{0.5F, 0}));
  EXPECT_EQ(c.image(0, 0), (Attributes{0.1F, 0}));
}

// ---- normals -------------------------------------------------------------------------------

Vec3f face_normal(const tests::TestMesh& mesh, std::uint32_t t) {
  const Vec3d doubled = tests::doubled_normal(mesh, mesh.triangles[t]);
  return to_float(doubled * (1 / length(doubled)));
}

Attributes normal_at(const tests::TestMesh& mesh, std::uint32_t t) {
  const Vec3f n = face_normal(mesh, t);
  return {n.x, n.y, n.z};
}

WedgeMesh flat_shaded(const tests::TestMesh& mesh) {
  return tests::soup_of(mesh, 3, [&](std::uint32_t t, Vec3f) { return normal_at(mesh, t); });
}

TEST(WedgesTest, HardEdgesOfACubeStayHard) {
  const tests::TestMesh cube = tests::cube(6);
  for (const bool soup : {false, true}) {
    for (const NamedMethod& method : methods()) {
      SCOPED_TRACE(method.name);
      const WedgeMesh mesh = soup ? flat_shaded(cube) : tests::welded(flat_shaded(cube));
      const BuildTile tile = tests::tile_of(mesh);
      const ContractedTile c = contracted(tile, 100, kShadedWedges, method);
      std::size_t apart = 0;
      std::size_t count = 0;
      for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
        for (std::size_t k = 0; k < 3; ++k) {
          const auto old = tests::wedge_of(tile.mesh, raw(t[k]), wedges[k]);
          const Attributes now = c.image(raw(t[k]), wedges[k]);
          apart += to_vector(old) == now ? 0 : 1;
          ++count;
        }
      });
      EXPECT_EQ(apart, 0U) << "of " << count;
    }
  }
}

TEST(WedgesTest, AFineSurfaceWithANormalAFaceBecomesSmooth) {
  const tests::TestMesh ball = tests::sphere(2000);
  const BuildTile tile = tests::tile_of(flat_shaded(ball));
  EXPECT_GT(tile.mesh.copies.size(), 4000U);
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    const ContractedTile c = contracted(tile, tile.mesh.own_count / 2, kShadedWedges, method);
    EXPECT_THAT(c.wedges.copies.places, IsEmpty());
    for (std::uint32_t p = 0; p < c.contraction.representatives.size(); ++p) {
      const Attributes n = c.at(p, 0);
      const Vec3f normal{n[0], n[1], n[2]};
      const Vec3f position = c.contraction.representatives.positions[p];
      EXPECT_NEAR(length(normal), 1, 1e-6);
      EXPECT_GT(dot(normal, position) / length(position), 0.95);
    }
  }
}

TEST(WedgesTest, TheCreaseAngleDecidesWhatIsAnEdge) {
  const auto normal = [](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180;
    return Attributes{0, static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle))};
  };
  const SplitMiddle split(3, normal(-15), normal(15));  // triangles of equal area
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile smooth =
      contracted(tile, identity(tile), kShadedWedges, {.crease_angle = 31});
  EXPECT_THAT(smooth.wedges.copies.places, IsEmpty());
  EXPECT_NEAR(smooth.at(0, 0)[1], 0, 1e-6);
  EXPECT_NEAR(smooth.at(0, 0)[2], 1, 1e-6);
  const ContractedTile sharp =
      contracted(tile, identity(tile), kShadedWedges, {.crease_angle = 29});
  EXPECT_THAT(sharp.wedges.copies.places, ElementsAre(0));
  EXPECT_EQ(sharp.at(0, 0), normal(-15));
  EXPECT_EQ(sharp.at(0, 1), normal(15));
  const ContractedTile all = contracted(tile, identity(tile), kShadedWedges, {.crease_angle = 0});
  EXPECT_THAT(all.wedges.copies.places, ElementsAre(0));
}

TEST(WedgesTest, WhatShowsMostLeadsItsGroup) {
  // Normals at 0, 30 and 60 degrees, which all are near the middle one.
  const std::array<Attributes, 3> normals{
      Attributes{0, 0, 1}, {0, 0.5F, std::sqrt(0.75F)}, {0, std::sqrt(0.75F), 0.5F}};
  for (std::size_t largest = 0; largest < 3; ++largest) {
    WedgeMesh mesh{3, {}, {}, {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const float size = k == largest ? 2 : 1;
      const auto x = static_cast<float>(3 * k) + 1;
      const std::uint32_t tip = mesh.add({0, 0, 0}, normals[k]);
      const std::uint32_t side = mesh.add({x, 5, 0}, normals[k]);
      mesh.triangles.push_back({tip, side, mesh.add({x, 5, size / 10}, normals[k])});
    }
    const BuildTile tile = tests::tile_of(mesh);
    const ContractedTile c = contracted(tile, identity(tile), kShadedWedges);
    EXPECT_EQ(c.wedges.copies.size(), largest == 1 ? 0U : 1U) << largest;
  }
}

TEST(WedgesTest, NormalsWithoutADirectionChangeNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  for (const Attributes& nothing : {Attributes{0, 0, 0}, Attributes{nan, 0, 1},
                                    Attributes{0, infinite, 0}, Attributes{nan, nan, nan}}) {
    for (const bool first : {false, true}) {
      const Attributes up{0, 0, 1};
      const SplitMiddle split(3, first ? nothing : up, first ? up : nothing);
      const BuildTile tile = tests::tile_of(split.mesh);
      const ContractedTile c = contracted(tile, identity(tile), kShadedWedges);
      EXPECT_THAT(c.wedges.copies.places, IsEmpty());
      EXPECT_EQ(c.at(0, 0), up);
    }
    const SplitMiddle split(3, nothing, nothing);
    const BuildTile tile = tests::tile_of(split.mesh);
    EXPECT_THAT(contracted(tile, identity(tile), kShadedWedges).wedges.copies.places, IsEmpty());
  }
}

TEST(WedgesTest, ShadingStaysSmoothAcrossASeamOfTheTexture) {
  constexpr AttributeLayout kBoth{.normals = true, .texcoords = true};
  const tests::TestMesh ball = tests::sphere(800);
  const WedgeMesh mesh = tests::welded(tests::soup_of(ball, 5, [&](std::uint32_t t, Vec3f p) {
    const bool right = std::ranges::any_of(
        ball.triangles[t], [&](std::uint32_t v) { return ball.positions[v].x > 1e-6F; });
    return Attributes{p.x, p.y, p.z, right ? 0.7F + 0.2F * p.y : 0.2F + 0.2F * p.y, p.z};
  }));
  const BuildTile tile = tests::tile_of(mesh);
  ASSERT_FALSE(tile.mesh.copies.empty());
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    const ContractedTile c = contracted(tile, tile.mesh.own_count / 2, kBoth, method);
    ASSERT_FALSE(c.wedges.copies.empty());
    for (const std::uint32_t p : c.wedges.copies.places) {
      const Attributes a = c.at(p, 0);
      const Attributes b = c.at(p, 1);
      EXPECT_TRUE(std::equal(a.begin(), a.begin() + 3, b.begin()));
      EXPECT_NE(a[3], b[3]);
    }
  }
}

TEST(WedgesTest, ACubeKeepsChartsAndHardEdges) {
  constexpr AttributeLayout kBoth{.normals = true, .texcoords = true};
  const tests::TestMesh cube = tests::cube(6);
  // One chart a face: u tells which.
  const auto face_of = [&](std::uint32_t t) { return t / 72; };
  const WedgeMesh mesh = tests::welded(tests::soup_of(cube, 5, [&](std::uint32_t t, Vec3f p) {
    Attributes attributes = normal_at(cube, t);
    const auto face = static_cast<float>(face_of(t));
    attributes.push_back(face / 6 + (p.x + 2 * p.y + 4 * p.z + 7) / 14 * 0.1F);
    attributes.push_back((p.z + 2 * p.x + 4 * p.y + 7) / 14);
    return attributes;
  }));
  const BuildTile tile = tests::tile_of(mesh);
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    const ContractedTile c = contracted(tile, 60, kBoth, method);
    for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto old = tests::wedge_of(tile.mesh, raw(t[k]), wedges[k]);
        const Attributes now = c.image(raw(t[k]), wedges[k]);
        EXPECT_TRUE(std::equal(old.begin(), old.begin() + 3, now.begin()));
        EXPECT_EQ(std::floor(old[3] * 6 + 1e-4F), std::floor(now[3] * 6 + 1e-4F));
      }
    });
  }
}

// ---- colours -------------------------------------------------------------------------------

TEST(WedgesTest, AColourAFaceStaysApartAndNoiseDoesNot) {
  const tests::TestMesh grid = tests::open_grid(8, 8);
  const auto coloured = [&](float contrast) {
    return tests::soup_of(grid, 3, [&, contrast](std::uint32_t t, Vec3f) {
      const auto right = std::ranges::any_of(
          grid.triangles[t], [&](std::uint32_t v) { return grid.positions[v].x > 4; });
      return Attributes{100, 100 + (right ? contrast : 0), 50};
    });
  };
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    const BuildTile apart = tests::tile_of(coloured(17));  // 255 / 16 = 15.9
    const ContractedTile c = contracted(apart, 40, kColoured, method);
    EXPECT_FALSE(c.wedges.copies.empty());
    for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(c.image(raw(t[k]), wedges[k]),
                  to_vector(tests::wedge_of(apart.mesh, raw(t[k]), wedges[k])));
    });
    const BuildTile noisy = tests::tile_of(coloured(15));
    const ContractedTile one = contracted(noisy, 40, kColoured, method);
    EXPECT_THAT(one.wedges.copies.places, IsEmpty());
    for (const float channel : one.wedges.attributes) {
      EXPECT_GE(channel, 50);
      EXPECT_LE(channel, 115);
    }
  }
}

TEST(WedgesTest, AnyChannelOfAColourKeepsItApartAlphaToo) {
  constexpr AttributeLayout kWide{.colour = ColourType::u16, .alpha = true};
  for (std::size_t channel = 0; channel < 4; ++channel) {
    Attributes other(4, 30000);
    other[channel] += 65535.0F / 15;
    const SplitMiddle split(4, Attributes(4, 30000), other);
    const BuildTile tile = tests::tile_of(split.mesh);
    EXPECT_THAT(contracted(tile, identity(tile), kWide).wedges.copies.places, ElementsAre(0));
    EXPECT_THAT(contracted(tile, identity(tile), kWide, {.colour_tolerance = 1.0 / 14})
                    .wedges.copies.places,
                IsEmpty());
  }
}

TEST(WedgesTest, ColoursThatAreNotFiniteChangeNothing) {
  constexpr AttributeLayout kFloat{.colour = ColourType::f32};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const SplitMiddle split(3, {nan, 0, 0}, {0.5F, 0.5F, 0.5F});
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c = contracted(tile, identity(tile), kFloat);
  EXPECT_THAT(c.wedges.copies.places, IsEmpty());
  EXPECT_THAT(c.at(0, 0), Each(0.5F));
}

// ---- any tile ------------------------------------------------------------------------------

TEST(WedgesTest, WithoutAttributesAllWedgesOfAPlaceAreOne) {
  const WedgeMesh soup =
      tests::soup_of(tests::sphere(500), 0, [](std::uint32_t, Vec3f) { return Attributes{}; });
  const BuildTile tile = tests::tile_of(soup);
  ASSERT_GT(tile.mesh.copies.size(), 1000U);
  for (const NamedMethod& method : methods()) {
    const ContractedTile c = contracted(tile, 100, {}, method);
    EXPECT_THAT(c.wedges.copies.places, IsEmpty());
    EXPECT_THAT(c.wedges.map.firsts, Each(0U));
    EXPECT_THAT(c.wedges.map.copies, Each(0U));
    EXPECT_THAT(c.wedges.attributes, IsEmpty());
  }
}

TEST(WedgesTest, PlacesWithoutCopiesKeepWhatTheContractionGaveThem) {
  const SplitMiddle split(2, {0.25F, 0.5F}, {0.75F, 0.5F});
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  for (std::uint32_t p = 1; p < 5; ++p)
    EXPECT_THAT(c.at(p, 0), Each(kUntouched));
  EXPECT_NE(c.at(0, 0)[0], kUntouched);
}

TEST(WedgesTest, SheetsThatComeTogetherAcrossAGapDoNotBlend) {
  // Two sheets, x <= 2 and x >= 3, joined at their facing borders; a seam somewhere else.
  tests::TestMesh sheets = tests::open_grid(2, 4);
  tests::append(sheets, tests::open_grid(2, 4), {3, 0, 0});
  tests::WedgeMesh mesh = tests::welded(tests::soup_of(sheets, 2, [](std::uint32_t, Vec3f p) {
    return Attributes{p.x < 2.5F ? 0.1F : 0.9F, 0.5F};
  }));
  const auto seam = mesh.add({5, 4, 0}, {0.7F, 0.5F});
  mesh.triangles.push_back(
      {seam, mesh.add({6, 4, 0}, {0.7F, 0.5F}), mesh.add({6, 5, 0}, {0.7F, 0.5F})});
  const BuildTile tile = tests::tile_of(mesh);
  ASSERT_THAT(tile.mesh.copies.places, SizeIs(1));
  std::vector<std::uint32_t> parent_of(tile.mesh.own_count);
  std::vector<Vec3f> positions;
  for (std::uint32_t p = 0; p < tile.mesh.own_count; ++p) {
    const Vec3f at = tile.mesh.vertices.positions[p];
    const Vec3f to = at.x == 2 || at.x == 3 ? Vec3f{2.5F, at.y, 0} : at;
    const auto known = std::ranges::find(positions, to);
    parent_of[p] = static_cast<std::uint32_t>(known - positions.begin());
    if (known == positions.end())
      positions.push_back(to);
  }
  const ContractedTile c =
      contracted(tile, contraction_to(parent_of, positions, 2), kTexturedWedges);
  EXPECT_EQ(c.wedges.copies.size(), 1U + 5U);
  for (std::uint32_t p = 0; p < tile.mesh.own_count; ++p) {
    const Vec3f at = tile.mesh.vertices.positions[p];
    if (at.x == 2 || at.x == 3) {
      EXPECT_EQ(c.image(p, 0)[0], at.x == 2 ? 0.1F : 0.9F);
    }
  }
}

TEST(WedgesTest, WhereNothingSurvivesOneWedgeIsLeftAsItWas) {
  const SplitMiddle split(2, {0.25F, 0.5F}, {0.75F, 0.5F});
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c =
      contracted(tile, contraction_to({0, 0, 0, 0, 0}, {{0.5F, 0, 0}}, 2), kTexturedWedges);
  EXPECT_THAT(c.wedges.copies.places, IsEmpty());
  EXPECT_THAT(c.at(0, 0), Each(kUntouched));
  EXPECT_THAT(c.wedges.map.copies, ElementsAre(0));
}

TEST(WedgesTest, GhostsWithCopiesGiveTheirSideOfTheSeam) {
  // Places: own 0 and 1 on the seam, ghosts right of x = 0.5; both triangles are border triangles.
  WedgeMesh mesh{2, {}, {}, {}};
  const auto below = mesh.add({0, 0, 0}, {0.1F, 0.5F});
  const auto above = mesh.add({0, 0, 0}, {0.8F, 0.5F});
  const auto ghost_below = mesh.add({1, 0, 0}, {0.2F, 0.5F});
  const auto ghost_above = mesh.add({1, 0, 0}, {0.9F, 0.5F});
  const auto low = mesh.add({1, -1, 0}, {0.2F, 0.4F});
  const auto high = mesh.add({1, 1, 0}, {0.9F, 0.6F});
  mesh.triangles = {{below, low, ghost_below}, {above, ghost_above, high}};
  const BuildTile tile = tests::tile_of(mesh, 0.5F);
  ASSERT_EQ(tile.mesh.own_count, 1U);
  ASSERT_EQ(tile.mesh.copies.places, (std::vector<std::uint32_t>{0, 1}));
  const ContractedTile c =
      contracted(tile, contraction_to({0}, {{0.5F, 0, 0}}, 2), kTexturedWedges);
  EXPECT_THAT(c.wedges.copies.places, ElementsAre(0));
  EXPECT_NEAR(c.image(0, 0)[0], 0.15F, 1e-6);
  EXPECT_NEAR(c.image(0, 1)[0], 0.85F, 1e-6);
}

TEST(WedgesTest, CopiesOfGhostsAloneChangeNothing) {
  SplitMiddle split(2, {0.25F, 0.5F}, {0.75F, 0.5F});
  const BuildTile tile = tests::tile_of(split.mesh, -0.5F);
  ASSERT_EQ(tile.mesh.own_count, 1U);
  ASSERT_FALSE(tile.mesh.copies.empty());
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  EXPECT_THAT(c.wedges.attributes, Each(kUntouched));
}

TEST(WedgesTest, AnyTileHasSoundWedges) {
  for (const tests::NamedMesh& named : tests::small_meshes()) {
    SCOPED_TRACE(named.name);
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      // Each corner one of three sets of attributes, by chance.
      const auto pick = [&](std::uint32_t t, Vec3f p) {
        const auto noise =
            tests::hash_noise(t, seed * 100 + static_cast<std::uint64_t>(std::abs(p.x + p.y) * 10));
        const float kind = std::floor((noise + 1) * 1.5F);
        return Attributes{kind - 1, 0, 1 - kind, kind * 60, 0, 9, 255, p.x + kind * 10, p.y};
      };
      const BuildTile tile =
          tests::tile_of(tests::welded(tests::soup_of(named.mesh, 9, pick)), 0.3F);
      if (tile.mesh.copies.empty() || tile.mesh.own_count < 4)
        continue;
      for (const NamedMethod& method : methods()) {
        SCOPED_TRACE(method.name);
        contracted(tile, tile.mesh.own_count / 2, tests::kAllAttributes, method);
      }
    }
  }
}

TEST(WedgesTest, NoTwoWedgesOfAPlaceAreEqual) {
  // Charts that meet in one point with one coordinate: two classes would show the same.
  WedgeMesh mesh{2, {}, {}, {}};
  const tests::TestMesh wheel = tests::wheel(8, 1);
  mesh = tests::soup_of(wheel, 2, [](std::uint32_t, Vec3f) { return Attributes{0.5F, 0.5F}; });
  const BuildTile tile = tests::tile_of(mesh);
  const ContractedTile c = contracted(tile, 5, kTexturedWedges, methods()[0]);
  EXPECT_THAT(c.wedges.copies.places, IsEmpty());
}

TEST(WedgesTest, AHundredThousandWedgesAtOnePlaceAreOneMore) {
  // A cone; each triangle is a chart of its own. Rim vertices go in pairs, half of the triangles
  // with them. Quadratic work would take minutes.
  constexpr std::uint32_t kCount = 100000;
  const WedgeMesh mesh = tests::soup_of(tests::wheel(kCount, 1), 2, [](std::uint32_t t, Vec3f p) {
    return Attributes{static_cast<float>(t) + (p.z > 0 ? 0.25F : 0.75F), p.x};
  });
  const BuildTile tile = tests::tile_of(mesh);
  ASSERT_EQ(tile.mesh.own_count, kCount + 1);
  std::vector<std::uint32_t> parent_of;
  std::vector<Vec3f> positions;
  std::uint32_t apex = 0;
  for (std::uint32_t p = 0; p < tile.mesh.own_count; ++p) {
    const Vec3f position = tile.mesh.vertices.positions[p];
    const bool is_apex = position.z > 0;
    if (is_apex)
      apex = tests::count_of(positions);
    if (is_apex || positions.size() < 2 || p % 2 == 0)
      positions.push_back(position);
    parent_of.push_back(tests::count_of(positions) - 1);
  }
  const BuildTile& joined = tile;
  const Contraction contraction = contraction_to(parent_of, positions, 2);
  const ContractedWedges made = contract_wedges(joined, contraction, kTexturedWedges, {});
  const auto at_apex = std::ranges::count(made.copies.places, apex);
  EXPECT_GT(at_apex, kCount / 2 - 10);
  EXPECT_LT(at_apex, kCount / 2 + 10);
}

TEST(WedgesTest, NumbersFollowTheFirstOldWedges) {
  const SplitMiddle split(2, {0.75F, 0.5F}, {0.25F, 0.5F});
  const BuildTile tile = tests::tile_of(split.mesh);
  const ContractedTile c = contracted(tile, identity(tile), kTexturedWedges);
  EXPECT_EQ(c.wedges.map(0, 0), 0U);
  EXPECT_EQ(c.wedges.map(0, 1), 1U);
  EXPECT_EQ(c.at(0, 0), (Attributes{0.75F, 0.5F}));
}

// ---- objects ------------------------------------------------------------------------------

const AttributeLayout kObjects{.values = {{"object", ValueType::u32, true, true}}};

double object_in(std::span<const float> channels) {
  return value_in(ValueType::u32, channels.data());
}

/// Triangles of the mesh belong to objects by `object_of`.
WedgeMesh of_objects(const tests::TestMesh& mesh,
                     const std::function<double(std::uint32_t triangle)>& object_of) {
  return tests::welded(tests::soup_of(mesh, 2, [&](std::uint32_t t, Vec3f) {
    Attributes channels(2);
    put_value(ValueType::u32, object_of(t), channels.data());
    return channels;
  }));
}

/// Every triangle that survives still belongs to the object that it did.
void expect_objects_kept(const ContractedTile& c) {
  std::size_t survivors = 0;
  for_each_survivor(c, [&](const TileTriangle& t, const CornerWedges& wedges) {
    const double object = object_in(tests::wedge_of(c.tile.mesh, raw(t[0]), wedges[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      if (c.tile.mesh.is_own(t[k])) {
        EXPECT_EQ(object_in(c.image(raw(t[k]), wedges[k])), object);
      }
    }
    ++survivors;
  });
  EXPECT_GT(survivors, 0U);
}

TEST(WedgesTest, TrianglesKeepTheirObjectsWithAnyMethod) {
  const tests::TestMesh grid = tests::open_grid(12, 8);
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    for (const double many : {2.0, 7.0, 500.0}) {
      const WedgeMesh mesh = of_objects(grid, [&](std::uint32_t t) {
        return 4294967295.0 - std::fmod(std::floor(t / 3.0) * 5, many);
      });
      for (const float limit : {100.0F, 9.0F, 4.0F}) {
        const BuildTile tile = tests::tile_of(mesh, limit);
        expect_objects_kept(contracted(tile, tile.mesh.own_count / 2, kObjects, method));
      }
    }
  }
}

TEST(WedgesTest, PiecesThatOnlyAMethodBringsTogetherKeepTheirObjects) {
  // Boxes side by side, no two of which have a place in common.
  tests::TestMesh boxes;
  for (std::uint32_t box = 0; box < 20; ++box) {
    const tests::TestMesh cube = tests::cube(2);
    const auto first = static_cast<std::uint32_t>(boxes.positions.size());
    for (const Vec3f p : cube.positions)
      boxes.positions.push_back(p + Vec3f{2.01F * static_cast<float>(box), 0, 0});
    for (const tests::MeshTriangle& t : cube.triangles)
      boxes.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const auto triangles = static_cast<std::uint32_t>(boxes.triangles.size() / 20);
  const WedgeMesh mesh = of_objects(boxes, [&](std::uint32_t t) { return t / triangles; });
  for (const NamedMethod& method : methods()) {
    SCOPED_TRACE(method.name);
    const BuildTile tile = tests::tile_of(mesh);
    expect_objects_kept(contracted(tile, tile.mesh.own_count / 3, kObjects, method));
  }
}

TEST(WedgesTest, APieceThatVanishesDoesNotNameTheOneThatStays) {
  // A large triangle whose corners all come to one place, and a small one beside it that stays.
  tests::TestMesh mesh;
  mesh.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {10, 0, 0}, {11, 0, 0}, {10, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const BuildTile tile =
      tests::tile_of(of_objects(mesh, [](std::uint32_t t) { return t == 0 ? 7.0 : 5.0; }));
  Contraction contraction =
      contraction_to({0, 0, 0, 0, 1, 2}, {{3, 0, 0}, {11, 0, 0}, {10, 1, 0}}, 2);
  for (std::size_t v = 0; v < 3; ++v)
    put_value(ValueType::u32, v == 0 ? 7 : 5,
              contraction.representatives.attributes.data() + 2 * v);
  expect_objects_kept(contracted(tile, std::move(contraction), kObjects));
}

TEST(WedgesTest, OfAnyNumberOfObjectsAtAPlaceNoneTakesAnothers) {
  const WedgeMesh mesh =
      of_objects(tests::wheel(200, 0.1F), [](std::uint32_t t) { return t + 16777216.0; });
  const BuildTile tile = tests::tile_of(mesh);
  const ContractedTile c = contracted(tile, identity(tile), kObjects);
  expect_objects_kept(c);
  EXPECT_EQ(c.count_at(c.place(0)), 200U);
}

}  // namespace
}  // namespace meshhier::cluster_simplify
