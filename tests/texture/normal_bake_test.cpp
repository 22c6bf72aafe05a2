#include "texture/normal_bake.h"

#include "tests/texture/painted.h"
#include "tests/texture/random_numbers.h"
#include "texture/bake.h"
#include "texture/chart_layout.h"
#include "texture/charted_tile.h"
#include "texture/normal_texels.h"
#include "texture/vertex_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

struct Sheet {
  std::vector<Vec3f> positions;
  std::vector<TileTriangle> triangles;
  std::vector<CornerNormals> normals;

  NormalSurface surface() const { return {positions, triangles, normals, {}, nullptr}; }
};

/// A square of n x n cells over [0, 1], waves of that height on it, with the waves' normals; flat
/// where `height` is 0.
Sheet make_sheet(std::uint32_t n, double height) {
  constexpr double kWaves = 6 * 3.14159265358979;
  Sheet sheet;
  std::vector<Vec3f> normals;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = double(i) / n, y = double(j) / n;
      sheet.positions.push_back(
          to_float({x, y, height * std::sin(kWaves * x) * std::sin(kWaves * y)}));
      normals.push_back(
          to_float({-height * kWaves * std::cos(kWaves * x) * std::sin(kWaves * y),
                    -height * kWaves * std::sin(kWaves * x) * std::cos(kWaves * y), 1}));
    }
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    sheet.triangles.push_back({TileVertex{a}, TileVertex{b}, TileVertex{c}});
    sheet.normals.push_back({normals[a], normals[b], normals[c]});
  };
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      add(a, a + 1, a + n + 2);
      add(a, a + n + 2, a + n + 1);
    }
  }
  return sheet;
}

BakedNormalMap map_of(const Sheet& tile, const NormalSurface& finer, std::uint32_t side,
                      float least_texel = 0) {
  const std::vector<NormalSurface> surfaces{finer};
  return NormalBaker(tile.surface(), surfaces, side).bake(least_texel);
}

TEST(NormalBake, APictureAndAMapLieOnTheSameCharts) {
  const Sheet tile = make_sheet(4, 0), finer = make_sheet(24, 0.02);
  const std::vector<NormalSurface> surfaces{finer.surface()};
  const TexturedSurface bare{tile.positions, tile.triangles, {}, nullptr};
  const BakeSize size{64, 0.02F};
  const ChartedTile charts(bare, size, shapes_of(std::span<const NormalSurface>(surfaces)));
  const BakedNormalMap map = bake_normal_map(charts, tile.normals, surfaces);
  const BakedNormalMap alone = map_of(tile, finer.surface(), size.side, size.least_texel);
  EXPECT_EQ(map.map.texels, alone.map.texels);
  EXPECT_EQ(map.tangents, alone.tangents);

  images::Image white(8, 8, 3);
  std::ranges::fill(white.texels, std::uint8_t{255});
  const std::vector<CornerTexcoords> corners(finer.triangles.size(),
                                             {Vec2f{0.2F, 0.2F}, {0.6F, 0.2F}, {0.2F, 0.6F}});
  const std::vector<TexturedSurface> pictured{{finer.positions, finer.triangles, corners, &white}};
  const BakedTexture picture = bake(charts, pictured);
  const BakedTexture as_ever = bake(bare, pictured, size);
  EXPECT_EQ(picture.image.texels, as_ever.image.texels);
  EXPECT_EQ(picture.corners, as_ever.corners);
  EXPECT_EQ(picture.image.width, map.map.width);
  EXPECT_EQ(picture.image.height, map.map.height);
  for (std::size_t t = 0; t < map.corners.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(picture.corners[t][k].u, map.corners[t][k].u, 1.0 / 65535) << "rounded alone";
  }
}

TEST(NormalTexels, GiveBackWhatIsThere) {
  std::vector<NormalTexel> all(7 * 30);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 3 != 1)
      all[i] = {static_cast<std::int16_t>(i), -5, static_cast<std::int16_t>(1000 - i)};
  }
  const NormalTexels texels(7, 30, all);
  EXPECT_EQ(texels.known().size(), all.size() / 3 * 2);
  for (std::uint32_t y = 0; y < 30; ++y) {
    for (std::uint32_t x = 0; x < 7; ++x)
      ASSERT_EQ(texels.at(x, y), all[y * 7 + x]);
  }
  const NormalTexels again(7, 30, {texels.words().begin(), texels.words().end()},
                           {texels.known().begin(), texels.known().end()});
  EXPECT_EQ(again.at(3, 20), texels.at(3, 20));
}

