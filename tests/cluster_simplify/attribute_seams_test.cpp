#include "cluster_simplify/attribute_seams.h"

#include "cluster_simplify/contraction.h"
#include "cluster_simplify/wedges.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/cluster_simplify/wedge_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using Attributes = std::vector<float>;

constexpr AttributeLayout kTextured{.texcoords = true};
constexpr AttributeLayout kShaded{.normals = true};

/// A grid in [0, 8]^2, bent to a wave, whose corners have attributes by the side of x = 4 that
/// their triangle is on.
tests::WedgeMesh two_sides(int channels, const Attributes& left, const Attributes& right) {
  tests::TestMesh grid = tests::open_grid(8, 8);
  return tests::welded(tests::soup_of(grid, channels, [&](std::uint32_t t, Vec3f) {
    return std::ranges::any_of(grid.triangles[t],
                               [&](std::uint32_t v) { return grid.positions[v].x > 4; })
               ? right
               : left;
  }));
}

void expect_middle_line(const BuildTile& tile, const std::vector<PlaceEdge>& seams) {
  EXPECT_THAT(seams, SizeIs(8));
  EXPECT_TRUE(std::ranges::is_sorted(seams));
  for (const auto& [a, b] : seams) {
    EXPECT_LT(a, b);
    EXPECT_EQ(tile.mesh.vertices.positions[a].x, 4);
    EXPECT_EQ(tile.mesh.vertices.positions[b].x, 4);
  }
}

TEST(AttributeSeamsTest, AreWhereChartsNormalsOrColoursMeet) {
  const BuildTile charts = tests::tile_of(two_sides(2, {0, 0}, {0.5F, 0.5F}));
  expect_middle_line(charts, attribute_seams(charts, kTextured, {}));
  const BuildTile normals = tests::tile_of(two_sides(3, {0, 0, 1}, {1, 0, 0}));
  expect_middle_line(normals, attribute_seams(normals, kShaded, {}));
  const AttributeLayout coloured{.colour = ColourType::u8};
  const BuildTile colours = tests::tile_of(two_sides(3, {0, 0, 100}, {0, 0, 116}));
  expect_middle_line(colours, attribute_seams(colours, coloured, {}));
  EXPECT_THAT(attribute_seams(colours, coloured, {.colour_tolerance = 0.1}), IsEmpty());
  EXPECT_THAT(attribute_seams(normals, kShaded, {.crease_angle = 91}), IsEmpty());
}

TEST(AttributeSeamsTest, EdgesOfGhostsAreNone) {
  // x <= 3: the line x = 4 belongs to the neighbour.
  const BuildTile tile = tests::tile_of(two_sides(2, {0, 0}, {0.5F, 0.5F}), 3.0F);
  ASSERT_FALSE(tile.mesh.copies.empty());
  EXPECT_THAT(attribute_seams(tile, kTextured, {}), IsEmpty());
  // x <= 4: both triangles at each of its edges are here.
  const BuildTile with_line = tests::tile_of(two_sides(2, {0, 0}, {0.5F, 0.5F}), 4.0F);
  expect_middle_line(with_line, attribute_seams(with_line, kTextured, {}));
}

TEST(AttributeSeamsTest, EdgesFromOwnPlacesToGhostsAreNone) {
  const tests::TestMesh grid = tests::open_grid(8, 8);
  const BuildTile tile = tests::tile_of(
      tests::welded(tests::soup_of(grid, 2,
                                   [&](std::uint32_t t, Vec3f) {
                                     return std::ranges::any_of(grid.triangles[t],
                                                                [&](std::uint32_t v) {
                                                                  return grid.positions[v].y > 4;
                                                                })
                                                ? Attributes{0.5F, 0}
                                                : Attributes{0, 0};
                                   })),
      3.0F);
  const std::vector<PlaceEdge> seams = attribute_seams(tile, kTextured, {});
  EXPECT_THAT(seams, SizeIs(3));
  for (const auto& [a, b] : seams)
    EXPECT_LT(std::max(a, b), tile.mesh.own_count);
}

