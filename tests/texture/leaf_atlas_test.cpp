#include "texture/leaf_atlas.h"

#include "tests/texture/random_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Leaf {
  std::vector<TileTriangle> triangles;
  std::vector<Vec2f> texcoords;
  std::vector<std::uint32_t> materials;

  std::uint32_t vertex(Vec2f at, std::uint32_t material = 0) {
    texcoords.push_back(at);
    materials.push_back(material);
    return static_cast<std::uint32_t>(texcoords.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles.push_back({TileVertex{a}, TileVertex{b}, TileVertex{c}});
  }
  void triangle(Vec2f a, Vec2f b, Vec2f c, std::uint32_t material = 0) {
    const std::uint32_t first = vertex(a, material);
    vertex(b, material);
    vertex(c, material);
    triangle(first, first + 1, first + 2);
  }
  /// A grid of side * side squares over the box.
  void grid(Vec2f low, Vec2f high, std::uint32_t side, std::uint32_t material = 0) {
    const auto first = static_cast<std::uint32_t>(texcoords.size());
    for (std::uint32_t y = 0; y <= side; ++y) {
      for (std::uint32_t x = 0; x <= side; ++x)
        vertex({low.u + (high.u - low.u) * float(x) / float(side),
                low.v + (high.v - low.v) * float(y) / float(side)},
               material);
    }
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        const std::uint32_t at = first + y * (side + 1) + x;
        triangle(at, at + 1, at + side + 1);
        triangle(at + 1, at + side + 2, at + side + 1);
      }
    }
  }
  operator LeafTriangles() const { return {triangles, texcoords, materials}; }
};

std::uint32_t levels_of(std::uint32_t width, std::uint32_t height) {
  std::uint32_t levels = 1;
  for (std::uint32_t side = std::max(width, height); side > 1; side = (side + 1) / 2)
    ++levels;
  return levels;
}
AtlasMaterial picture(std::uint32_t width, std::uint32_t height) {
  return {width, height, levels_of(width, height)};
}

std::uint32_t level_side_of(std::uint32_t side, std::uint32_t level) {
  for (; level > 0; --level)
    side = (side + 1) / 2;
  return side;
}

std::uint64_t wrapped(std::int64_t at, std::int64_t side, Wrap wrap) {
  const std::int64_t period = wrap == Wrap::mirrored ? 2 * side : side;
  const std::int64_t in = (at % period + period) % period;
  if (wrap == Wrap::clamp)
    return static_cast<std::uint64_t>(std::clamp<std::int64_t>(at, 0, side - 1));
  return static_cast<std::uint64_t>(in < side ? in : period - 1 - in);
}

/// Any value for any texel of a picture.
double texel(const AtlasMaterial& of, std::uint32_t level, std::int64_t x, std::int64_t y) {
  const std::uint64_t at_x = wrapped(x, level_side_of(of.width, level), of.wrap_u);
  const std::uint64_t at_y = wrapped(y, level_side_of(of.height, level), of.wrap_v);
  const std::uint64_t mixed = (at_x * 0x9E3779B97F4A7C15U ^ at_y * 0xC2B2AE3D27D4EB4FU ^ level);
  return static_cast<double>((mixed * 0xD6E8FEB86659FD93U) >> 56);
}

/// Returns the colour that a sampler sees at texel coordinates.
template <class At>
double bilinear(double x, double y, const At& at) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const double right = x - 0.5 - left, down = y - 0.5 - top;
  const auto i = static_cast<std::int64_t>(left);
  const auto j = static_cast<std::int64_t>(top);
  return (at(i, j) * (1 - right) + at(i + 1, j) * right) * (1 - down) +
         (at(i, j + 1) * (1 - right) + at(i + 1, j + 1) * right) * down;
}

/// The atlas drawn with texel().
class Drawn {
 public:
  Drawn(const LeafAtlas& atlas, const std::vector<AtlasMaterial>& materials)
      : atlas_(atlas), piece_at_(std::size_t{atlas.width} * atlas.height, -1) {
    for (std::size_t p = 0; p < atlas.pieces.size(); ++p) {
      const AtlasPiece& piece = atlas.pieces[p];
      EXPECT_EQ((piece.atlas_x | piece.atlas_y | piece.width | piece.height) % kLeafAlignment, 0U);
      EXPECT_LE(piece.atlas_x + piece.width, atlas.width);
      EXPECT_LE(piece.atlas_y + piece.height, atlas.height);
      for (std::uint32_t y = 0; y < piece.height; ++y) {
        for (std::uint32_t x = 0; x < piece.width; ++x) {
          int& at = piece_at_[(piece.atlas_y + y) * std::size_t{atlas.width} + piece.atlas_x + x];
          EXPECT_EQ(at, -1);
          at = static_cast<int>(p);
        }
      }
    }
    for (const AtlasPiece& piece : atlas.pieces)
      EXPECT_LT(piece.material, materials.size());
    materials_ = materials;
  }

