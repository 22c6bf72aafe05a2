#include "cluster_simplify/contraction.h"

#include "base/error.h"
#include "cluster_simplify/cluster.h"
#include "cluster_simplify/edge_collapse.h"
#include "cluster_simplify/half_edge.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::Each;

struct NamedOptions {
  std::string name;
  ContractionOptions options;
};

void PrintTo(const NamedOptions& named, std::ostream* out) {
  *out << named.name;
}

const std::array<NamedOptions, 6>& all_methods() {
  static const std::array<NamedOptions, 6> all = {
      {{"cluster_mean", {Method::cluster, Representative::mean, {}}},
       {"cluster_quadric", {Method::cluster, Representative::quadric, {}}},
       {"cluster_vertex", {Method::cluster, Representative::vertex, {}}},
       {"edge_collapse", {Method::edge_collapse, {}, {}}},
       {"half_edge_quadric", {Method::half_edge, {}, HalfEdgeCost::quadric}},
       {"half_edge_melax", {Method::half_edge, {}, HalfEdgeCost::melax}}}};
  return all;
}

BuildTile sphere_tile() {
  return tests::tile_of(tests::sphere(1500, 0.03F));
}

/// Whole meshes, and parts of them whose neighbours are ghosts.
std::vector<std::pair<std::string, BuildTile>> nasty_tiles() {
  std::vector<std::pair<std::string, BuildTile>> tiles;
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    tiles.emplace_back(name, tests::tile_of(mesh));
    tiles.emplace_back("part of " + name, tests::part_of(mesh, 0.3F));
    if (tiles.back().second.mesh.own_count == 0)
      tiles.pop_back();
  }
  for (auto& [name, tile] : tiles)
    tests::add_attributes(tile);
  return tiles;
}

/// 1, everything, and from the one to the other in uneven steps.
std::set<std::uint32_t> targets_of(std::uint32_t own_count) {
  std::set<std::uint32_t> targets = {1, own_count, std::max(1U, own_count - 1),
                                     std::max(1U, own_count * 3 / 4)};
  for (std::uint32_t target = 2; target < own_count; target += 1 + target * 2 / 3)
    targets.insert(target);
  return targets;
}

bool finite(Vec3f p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void expect_onto(const Contraction& found, std::uint32_t own_count, std::uint32_t target) {
  ASSERT_EQ(found.parent_of.size(), own_count);
  ASSERT_EQ(found.representatives.size(), target);
  std::vector<bool> met(target);
  for (const std::uint32_t parent : found.parent_of)
    met.at(parent) = true;
  EXPECT_THAT(met, Each(true));
}

/// Normals: unit length, or zero where opposite ones cancel. Colours: within what the type holds.
void expect_attributes(const VertexArray& vertices) {
  ASSERT_EQ(vertices.channels, tests::kAllAttributes.channels());
  ASSERT_EQ(vertices.attributes.size(),
            vertices.size() * static_cast<std::size_t>(vertices.channels));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto values = vertices.attributes_of(i);
    ASSERT_TRUE(std::ranges::all_of(values, [](float value) { return std::isfinite(value); }));
    const double size = length(Vec3d{values[0], values[1], values[2]});
    ASSERT_TRUE(size == 0 || std::abs(size - 1) < 1e-6) << "a normal of length " << size;
    for (std::size_t k = 3; k < 7; ++k) {
      ASSERT_GE(values[k], 0);
      ASSERT_LE(values[k], 255.001F);
    }
  }
}

void expect_equal(const Contraction& a, const Contraction& b) {
  EXPECT_EQ(a.parent_of, b.parent_of);
  EXPECT_EQ(a.representatives.positions, b.representatives.positions);
  EXPECT_EQ(a.representatives.attributes, b.representatives.attributes);
  EXPECT_EQ(a.fallbacks.torn, b.fallbacks.torn);
  EXPECT_EQ(a.fallbacks.turned, b.fallbacks.turned);
  EXPECT_EQ(a.fallbacks.forced, b.fallbacks.forced);
  EXPECT_EQ(a.fallbacks.joined, b.fallbacks.joined);
}