TEST(AttributeSeamsTest, TheSignOfAZeroIsNone) {
  const BuildTile tile =
      tests::tile_of(tests::soup_of(tests::sphere(100), 2, [](std::uint32_t t, Vec3f) {
        return Attributes{t % 2 == 0 ? 0.0F : -0.0F, t % 3 == 0 ? 0.0F : -0.0F};
      }));
  EXPECT_THAT(attribute_seams(tile, kTextured, {}), IsEmpty());
}

TEST(AttributeSeamsTest, TilesWithoutCopiesHaveNone) {
  BuildTile tile = tests::tile_of(tests::sphere(100));
  tests::add_attributes(tile);
  EXPECT_THAT(attribute_seams(tile, tests::kAllAttributes, {}), IsEmpty());
}

TEST(AttributeSeamsTest, EqualWedgesAndNormalsWithoutDirectionMakeNone) {
  const tests::TestMesh ball = tests::sphere(100);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const BuildTile tile = tests::tile_of(tests::soup_of(ball, 3, [&](std::uint32_t t, Vec3f) {
    return t % 3 == 0   ? Attributes{nan, 0, 0}
           : t % 3 == 1 ? Attributes{0, 0, 0}
                        : Attributes{0, 0, 1};
  }));
  ASSERT_FALSE(tile.mesh.copies.empty());
  EXPECT_THAT(attribute_seams(tile, kShaded, {}), IsEmpty());
}

TEST(AttributeSeamsTest, ATextureThatDiffersAtOneEndIsASeam) {
  // A cut that ends in the middle of a surface: its last edge has one wedge at the end, which is
  // the edge's lower place or its higher.
  for (const bool ends_low : {false, true}) {
    tests::WedgeMesh mesh{2, {}, {}, {}};
    const auto add_end = [&] { return mesh.add({0, 0, 0}, {0, 0}); };
    const auto low = ends_low ? add_end() : 0;
    const auto left = mesh.add({1, 0, 0}, {0.1F, 0});
    const auto right = mesh.add({1, 0, 0}, {0.2F, 0});
    const auto end = ends_low ? low : add_end();
    const auto a = mesh.add({0, 1, 0}, {0, 0.1F});
    const auto b = mesh.add({0, -1, 0}, {0, 0.2F});
    mesh.triangles = {{end, left, a}, {end, b, right}};
    EXPECT_THAT(attribute_seams(tests::tile_of(mesh), kTextured, {}), ElementsAre(PlaceEdge{0, 1}));
  }
}

/// A wavy sheet with a seam along x = 12: how far, on average, the seam's places have gone off it.
double seam_drift(const ContractionOptions& options, bool holds) {
  tests::TestMesh grid = tests::open_grid(24, 24, 0.2F);
  for (Vec3f& p : grid.positions) {
    p.z = 1.5F * std::sin(p.x * 0.5F) * std::sin(p.y * 0.4F);
    if (std::abs(p.x - 12) < 0.3F)
      p.x = 12;
  }
  const BuildTile tile =
      tests::tile_of(tests::welded(tests::soup_of(grid, 2, [&](std::uint32_t t, Vec3f p) {
        const bool right = std::ranges::any_of(
            grid.triangles[t], [&](std::uint32_t v) { return grid.positions[v].x > 12; });
        return Attributes{(right ? 100.0F : 0.0F) + p.x, p.y};
      })));
  const std::uint32_t target = tile.mesh.own_count / 4;
  const Contraction contraction =
      contract(tile, target, holds ? kTextured : AttributeLayout{}, options);
  const ContractedWedges wedges = contract_wedges(tile, contraction, kTextured, {});
  double sum = 0;
  for (const std::uint32_t place : wedges.copies.places)
    sum += std::abs(contraction.representatives.positions[place].x - 12);
  return sum / static_cast<double>(wedges.copies.size());
}

TEST(AttributeSeamsTest, ContractionKeepsThemInTheirPlaces) {
  for (const ContractionOptions& options :
       {ContractionOptions{}, ContractionOptions{Method::half_edge}}) {
    const double loose = seam_drift(options, false);
    const double held = seam_drift(options, true);
    EXPECT_LT(held, 0.25);
    EXPECT_LT(held, loose / 4) << loose;
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
