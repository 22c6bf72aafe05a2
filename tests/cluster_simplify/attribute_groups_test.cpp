#include "cluster_simplify/attribute_groups.h"

#include "cluster_simplify/attribute_metric.h"
#include "cluster_simplify/tile_wedges.h"
#include "tests/cluster_simplify/wedge_tiles.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::ElementsAre;

/// Numbers, apart by more than 1; counts how often they are compared.
struct CountedKind {
  double distance(const AttributePoint& a, const AttributePoint& b) const {
    ++comparisons;
    return std::abs(a[0] - b[0]);
  }
  double limit() const { return 1; }
  mutable std::uint64_t comparisons = 0;
};

TEST(LeadersTest, WhatIsApartFromAllLeadersBecomesOne) {
  const CountedKind kind;
  Leaders<CountedKind> leaders(kind);
  for (const double x : {5.0, 6.0, 6.5, 4.0, 3.5})
    leaders.offer({x});
  EXPECT_EQ(leaders.size(), 3U);
  EXPECT_EQ(leaders.nearest({5.6}).leader, 0U);
  EXPECT_EQ(leaders.nearest({5.9}).leader, 1U);
  EXPECT_EQ(leaders.nearest({4.25}).leader, 0U);  // between two: the first
  EXPECT_DOUBLE_EQ(leaders.nearest({1}).distance, 2.5);
}

TEST(LeadersTest, AreNoMoreThanTheirLimitSoThatWorkIsLinear) {
  const CountedKind kind;
  Leaders<CountedKind> leaders(kind);
  constexpr std::uint64_t kCount = 100000;
  for (std::uint64_t i = 0; i < kCount; ++i)
    leaders.offer({3.0 * static_cast<double>(i)});
  EXPECT_EQ(leaders.size(), 32U);
  EXPECT_EQ(leaders.nearest({1e9}).leader, 31U);
  EXPECT_LE(kind.comparisons, 32 * (kCount + 1));
}

/// Wedges of one place, with normals.
class NormalGroupsTest : public testing::Test {
 protected:
  AttributeGroups groups(const std::vector<std::array<float, 3>>& normals,
                         const std::vector<ClusterWedge>& cluster,
                         const std::vector<std::uint32_t>& order) const {
    tests::WedgeMesh mesh{3, {}, {}, {}};
    for (const auto& n : normals)
      mesh.add({0, 0, 0}, {n.begin(), n.end()});
    const BuildTile tile = tests::tile_of(mesh);
    return group_attributes(metrics_of({{.normals = true}}, {})[0], TileWedges(tile.mesh), cluster,
                            order);
  }
};

TEST_F(NormalGroupsTest, AGroupIsTheMeanByAreaOfWhatIsNearItsLeader) {
  const AttributeGroups made =
      groups({{0, 0, 1}, {0, 0.6F, 0.8F}, {1, 0, 0}},
             {{0, 3, true, false}, {1, 1, false, false}, {2, 1, true, false}}, {0, 2});
  EXPECT_THAT(made.group_of, ElementsAre(0, 0, 1));
  ASSERT_EQ(made.values.size(), 2U);
  const double size = std::sqrt(0.6 * 0.6 + 3.8 * 3.8);
  EXPECT_FLOAT_EQ(made.values[0][1], static_cast<float>(0.6 / size));
  EXPECT_FLOAT_EQ(made.values[0][2], static_cast<float>(3.8 / size));
  EXPECT_THAT(made.values[1], ElementsAre(1, 0, 0, 0));
}

TEST_F(NormalGroupsTest, ThoseAtTheNewPlaceSpeakForTheirGroup) {
  const AttributeGroups made =
      groups({{0, 0, 1}, {0, 0.6F, 0.8F}}, {{0, 3, true, false}, {1, 1, false, true}}, {0});
  EXPECT_THAT(made.group_of, ElementsAre(0, 0));
  EXPECT_THAT(made.values, ElementsAre(ElementsAre(0, 0.6F, 0.8F, 0)));
}

TEST_F(NormalGroupsTest, EqualOnesKeepTheirNumbers) {
  const AttributeGroups made = groups({{0, 0.6F, 0.9F}, {0, 0.6F, 0.9F}},
                                      {{0, 3, true, false}, {1, 1, true, false}}, {0, 1});
  EXPECT_THAT(made.values, ElementsAre(ElementsAre(0, 0.6F, 0.9F, 0)));
}

TEST_F(NormalGroupsTest, WithoutAreaTheFirstSpeaks) {
  const AttributeGroups made =
      groups({{0, 0, 1}, {0, 0.6F, 0.8F}}, {{0, 0, true, false}, {1, 0, true, false}}, {0, 1});
  EXPECT_THAT(made.values, ElementsAre(ElementsAre(0, 0, 1, 0)));
}

}  // namespace
}  // namespace meshhier::cluster_simplify