TEST(ContractTest, TheDefaultIsEdgeCollapse) {
  EXPECT_EQ(ContractionOptions{}.method, Method::edge_collapse);
}

TEST(ContractTest, EachMethodIsTheOneOfThatName) {
  BuildTile tile = sphere_tile();
  tests::add_attributes(tile);
  const AttributeLayout& layout = tests::kAllAttributes;
  for (const auto& [name, options] : all_methods()) {
    SCOPED_TRACE(name);
    const Contraction expected =
        options.method == Method::cluster ? cluster(tile, 100, layout, options.representative)
        : options.method == Method::edge_collapse ? edge_collapse(tile, 100, layout)
                                                  : half_edge(tile, 100, options.cost);
    expect_equal(contract(tile, 100, layout, options), expected);
  }
}

TEST(ContractTest, AnUnknownMethodIsADefect) {
  try {
    contract(sphere_tile(), 100, {}, {static_cast<Method>(99), {}, {}});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
  }
}

/// The promises of contract(), of each method.
class MethodTest : public testing::TestWithParam<NamedOptions> {};

INSTANTIATE_TEST_SUITE_P(Methods, MethodTest, testing::ValuesIn(all_methods()),
                         [](const auto& method) { return method.param.name; });

TEST_P(MethodTest, TheParentMapIsOntoExactlySoManyAsAsked) {
  for (const auto& [name, tile] : nasty_tiles()) {
    for (const std::uint32_t target : targets_of(tile.mesh.own_count)) {
      SCOPED_TRACE(name + " to " + std::to_string(target));
      const Contraction found = contract(tile, target, tests::kAllAttributes, GetParam().options);
      expect_onto(found, tile.mesh.own_count, target);
      EXPECT_TRUE(std::ranges::all_of(found.representatives.positions, finite));
      expect_attributes(found.representatives);
      if (HasFailure())
        return;
    }
  }
}

TEST_P(MethodTest, EqualTilesGiveEqualResults) {
  for (const auto& [name, tile] : nasty_tiles()) {
    SCOPED_TRACE(name);
    const std::uint32_t target = std::max(1U, tile.mesh.own_count / 3);
    const Contraction first = contract(tile, target, tests::kAllAttributes, GetParam().options);
    const BuildTile copy = tile;
    expect_equal(contract(copy, target, tests::kAllAttributes, GetParam().options), first);
  }
}

TEST_P(MethodTest, AttributesDoNotChangeTheShape) {
  for (const auto& [name, tile] : nasty_tiles()) {
    SCOPED_TRACE(name);
    const std::uint32_t target = std::max(1U, tile.mesh.own_count / 3);
    BuildTile plain = tile;
    plain.mesh.vertices.channels = 0;
    plain.mesh.vertices.attributes.clear();
    const Contraction with = contract(tile, target, tests::kAllAttributes, GetParam().options);
    const Contraction without = contract(plain, target, {}, GetParam().options);
    EXPECT_EQ(with.parent_of, without.parent_of);
    EXPECT_EQ(with.representatives.positions, without.representatives.positions);
  }
}

TEST_P(MethodTest, AsManyRepresentativesAsVerticesMovesNone) {
  const BuildTile tile = sphere_tile();
  const Contraction found = contract(tile, tile.mesh.own_count, {}, GetParam().options);
  for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i) {
    ASSERT_EQ(found.representatives.positions[found.parent_of[i]], tile.mesh.vertices.positions[i]);
  }
}

TEST_P(MethodTest, ThousandsOfEqualVerticesStayWhereTheyAre) {
  tests::TestMesh mesh = tests::sphere(2000);
  std::ranges::fill(mesh.positions, Vec3f{3, 4, 5});
  const BuildTile tile = tests::tile_of(mesh);
  for (const std::uint32_t target : {1U, 300U, 900U}) {
    const Contraction found = contract(tile, target, {}, GetParam().options);
    expect_onto(found, tile.mesh.own_count, target);
    EXPECT_THAT(found.representatives.positions, Each(Vec3f{3, 4, 5}));
  }
}