  int piece_at(double u, double v) const {
    const auto x = static_cast<std::size_t>(std::clamp(u * atlas_.width, 0.0, atlas_.width - 1.0));
    const auto y =
        static_cast<std::size_t>(std::clamp(v * atlas_.height, 0.0, atlas_.height - 1.0));
    return piece_at_[y * atlas_.width + x];
  }

  double sample(double u, double v) const {
    return bilinear(u * atlas_.width, v * atlas_.height, [&](std::int64_t x, std::int64_t y) {
      const int p = piece_at_[static_cast<std::size_t>(y * atlas_.width + x)];
      const AtlasPiece& piece = atlas_.pieces[static_cast<std::size_t>(p)];
      return texel(materials_[piece.material], piece.level, x - piece.atlas_x + piece.x,
                   y - piece.atlas_y + piece.y);
    });
  }

 private:
  const LeafAtlas& atlas_;
  std::vector<int> piece_at_;
  std::vector<AtlasMaterial> materials_;
};

Vec2f between(const CornerTexcoords& at, double b, double c) {
  const double a = 1 - b - c;
  return {static_cast<float>(a * at[0].u + b * at[1].u + c * at[2].u),
          static_cast<float>(a * at[0].v + b * at[1].v + c * at[2].v)};
}

/// The corners of a triangle lie in one piece, with the gutter around them.
void expect_gutters(const LeafAtlas& atlas, const std::vector<AtlasMaterial>& materials) {
  const Drawn drawn(atlas, materials);
  constexpr double kRounding = 0.01;
  for (const CornerTexcoords& corners : atlas.corners) {
    const int p = drawn.piece_at(corners[0].u, corners[0].v);
    ASSERT_GE(p, 0);
    const AtlasPiece& piece = atlas.pieces[static_cast<std::size_t>(p)];
    for (const Vec2f& corner : corners) {
      const double x = double(corner.u) * atlas.width, y = double(corner.v) * atlas.height;
      EXPECT_GE(x - piece.atlas_x, kLeafGutter - kRounding);
      EXPECT_GE(y - piece.atlas_y, kLeafGutter - kRounding);
      EXPECT_LE(x - piece.atlas_x, piece.width - kLeafGutter + kRounding);
      EXPECT_LE(y - piece.atlas_y, piece.height - kLeafGutter + kRounding);
    }
  }
}

