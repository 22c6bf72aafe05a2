// Labels of vertices through contractions.
#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/contraction.h"
#include "cluster_simplify/tile_wedges.h"
#include "hierarchy/value_mixer.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::IsEmpty;

const AttributeLayout kLabelled{.values = {{"class", ValueType::i32, true}}};

/// A flat grid whose vertices have one label up to x = 10, and another behind; 7 in a corner.
BuildTile labelled_grid() {
  BuildTile tile = tests::tile_of(tests::open_grid(20, 20));
  VertexArray& vertices = tile.mesh.vertices;
  vertices.channels = kLabelled.channels();
  vertices.attributes.resize(2 * vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec3f p = vertices.positions[v];
    const double label = p.x <= 10 ? 16777217 : -5;
    put_value(ValueType::i32, label, vertices.attributes.data() + 2 * v);
  }
  return tile;
}

double label_of(const VertexArray& vertices, std::size_t v) {
  return value_in(ValueType::i32, vertices.attributes_of(v).data());
}

TEST(LabelBorders, AreHeldOnBothSides) {
  const BuildTile tile = labelled_grid();
  const TileWedges wedges(tile.mesh);
  const std::vector<PlaceEdge> borders = label_borders(wedges, kLabelled);
  EXPECT_EQ(borders.size(), 40U);  // those at x = 10 and at x = 11
  EXPECT_TRUE(std::ranges::is_sorted(borders));
  for (const auto& [a, b] : borders) {
    const float x = tile.mesh.vertices.positions[a].x;
    EXPECT_EQ(tile.mesh.vertices.positions[b].x, x);
    EXPECT_TRUE(x == 10 || x == 11) << x;
  }
  EXPECT_EQ(attribute_seams(tile, kLabelled, {}), borders);
}

TEST(LabelBorders, OfQuantitiesThereAreNone) {
  AttributeLayout quantity = kLabelled;
  quantity.values[0].is_label = false;
  EXPECT_THAT(attribute_seams(labelled_grid(), quantity, {}), IsEmpty());
}

/// How far a triangle of one label reaches over the border, at most.
double overlap(const Contraction& contraction, const BuildTile& tile) {
  double most = 0;
  for (std::size_t place = 0; place < contraction.parent_of.size(); ++place) {
    const std::uint32_t to = contraction.parent_of[place];
    const double x = contraction.representatives.positions[to].x;
    if (label_of(contraction.representatives, to) == -5)
      most = std::max(most, 11 - x);
    else
      most = std::max(most, x - 10);
    static_cast<void>(tile);
  }
  return most;
}

TEST(Labels, NoMethodInventsOne) {
  const BuildTile tile = labelled_grid();
  for (const Method method : {Method::cluster, Method::edge_collapse, Method::half_edge}) {
    const Contraction contraction = contract(tile, 40, kLabelled, {.method = method});
    std::set<double> labels;
    for (std::size_t v = 0; v < contraction.representatives.size(); ++v)
      labels.insert(label_of(contraction.representatives, v));
    EXPECT_EQ(labels, (std::set<double>{-5, 16777217}));
  }
}

TEST(Labels, BordersStayWhereTheyAre) {
  const BuildTile tile = labelled_grid();
  const Contraction held = contract(tile, 40, kLabelled, {.method = Method::edge_collapse});
  EXPECT_LT(overlap(held, tile), 0.01);
}

TEST(Labels, ARepresentativeHasThatOfTheLargestArea) {
  // A fan of eight around the middle, which is the only one of its label.
  BuildTile tile = tests::tile_of(tests::wheel(8, 0));
  VertexArray& vertices = tile.mesh.vertices;
  vertices.channels = kLabelled.channels();
  vertices.attributes.resize(2 * vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const bool is_middle = vertices.positions[v] == Vec3f{};
    put_value(ValueType::i32, is_middle ? 1 : 2, vertices.attributes.data() + 2 * v);
  }
  const Contraction all = contract(tile, 1, kLabelled, {.method = Method::cluster});
  ASSERT_EQ(all.representatives.size(), 1U);
  EXPECT_EQ(label_of(all.representatives, 0), 2);
}

TEST(Values, QuantitiesAreInterpolatedLinearly) {
  BuildTile tile = tests::tile_of(tests::open_grid(20, 20));
  const AttributeLayout layout{.values = {{"height", ValueType::f64}}};
  VertexArray& vertices = tile.mesh.vertices;
  vertices.channels = layout.channels();
  vertices.attributes.resize(2 * vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec3f p = vertices.positions[v];
    put_value(ValueType::f64, 1e9 + 3.0 * p.x - p.y, vertices.attributes.data() + 2 * v);
  }
  for (const Representative kind : {Representative::mean}) {
    const Contraction contraction =
        contract(tile, 30, layout, {.method = Method::cluster, .representative = kind});
    for (std::size_t v = 0; v < contraction.representatives.size(); ++v) {
      const Vec3f p = contraction.representatives.positions[v];
      EXPECT_NEAR(value_in(ValueType::f64, contraction.representatives.attributes_of(v).data()),
                  1e9 + 3.0 * p.x - p.y, 1e-4);
    }
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