TEST(NormalTexels, BetweenThemIsASmoothFunction) {
  std::vector<NormalTexel> all(16 * 16);
  for (std::int16_t i = 0; i < 256; ++i)
    all[static_cast<std::size_t>(i)] = {static_cast<std::int16_t>(100 * (i % 16)), 7, 9};
  const NormalTexels texels(16, 16, all);
  const FourFloats there = texels.direction_at({5.75, 8.1});
  EXPECT_NEAR(there[0], 525, 1e-3) << "a slope stays one";
  EXPECT_NEAR(there[1], 7, 1e-5);
  EXPECT_NEAR(texels.direction_at({6.5, 3.5})[0], 600, 1e-3) << "at a texel it is that";
}

TEST(NormalTexels, APartIsLookedUpAsTheWhole) {
  std::vector<NormalTexel> all(100 * 40);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = {static_cast<std::int16_t>(i * 7919 % 30000), 1, static_cast<std::int16_t>(i)};
  const NormalTexels whole(100, 40, all);
  const std::vector<CornerTexcoords> triangles{{Vec2f{0.2F, 0.1F}, {0.3F, 0.2F}, {0.25F, 0.4F}},
                                               {Vec2f{0.99F, 0.9F}, {1, 1}, {0.9F, 1}}};
  const NormalTexels part = whole.around(triangles);
  EXPECT_LT(part.known().size(), all.size() / 5);
  for (const CornerTexcoords& t : triangles) {
    for (double b = 0; b <= 1; b += 0.125) {
      for (double c = 0; b + c <= 1; c += 0.125) {
        const auto mixed = [&](float Vec2f::*axis) {
          return double{t[0].*axis} * (1 - b - c) + double{t[1].*axis} * b + double{t[2].*axis} * c;
        };
        const TexelPoint at{mixed(&Vec2f::u) * 100, mixed(&Vec2f::v) * 40};
        ASSERT_EQ(vector_of(part.direction_at(at)), vector_of(whole.direction_at(at)));
      }
    }
  }
}

TEST(NormalTexels, WhatIsNotKnownIsLeftOut) {
  std::vector<NormalTexel> all(8 * 8);
  EXPECT_EQ(vector_of(NormalTexels(8, 8, all).direction_at({4, 4})), Vec3f());
  all[4 * 8 + 4] = {0, 0, 32767};
  const FourFloats beside = NormalTexels(8, 8, all).direction_at({4.2, 4.2});
  EXPECT_GT(beside[2], 0);
  EXPECT_EQ(beside[0], 0);
}

TEST(VertexFrame, HasAxesOfLengthOne) {
  RandomNumbers random(3);
  const auto vector = [&] {
    const auto number = [&] { return 2 * random.part() - 1; };
    return Vec3d{number(), number(), number()};
  };
  for (int i = 0; i < 200; ++i) {
    ChartPlane plane;
    plane.normal = {0, 0, 1};
    plane.x = {1, 0, 0};
    plane.y = i % 2 == 0 ? Vec3d{0, 1, 0} : Vec3d{0, -1, 0};
    std::array<VertexFrame, 3> corners;
    for (VertexFrame& corner : corners) {
      const Vec3f normal = to_float(vector() * 0.4 + Vec3d{0, 0, 1});
      const TangentCode tangent = tangent_of(plane, normal);
      EXPECT_TRUE(is_tangent_code(tangent));
      EXPECT_EQ(tangent[3], i % 2 == 0 ? -127 : 127) << "a picture's v goes down";
      corner = frame_of(normal, tangent);
      EXPECT_NEAR(dot_of(corner.normal, corner.tangent), 0, 0.01);
    }
    const VertexFrame frame = interpolated(corners[0], corners[1], corners[2], {0.2F, 0.5F, 0.3F});
    for (const FourFloats axis : {frame.tangent, frame.bitangent, frame.normal})
      EXPECT_NEAR(dot_of(axis, axis), 1, 1e-6);
    EXPECT_GT(dot_of(frame.mixed(FourFloats{0, 0, 1, 0}), frame.normal), 0.999);
    const Vec3f up = cross(vector_of(frame.tangent), vector_of(frame.bitangent));
    EXPECT_GT(dot(up, vector_of(frame.normal)) * (i % 2 == 0 ? -1 : 1), 0.5);
  }
}