/// Everywhere in the triangles that the atlas shows texel by texel it looks like the input.
void expect_input_texels(const Leaf& leaf, const LeafAtlas& atlas,
                         const std::vector<AtlasMaterial>& materials) {
  const Drawn drawn(atlas, materials);
  for (std::size_t t = 0; t < leaf.triangles.size(); ++t) {
    const std::array<TileVertex, 3>& corners = leaf.triangles[t];
    const AtlasMaterial& picture = materials[leaf.materials[raw(corners[0])]];
    for (const auto& [b, c] :
         {std::array{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {0.3, 0.3}, {0.5, 0.5}}) {
      const auto source = [&](auto member) {
        return (1 - b - c) * double(leaf.texcoords[raw(corners[0])].*member) +
               b * double(leaf.texcoords[raw(corners[1])].*member) +
               c * double(leaf.texcoords[raw(corners[2])].*member);
      };
      const double expected =
          bilinear(source(&Vec2f::u) * picture.width, source(&Vec2f::v) * picture.height,
                   [&](std::int64_t x, std::int64_t y) { return texel(picture, 0, x, y); });
      const Vec2f at = between(atlas.corners[t], b, c);
      // 255 a texel, and a texel's coordinate is a float.
      EXPECT_NEAR(drawn.sample(at.u, at.v), expected, 255 * 4e-3) << t;
    }
  }
}

TEST(LeafAtlas, NothingMakesNothing) {
  const LeafAtlas atlas = plan_leaf_atlas({}, {}, 4096);
  EXPECT_EQ(atlas.width, 0U);
  EXPECT_EQ(atlas.height, 0U);
  EXPECT_TRUE(atlas.pieces.empty());
}

TEST(LeafAtlas, ATexelOfTheAtlasIsATexelOfTheInput) {
  Leaf leaf;
  leaf.grid({0.13f, 0.21f}, {0.41f, 0.33f}, 5);
  leaf.grid({0.5f, 0.5f}, {0.9f, 0.99f}, 3, 1);
  leaf.grid({-0.2f, -0.1f}, {0.05f, 0.08f}, 4);    // over the picture's border
  leaf.grid({117.25f, -33.5f}, {117.5f, -33}, 2);  // far from 0
  const std::vector<AtlasMaterial> materials = {picture(333, 517), picture(128, 64)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.charts, 4U);
  EXPECT_EQ(atlas.reduced, 0U);
  expect_gutters(atlas, materials);
  expect_input_texels(leaf, atlas, materials);
}

TEST(LeafAtlas, TrianglesThatShareAVertexOrACoordinateAreOneChart) {
  Leaf leaf;
  leaf.triangle(Vec2f{0.1f, 0.1f}, {0.2f, 0.1f}, {0.1f, 0.2f});
  leaf.triangle(1, leaf.vertex({0.2f, 0.2f}), 2);                   // shares vertices
  leaf.triangle(Vec2f{0.2f, 0.2f}, {0.3f, 0.2f}, {0.2f, 0.3f});     // shares a coordinate
  leaf.triangle(Vec2f{0.2f, 0.2f}, {0.3f, 0.2f}, {0.2f, 0.3f}, 1);  // with another material
  leaf.triangle(Vec2f{0.7f, 0.7f}, {0.8f, 0.7f}, {0.7f, 0.8f});
  const std::vector<AtlasMaterial> materials = {picture(64, 64), picture(64, 64)};
  EXPECT_EQ(plan_leaf_atlas(leaf, materials, 4096).charts, 3U);
}

TEST(LeafAtlas, ADiagonalStripIsCutIntoPieces) {
  Leaf leaf;
  std::uint32_t a = leaf.vertex({0, 0}), b = leaf.vertex({0.02f, 0});
  for (int i = 1; i <= 100; ++i) {
    const float at = 0.0098f * float(i);
    const std::uint32_t c = leaf.vertex({at, at}), d = leaf.vertex({at + 0.02f, at});
    leaf.triangle(a, b, c);
    leaf.triangle(b, d, c);
    a = c;
    b = d;
  }
  const std::vector<AtlasMaterial> materials = {picture(1000, 1000)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_GT(atlas.pieces.size(), 5U);
  // 100 * 2 triangles of 98 texels are 20,000; the whole box has 1,000,000.
  EXPECT_LT(atlas.width * atlas.height, 150000U);
  expect_gutters(atlas, materials);
  expect_input_texels(leaf, atlas, materials);
}

TEST(LeafAtlas, AFullChartStaysWhole) {
  Leaf leaf;
  leaf.grid({0, 0}, {1, 1}, 20);
  const std::vector<AtlasMaterial> materials = {picture(500, 500)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.pieces.size(), 1U);
  EXPECT_EQ(atlas.width, 512U);
  EXPECT_EQ(atlas.height, 512U);
}

TEST(LeafAtlas, AChartThatIsTooWideIsCutBeforeItGetsCoarser) {
  Leaf leaf;
  leaf.grid({0, 0}, {1, 0.03f}, 32);
  const std::vector<AtlasMaterial> materials = {picture(1024, 1024)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 512);
  EXPECT_GE(atlas.pieces.size(), 2U);
  EXPECT_EQ(atlas.reduced, 0U);
  EXPECT_LE(atlas.width, 512U);
  EXPECT_LE(atlas.height, 512U);
  expect_input_texels(leaf, atlas, materials);
}

TEST(LeafAtlas, AWallOfManyBricksTakesACoarserLevel) {
  Leaf leaf;
  leaf.grid({0, 0}, {40, 20}, 1);
  leaf.grid({0.25f, 0.25f}, {0.5f, 0.5f}, 1, 1);
  const std::vector<AtlasMaterial> materials = {picture(512, 512), picture(512, 512)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 1024);
  EXPECT_LE(atlas.width, 1024U);
  EXPECT_LE(atlas.height, 1024U);
  EXPECT_EQ(atlas.reduced, 2U);
  expect_gutters(atlas, materials);
  for (const AtlasPiece& piece : atlas.pieces)
    EXPECT_EQ(piece.level, piece.material == 0 ? 5U : 0U);
}

TEST(LeafAtlas, TheLargestChartsGetCoarserUntilAllFit) {
  Leaf leaf;
  for (int i = 0; i < 12; ++i) {
    const float u = float(i % 4) / 4, v = float(i / 4) / 4;
    leaf.grid({u + 0.01f, v + 0.01f}, {u + 0.24f, v + 0.24f}, 2);
  }
  leaf.grid({5.001f, 5.001f}, {5.002f, 5.002f}, 2);
  const std::vector<AtlasMaterial> materials = {picture(2000, 2000)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 1024);
  EXPECT_LE(atlas.width, 1024U);
  EXPECT_LE(atlas.height, 1024U);
  EXPECT_GT(atlas.reduced, 0U);
  EXPECT_EQ(atlas.reduced % 8, 0U);
  EXPECT_LT(atlas.reduced, 12U * 8) << "no more than is needed";
  EXPECT_EQ(atlas.pieces.back().level, 0U) << "the smallest stays";
  expect_gutters(atlas, materials);
}

TEST(LeafAtlas, AColourAloneTakesOnePieceAMaterial) {
  Leaf leaf;
  for (int i = 0; i < 50; ++i)
    leaf.triangle(Vec2f{float(i), 0}, {float(i) + 0.5f, 1}, {float(i), 1},
                  static_cast<std::uint32_t>(i % 3));
  const std::vector<AtlasMaterial> materials = {{}, picture(64, 64), {}};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  const auto pieces_of = [&](std::uint32_t material) {
    return std::ranges::count(atlas.pieces, material, &AtlasPiece::material);
  };
  EXPECT_EQ(pieces_of(0), 1);
  EXPECT_EQ(pieces_of(2), 1);
  EXPECT_EQ(atlas.reduced, 0U);
  expect_gutters(atlas, materials);
  EXPECT_EQ(atlas.corners[0][0], atlas.corners[3][2]);
}

TEST(LeafAtlas, EqualTrianglesGetEqualCorners) {
  RandomNumbers random(7);
  Leaf leaf;
  for (int i = 0; i < 300; ++i)
    leaf.vertex({float(random.below(1000)) / 1000, float(random.below(1000)) / 1000},
                random.below(2));
  for (int i = 0; i < 300; ++i)
    leaf.triangle(random.below(300), random.below(300), random.below(300));
  leaf.triangles.insert(leaf.triangles.end(), leaf.triangles.begin(), leaf.triangles.end());
  const std::vector<AtlasMaterial> materials = {picture(300, 200), picture(50, 100)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  for (std::size_t t = 0; t < 300; ++t)
    EXPECT_EQ(atlas.corners[t], atlas.corners[t + 300]);
  expect_gutters(atlas, materials);
}

// Pictures of one texel a side, coordinates that are all one, and such as no picture has.
TEST(LeafAtlas, CoordinatesOfAnySizeAreBoundedWork) {
  const std::array<float, 12> values = {0,     -0.0f,  0.5f, 1,     -1e-30f,   1e-40f,
                                        1e30f, -1e30f, 3e7f, -3e7f, kInfinity, -kInfinity};
  RandomNumbers random(3);
  for (int round = 0; round < 20; ++round) {
    Leaf leaf;
    const std::uint32_t count = 2 + random.below(static_cast<std::uint32_t>(values.size()) - 1);
    const auto any = [&] { return values[random.below(count)]; };
    for (int i = 0; i < 200; ++i)
      leaf.vertex({any(), any()}, random.below(3));
    for (int i = 0; i < 400; ++i)
      leaf.triangle(random.below(200), random.below(200), random.below(200));
    const std::vector<AtlasMaterial> materials = {picture(65535, 65535), picture(1, 1),
                                                  picture(1, 4000)};
    const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 2048);
    EXPECT_LE(atlas.width, 2048U);
    EXPECT_LE(atlas.height, 2048U);
    for (const CornerTexcoords& corners : atlas.corners) {
      for (const Vec2f& corner : corners) {
        EXPECT_TRUE(corner.u > 0 && corner.u < 1) << corner.u;
        EXPECT_TRUE(corner.v > 0 && corner.v < 1) << corner.v;
      }
    }
    expect_gutters(atlas, materials);
  }
}

TEST(LeafAtlas, AllCoordinatesAreOne) {
  Leaf leaf;
  for (int i = 0; i < 100; ++i)
    leaf.triangle(Vec2f{0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f});
  const std::vector<AtlasMaterial> materials = {picture(64, 64)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.pieces.size(), 1U);
  expect_gutters(atlas, materials);
  expect_input_texels(leaf, atlas, materials);
}

std::size_t texels_of(const LeafAtlas& atlas) {
  return std::size_t{atlas.width} * atlas.height;
}

TEST(LeafAtlas, APictureThatRepeatsInAChartIsThereOnce) {
  Leaf leaf;
  leaf.grid({-3.3f, 0.1f}, {8.4f, 5.7f}, 96);
  const std::vector<AtlasMaterial> materials = {picture(100, 60)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.reduced, 0U);
  // Triangles have up to an eighth of a picture; 11.7 x 5.6 pictures are 393,000 texels.
  EXPECT_LT(texels_of(atlas), 20000U);
  expect_gutters(atlas, materials);
  expect_input_texels(leaf, atlas, materials);
}

TEST(LeafAtlas, ChartsOfTheSameTexelsShareThem) {
  Leaf leaf;
  for (int i = 0; i < 50; ++i) {
    const auto by = static_cast<float>(i % 7), down = static_cast<float>(i % 3);
    leaf.grid({by + 0.25f, down + 0.125f}, {by + 0.75f, down + 0.5f}, 1 + i % 5);
  }
  const std::vector<AtlasMaterial> materials = {picture(256, 256)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.pieces.size(), 1U);
  EXPECT_LE(texels_of(atlas), (128U + 16) * (96 + 16));
  expect_gutters(atlas, materials);
  expect_input_texels(leaf, atlas, materials);
}

TEST(LeafAtlas, ChartsThatLieApartShareNothing) {
  Leaf leaf;
  leaf.grid({0.1f, 0.1f}, {0.2f, 0.2f}, 2);
  leaf.grid({0.6f, 0.7f}, {0.7f, 0.8f}, 2);
  leaf.grid({0.1f, 0.1f}, {0.2f, 0.2f}, 2, 1);
  const std::vector<AtlasMaterial> materials = {picture(512, 512), picture(512, 512)};
  EXPECT_EQ(plan_leaf_atlas(leaf, materials, 4096).pieces.size(), 3U);
}

TEST(LeafAtlas, MirroredAndClampedPicturesAreSharedWhereTheyAreTheSame) {
  Leaf leaf;
  leaf.grid({0.1f, 0.2f}, {0.4f, 0.6f}, 3);
  leaf.grid({1.1f, 0.2f}, {1.4f, 0.6f}, 3);    // mirrored
  leaf.grid({-1.9f, 0.2f}, {-1.6f, 0.6f}, 3);  // two periods of one: the same
  leaf.grid({0.1f, 5.2f}, {0.4f, 5.6f}, 3);    // the last row again and again
  AtlasMaterial mirrored = picture(200, 100);
  mirrored.wrap_u = Wrap::mirrored;
  mirrored.wrap_v = Wrap::clamp;
  const std::vector<AtlasMaterial> materials = {mirrored};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.pieces.size(), 3U);
  expect_gutters(atlas, materials);
  expect_input_texels(leaf, atlas, materials);
}

TEST(LeafAtlas, WhatIsSharedHasNoLimitOfCharts) {
  RandomNumbers random(5);
  Leaf leaf;
  for (int i = 0; i < 20000; ++i) {
    const Vec2f at{float(random.below(1 << 20)) / 4096, float(random.below(1 << 20)) / 4096};
    leaf.triangle(at, {at.u + 0.11f, at.v}, {at.u, at.v + 0.07f});
  }
  const std::vector<AtlasMaterial> materials = {picture(1024, 1024)};
  const LeafAtlas atlas = plan_leaf_atlas(leaf, materials, 4096);
  EXPECT_EQ(atlas.charts, 20000U);
  // Apart they would have 20,000 * 120 * 80 = 192 M texels.
  EXPECT_LT(texels_of(atlas), 5'000'000U);
  EXPECT_EQ(atlas.reduced, 0U);
  expect_gutters(atlas, materials);
}

TEST(LeafAtlas, IsTheSameEachTime) {
  RandomNumbers random(11);
  Leaf leaf;
  for (int i = 0; i < 500; ++i) {
    const Vec2f at{float(random.below(4096)) / 4096, float(random.below(4096)) / 4096};
    leaf.triangle(at, {at.u + 0.02f, at.v}, {at.u, at.v + 0.03f}, random.below(2));
  }
  const std::vector<AtlasMaterial> materials = {picture(1024, 1024), picture(700, 900)};
  const LeafAtlas a = plan_leaf_atlas(leaf, materials, 1024);
  const LeafAtlas b = plan_leaf_atlas(leaf, materials, 1024);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.width, b.width);
  expect_gutters(a, materials);
}

}  // namespace
}  // namespace meshhier::texture