TEST_P(MethodTest, ExtremeUnitsStayFiniteAndNearTheirBox) {
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    for (const float unit : {1e30F, 1e-30F, 1e-41F, 1e36F}) {
      SCOPED_TRACE(name + " times " + std::to_string(std::log10(unit)));
      tests::TestMesh scaled = mesh;
      float largest = 0;
      for (Vec3f& p : scaled.positions) {
        p = p * unit;
        largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      }
      const BuildTile tile = tests::tile_of(scaled);
      const std::uint32_t target = std::max(1U, tile.mesh.own_count / 4);
      const Contraction found = contract(tile, target, {}, GetParam().options);
      expect_onto(found, tile.mesh.own_count, target);
      for (const Vec3f p : found.representatives.positions) {
        ASSERT_LE(std::abs(p.x), 1.5F * largest);
        ASSERT_LE(std::abs(p.y), 1.5F * largest);
        ASSERT_LE(std::abs(p.z), 1.5F * largest);
      }
    }
  }
}

TEST_P(MethodTest, AClosedMeshStaysClosed) {
  const std::vector<tests::NamedMesh> meshes = {{"sphere", tests::sphere(700, 0.03F)},
                                                {"torus", tests::torus(600, 0.05F)},
                                                {"genus", tests::genus_n(3, 600)},
                                                {"shells", tests::nested_shells(600, 0.02F)},
                                                {"tetrahedra", tests::sphere(8)}};
  for (const auto& [name, mesh] : meshes) {
    const BuildTile tile = tests::tile_of(mesh);
    for (const std::uint32_t target : targets_of(tile.mesh.own_count)) {
      SCOPED_TRACE(name + " to " + std::to_string(target));
      const Contraction found = contract(tile, target, {}, GetParam().options);
      EXPECT_THAT(tests::boundary_edges(tests::image_of(tile, found).triangles),
                  testing::IsEmpty());
    }
  }
}

TEST_P(MethodTest, TheFirstAndTheLastVertexOfALargeTileHaveTheirPlace) {
  const BuildTile tile = tests::tile_of(tests::torus(129'000));
  ASSERT_LE(tile.mesh.own_count, 65'536U);
  ASSERT_GT(tile.mesh.own_count, 64'000U);
  const Contraction found = contract(tile, 32'768, {}, GetParam().options);
  expect_onto(found, tile.mesh.own_count, 32'768);
}

TEST(ContractTest, TheOrderOfTheTrianglesHardlyMovesKdCells) {
  // Sums of planes may round differently, nothing else may change.
  BuildTile tile = sphere_tile();
  const ContractionOptions options{Method::cluster, Representative::quadric, {}};
  const Contraction before = contract(tile, 100, {}, options);
  std::ranges::reverse(tile.mesh.interior);
  const Contraction after = contract(tile, 100, {}, options);
  EXPECT_EQ(before.parent_of, after.parent_of);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_LT(length(before.representatives.positions[i] - after.representatives.positions[i]),
              1e-5F);
  }
}

TEST(ContractTest, CollapsesComeCloserThanCellsAtEqualCount) {
  const BuildTile tile = tests::tile_of(tests::torus(9600));
  const auto worst = [&](const ContractionOptions& options) {
    double result = 0;  // distance of the triangles' centres from the torus
    const tests::TestMesh image = tests::image_of(tile, contract(tile, 400, {}, options));
    for (const tests::MeshTriangle& t : image.triangles) {
      Vec3d c{};
      for (const std::uint32_t v : t)
        c = c + to_double(image.positions[v]) * (1.0 / 3);
      const double around = std::hypot(c.x, c.y) - 0.7;
      result = std::max(result, std::abs(std::hypot(around, c.z) - 0.3));
    }
    return result;
  };
  const double cells = worst({Method::cluster, Representative::mean, {}});
  const double collapses = worst({});
  const double halves = worst({Method::half_edge, {}, HalfEdgeCost::quadric});
  EXPECT_LT(collapses, 0.5 * cells);
  EXPECT_LT(halves, cells);
  EXPECT_LT(collapses, halves);
}

}  // namespace
}  // namespace meshhier::cluster_simplify