TEST(VertexFrame, AVertexSeenFromTheSideHasOneToo) {
  ChartPlane plane;
  plane.normal = {0, 0, 1};
  plane.x = {1, 0, 0};
  plane.y = {0, 1, 0};
  for (const Vec3f normal : {Vec3f{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {}, {-1, 0, 0.01F}})
    EXPECT_TRUE(is_tangent_code(tangent_of(plane, normal)));
}

TEST(NormalBake, AFlatTileShowsTheWavesOfTheOriginal) {
  const Sheet original = make_sheet(160, 0.01), tile = make_sheet(8, 0);
  const std::vector<NormalSurface> finer{original.surface()};
  const BakedNormalMap baked = NormalBaker(tile.surface(), finer, 256).bake(0);
  EXPECT_GT(baked.own_degrees, 4);
  EXPECT_LT(baked.map_degrees, baked.own_degrees / 10);
}

TEST(NormalBake, SomeLevelsLaterTheWavesAreStillThere) {
  const Sheet original = make_sheet(160, 0.01), tile = make_sheet(8, 0);
  BakedNormalMap baked = map_of(tile, original.surface(), 256);
  const double first = baked.map_degrees;
  for (int level = 0; level < 4; ++level) {
    const NormalSurface below{tile.positions, tile.triangles, {}, baked.corners, &baked.texels};
    BakedNormalMap next = map_of(tile, below, 252);
    baked = std::move(next);
  }
  double most = 0;
  for (std::uint32_t y = 0; y < baked.texels.height(); ++y) {
    for (std::uint32_t x = 0; x < baked.texels.width(); ++x)
      most = std::max(most, std::abs(double(baked.texels.at(x, y)[0])) / 32767);
  }
  EXPECT_NEAR(most, 0.185, 0.01) << "the steepest slope";
  EXPECT_LT(first, 0.6);
}

TEST(NormalBake, EqualTrianglesGetEqualCorners) {
  const Sheet original = make_sheet(40, 0.01);
  Sheet tile = make_sheet(4, 0);
  tile.triangles.push_back(tile.triangles.front());
  tile.normals.push_back(tile.normals.front());
  const BakedNormalMap baked = map_of(tile, original.surface(), 128);
  ASSERT_EQ(baked.corners.size(), tile.triangles.size());
  EXPECT_EQ(baked.corners.back(), baked.corners.front());
  EXPECT_EQ(baked.tangents.back(), baked.tangents.front());
}

TEST(NormalBake, HoweverLongTheNormalsOfTheOriginalAre) {
  const Sheet original = make_sheet(40, 0.01), tile = make_sheet(4, 0);
  const BakedNormalMap expected = map_of(tile, original.surface(), 64);
  for (const float scale : {1e25F, 1e-25F}) {
    Sheet scaled = original;
    for (CornerNormals& corners : scaled.normals) {
      for (Vec3f& normal : corners)
        normal = normal * scale;
    }
    EXPECT_NEAR(map_of(tile, scaled.surface(), 64).map_degrees, expected.map_degrees, 0.01);
  }
}

TEST(NormalBake, BetweenChartsTheMapIsFlat) {
  const Sheet original = make_sheet(40, 0.01), tile = make_sheet(4, 0);
  const BakedNormalMap baked = map_of(tile, original.surface(), 128);
  EXPECT_LE(baked.map.width, 128U);
  std::size_t flat = 0;
  for (std::uint32_t y = 0; y < baked.map.height; ++y) {
    for (std::uint32_t x = 0; x < baked.map.width; ++x) {
      if (baked.texels.at(x, y) != NormalTexel{})
        continue;
      const std::uint8_t* texel = baked.map.at(x, y);
      ASSERT_THAT((std::array{texel[0], texel[1], texel[2]}), testing::ElementsAre(128, 128, 255));
      ++flat;
    }
  }
  EXPECT_GT(flat, 0U);
}

TEST(NormalBake, CoordinatesAreThoseOfTheFile) {
  const Sheet original = make_sheet(40, 0.01), tile = make_sheet(4, 0);
  const BakedNormalMap baked = map_of(tile, original.surface(), 128);
  for (const CornerTexcoords& corners : baked.corners) {
    for (const Vec2f& corner : corners) {
      const double steps = double{corner.u} * 65535;
      ASSERT_NEAR(steps, std::round(steps), 0.01);
    }
  }
}

TEST(NormalBake, WhatWasBakedBeforeDecidesNothing) {
  const Sheet original = make_sheet(40, 0.01), tile = make_sheet(4, 0);
  const std::vector<NormalSurface> finer{original.surface()};
  const NormalSurface surface = tile.surface();
  NormalBaker baker(surface, finer, 256);
  const BakedNormalMap coarse = baker.bake(1.0F / 64), fine = baker.bake(1.0F / 128);
  EXPECT_GT(fine.map.width, coarse.map.width);
  EXPECT_EQ(fine.map, map_of(tile, original.surface(), 256, 1.0F / 128).map);
  EXPECT_EQ(baker.bake(1.0F / 64).map, coarse.map);
}

TEST(NormalBake, NoTexelIsSmallerThanAsked) {
  const Sheet original = make_sheet(40, 0.01), tile = make_sheet(4, 0);
  const BakedNormalMap baked = map_of(tile, original.surface(), 256, 1.0F / 64);
  EXPECT_GE(baked.texel, 1.0F / 64);
  EXPECT_LT(baked.map.width, 128U);
}

}  // namespace
}  // namespace meshhier::texture
