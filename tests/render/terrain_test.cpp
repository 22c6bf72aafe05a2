#include "render/terrain.h"

#include "base/srgb.h"
#include "tests/render/drawn.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

/// A grid of heights over [0, 10] x [0, 10], up along z.
PublishedTile hills(float height) {
  PublishedTile tile;
  constexpr std::uint32_t kSide = 11;
  for (std::uint32_t x = 0; x < kSide; ++x) {
    for (std::uint32_t y = 0; y < kSide; ++y)
      tile.mesh.vertices.positions.push_back(
          {static_cast<float>(x), static_cast<float>(y), (x + y) % 2 == 0 ? 0.0F : height});
  }
  tile.mesh.own_count = kSide * kSide;
  const auto at = [](std::uint32_t x, std::uint32_t y) {
    return static_cast<TileVertex>(kSide * x + y);
  };
  for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
    for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
      tile.mesh.interior.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      tile.mesh.interior.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return tile;
}

TEST(TerrainTest, HillsAreOneAndTellHowSteepTheyAre) {
  const auto terrain = terrain_of(hills(0.5F), UpAxis::z);
  ASSERT_TRUE(terrain);
  EXPECT_TRUE(terrain->is_upright);
  EXPECT_EQ(terrain->low, 0);
  EXPECT_EQ(terrain->high, 0.5);
  EXPECT_NEAR(terrain->slope, 0.5 * std::sqrt(2), 1e-6);  // over a unit along both axes
  EXPECT_EQ(terrain->relief(), 1);
  EXPECT_NEAR(terrain_of(hills(0.01F), UpAxis::z)->relief(), 0.5 / (0.01 * std::sqrt(2)), 1e-3);
}

TEST(TerrainTest, WhatIsHighOrHidesItselfIsNone) {
  EXPECT_FALSE(terrain_of(hills(9), UpAxis::z));
  PublishedTile folded = hills(0.5F);
  const std::vector<TileTriangle> above = folded.mesh.interior;
  for (const TileTriangle& t : above)
    folded.mesh.interior.push_back({t[0], t[2], t[1]});
  EXPECT_FALSE(terrain_of(folded, UpAxis::z));
  EXPECT_FALSE(terrain_of(PublishedTile(), UpAxis::z));
}

TEST(TerrainTest, ASheetOnItsSideIsSeenFromItsFrontIfItIsThin) {
  const auto sheet = terrain_of(hills(0.1F), UpAxis::y);
  ASSERT_TRUE(sheet);
  EXPECT_FALSE(sheet->is_upright);
  EXPECT_FALSE(terrain_of(hills(0.5F), UpAxis::y));
}

TEST(TerrainTest, ColoursFollowHeightsAndSlopesAreSteeper) {
  const Terrain terrain{.along = {0, 0, 1}, .low = 0, .high = 4, .slope = 0.05};
  std::vector<Facet> facets{flat_facet({0, 0, -1}, {0, 0, 1}, {0, 0, 9})};
  facets[0][0].normal = {0.1F, 0, 1};
  colour_by_height({terrain.along, terrain.low, terrain.high}, facets);
  shade_steeper(terrain, terrain.relief(), facets);
  EXPECT_EQ(screen_value(facets[0][0].colour.x), 0x4f);
  EXPECT_EQ(screen_value(facets[0][1].colour.y), 0xc2);
  EXPECT_EQ(screen_value(facets[0][2].colour.z), 0xee);
  EXPECT_NEAR(facets[0][0].normal.x / facets[0][0].normal.z, 1, 1e-5);  // ten times as steep
  EXPECT_EQ(facets[0][1].normal, Vec3f{});
}

}  // namespace
}  // namespace meshhier::render
