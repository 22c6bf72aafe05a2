#include "texture/bake.h"

#include "tests/texture/painted.h"
#include "tests/texture/random_numbers.h"
#include "texture/reduction.h"
#include "texture/shown_texels.h"
#include "texture/texel_light.h"
#include "texture/texel_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

constexpr std::uint32_t kSide = 256;

float light_of(double value) {
  return kLight[static_cast<std::size_t>(std::clamp(value + 0.5, 0.0, 255.0))];
}

Paint plain(Colour colour) {
  return [=](const Vec3d&) { return colour; };
}

TEST(Bake, NothingMakesNothing) {
  const BakedTexture baked = bake({}, {}, {});
  EXPECT_EQ(baked.image.width, 0U);
  EXPECT_TRUE(baked.corners.empty());
}

TEST(Bake, AConstantColourStaysInEachTexel) {
  const Colour colour{201, 77, 3};
  const Painted fine = painted(make_torus(60, 30, 0.02), kSide, plain(colour));
  const Painted coarse = baked(make_torus(40, 20), {&fine}, kSide);
  const auto expect_plain = [&](const images::Image& image) {
    for (std::size_t i = 0; i < image.texels.size(); ++i)
      ASSERT_EQ(image.texels[i], colour[i % 3]) << i / 3;
  };
  expect_plain(coarse.image);
  for (const std::uint32_t factor : {2U, 4U}) {
    const images::Image smaller = reduced(coarse.image, coarse.corners, factor);
    EXPECT_EQ(smaller.width, coarse.image.width / factor);
    expect_plain(smaller);
  }
}

// One of them has triangles that begin in one band and end in another.
TEST(Reduction, BandsMakeThePictureOfTheWhole) {
  for (const Mesh& mesh : {make_torus(60, 30), make_torus(6, 4)}) {
    const Painted fine = painted(mesh, kSide, checker(0.3, 0.12));
    const images::Image& image = fine.image;
    for (const std::uint32_t factor : {2U, 4U}) {
      Reduction bands(image.width, image.height, image.channels, fine.corners, factor);
      for (std::uint32_t top = 0; top < image.height; top += factor) {
        images::Image band(image.width, factor, image.channels);
        std::copy_n(image.at(0, top), band.texels.size(), band.texels.begin());
        bands.add(band);
      }
      EXPECT_EQ(std::move(bands)(), reduced(image, fine.corners, factor));
    }
  }
}

TEST(Reduction, ShownTexelsAreThoseOfTheTriangles) {
  const std::array<CornerTexcoords, 3> corners = {
      {{{{0.1f, 0.05f}, {0.9f, 0.5f}, {0.2f, 0.95f}}},
       {{{0.8f, 0.8f}, {0.9f, 0.8f}, {0.8f, 0.81f}}},
       {{{0.95f, 0.9f}, {0.95f, 0.9f}, {0.95f, 0.9f}}}}};
  constexpr std::uint32_t kWidth = 2048, kHeight = 1536;
  const TexelBits shown = shown_texels(kWidth, kHeight, corners);
  std::size_t count = 0;
  for (const CornerTexcoords& triangle : corners) {
    RasterTriangle(in_texels(triangle, kWidth, kHeight))
        .for_each(kWidth, kHeight, [&](std::uint32_t x, std::uint32_t y, double, double) {
          ASSERT_TRUE(shown(x, y)) << x << ", " << y;
          ++count;
        });
  }
  std::size_t all = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x)
      all += shown(x, y) ? 1 : 0;
  }
  EXPECT_EQ(all, count + 1);  // that of the triangle without an area
}

/// Edges are six texels of the coarsest picture wide: what it can show.
void expect_sharp(const Mesh& fine, const Mesh& middle, const Mesh& coarse) {
  const Paint paint = checker(0.3, 0.12);
  const Painted first = painted(fine, 2 * kSide, paint);
  const Painted second = baked(middle, {&first}, kSide * 3 / 2);
  const Painted third = baked(coarse, {&second}, kSide);
  EXPECT_GE(psnr(second, paint), 43);
  EXPECT_GE(psnr(third, paint), 41);
}

TEST(Bake, SLOW_ACheckerOnATorusStaysSharpOverTwoLevels) {
  expect_sharp(make_torus(160, 80), make_torus(113, 57), make_torus(80, 40));
}
TEST(Bake, SLOW_ACheckerOnASphereStaysSharpOverTwoLevels) {
  expect_sharp(make_sphere(160, 80), make_sphere(113, 57), make_sphere(80, 40));
}
TEST(Bake, SLOW_ACheckerOnANoisySurfaceStaysSharpOverTwoLevels) {
  expect_sharp(make_torus(160, 80, 0.01), make_torus(113, 57, 0.01), make_torus(80, 40, 0.01));
}

/// Both meshes as one.
Mesh together(const Mesh& a, const Mesh& b) {
  Mesh both = a;
  both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  for (const TileTriangle& t : b.triangles)
    both.triangles.push_back({TileVertex{raw(t[0]) + first}, TileVertex{raw(t[1]) + first},
                              TileVertex{raw(t[2]) + first}});
  return both;
}

Mesh moved(Mesh mesh, Vec3f by, float scale = 1) {
  for (Vec3f& p : mesh.positions)
    p = p * scale + by;
  return mesh;
}

/// A square in the plane of x and y, looking up or down.
Mesh square(std::uint32_t side, bool up = true) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= side; ++y) {
    for (std::uint32_t x = 0; x <= side; ++x)
      mesh.positions.push_back({float(x) / float(side), float(y) / float(side), 0});
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({TileVertex{a}, TileVertex{up ? b : c}, TileVertex{up ? c : b}});
  };
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t at = y * (side + 1) + x;
      add(at, at + 1, at + side + 2);
      add(at, at + side + 2, at + side + 1);
    }
  }
  return mesh;
}

/// Returns the colour that a picture of such a square, ten squares a side, shows at a point of it.
Colour shown_at(const Painted& square, double x, double y) {
  const double column = std::floor(x * 10), row = std::floor(y * 10);
  const double right = x * 10 - column, down = y * 10 - row;
  const auto first = 2 * (static_cast<std::size_t>(row) * 10 + static_cast<std::size_t>(column));
  return right >= down ? shown(square, first, right - down, down)
                       : shown(square, first + 1, right, down - right);
}

/// Random triangles that are not connected.
Mesh soup(std::uint32_t count, double size, std::uint32_t seed) {
  Mesh mesh;
  RandomNumbers random(seed);
  const auto any = [&](double most) { return static_cast<float>(most * (random.part() - 0.5)); };
  for (std::uint32_t t = 0; t < count; ++t) {
    const Vec3f at{any(1), any(1), any(1)};
    for (int k = 0; k < 3; ++k)
      mesh.positions.push_back(at + Vec3f{any(size), any(size), any(size)});
    mesh.triangles.push_back({TileVertex{3 * t}, TileVertex{3 * t + 1}, TileVertex{3 * t + 2}});
  }
  return mesh;
}

void expect_sound(const BakedTexture& baked, std::size_t triangles, std::uint32_t side) {
  EXPECT_EQ(baked.corners.size(), triangles);
  EXPECT_GT(baked.image.width, 0U);
  EXPECT_GT(baked.image.height, 0U);
  EXPECT_LE(baked.image.width, side);
  EXPECT_LE(baked.image.height, side);
  EXPECT_EQ(baked.image.width % kBakeAlignment, 0U);
  EXPECT_EQ(baked.image.height % kBakeAlignment, 0U);
  EXPECT_GT(baked.charts, 0U);
  for (const CornerTexcoords& corners : baked.corners) {
    for (const Vec2f& at : corners) {
      // Far enough from the picture's border for a filter.
      EXPECT_GE(at.u * float(baked.image.width), 1.99f);
      EXPECT_GE(at.v * float(baked.image.height), 1.99f);
      EXPECT_LE(at.u * float(baked.image.width), float(baked.image.width) - 1.99f);
      EXPECT_LE(at.v * float(baked.image.height), float(baked.image.height) - 1.99f);
    }
  }
}

void expect_colour(const Painted& of, std::size_t begin, std::size_t end, const Colour& colour) {
  for (std::size_t t = begin; t < end; ++t) {
    for (const auto& [b, c] :
         {std::array{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {0.5, 0.5}, {0.3, 0.3}})
      ASSERT_EQ(shown(of, t, b, c), colour) << t;
  }
}

// Bits of two colours lie side by side in one picture, however small they are.
TEST(Bake, ChartsDoNotMixInThePictureNorInItsHalfAndQuarter) {
  const Mesh red = soup(300, 0.1, 1), blue = moved(soup(300, 0.1, 2), {10, 0, 0});
  const Mesh both = together(red, blue);
  const Colour colours[] = {{230, 20, 10}, {10, 30, 240}};
  const Painted fine =
      painted(both, kSide, [&](const Vec3d& p) { return p.x < 5 ? colours[0] : colours[1]; });
  Painted coarse = baked(both, {&fine}, kSide);
  for (const std::uint32_t factor : {1U, 2U, 4U}) {
    if (factor > 1)
      coarse.image = reduced(coarse.image, coarse.corners, 2);
    expect_colour(coarse, 0, 300, colours[0]);
    expect_colour(coarse, 300, 600, colours[1]);
  }
}

TEST(Bake, SidesOfAThinWallKeepTheirColours) {
  const auto wall = [](std::uint32_t side) {
    return together(square(side), moved(square(side, false), {0, 0, -0.001f}));
  };
  const Mesh fine = wall(20), coarse = wall(14);
  const Colour front{200, 0, 0}, back{0, 0, 200};
  const Painted first =
      painted(fine, kSide, [&](const Vec3d& p) { return p.z > -0.0005 ? front : back; });
  // The coarser wall is inside out by a bit: what is nearest faces the other way.
  Mesh thinner = coarse;
  for (Vec3f& p : thinner.positions)
    p.z = p.z == 0 ? -0.0008f : -0.0002f;
  const Painted second = baked(thinner, {&first}, kSide);
  const std::size_t half = thinner.triangles.size() / 2;
  expect_colour(second, 0, half, front);
  expect_colour(second, half, 2 * half, back);
}

TEST(Bake, WithoutASurfaceThatFacesAlikeTheNearestCounts) {
  const Colour colour{9, 99, 199};
  const Painted first = painted(square(4, false), 64, plain(colour));
  const Painted second = baked(square(3), {&first}, 64);
  expect_colour(second, 0, second.mesh.triangles.size(), colour);
}

TEST(Bake, OfEquallyNearSurfacesTheFirstCounts) {
  const Painted red = painted(square(4), 64, plain({200, 0, 0}));
  const Painted blue = painted(square(4), 64, plain({0, 0, 200}));
  const Painted second = baked(square(3), {&blue, &red}, 64);
  expect_colour(second, 0, second.mesh.triangles.size(), {0, 0, 200});
}

// Two tiles that have the triangles in the middle both, as border triangles are.
TEST(Bake, SLOW_NeighboursShowTheSameOnTrianglesTheyShare) {
  const Paint paint = checker(0.3, 0.12);
  const Painted fine = painted(make_torus(160, 80), 2 * kSide, paint);
  const Mesh coarse = make_torus(113, 57);
  Mesh left = coarse, right = coarse;
  const std::size_t third = coarse.triangles.size() / 3;
  left.triangles.resize(2 * third);
  right.triangles.erase(right.triangles.begin(), right.triangles.begin() + std::ptrdiff_t(third));
  const Painted a = baked(left, {&fine}, kSide), b = baked(right, {&fine}, kSide);
  double sum = 0, most = 0;
  for (std::size_t t = third; t < 2 * third; ++t) {
    const Colour one = shown(a, t, 0.3, 0.3), other = shown(b, t - third, 0.3, 0.3);
    for (std::size_t k = 0; k < 3; ++k) {
      sum += std::abs(one[k] - other[k]);
      most = std::max(most, std::abs(one[k] - other[k]));
    }
  }
  EXPECT_LT(sum / double(3 * third), 0.7);
  EXPECT_LT(most, 20);
}

// Left and right of a chart's border a surface looks alike.
TEST(Bake, SLOW_BordersOfChartsAreNotSeen) {
  const Painted fine = painted(make_torus(160, 80), 2 * kSide, checker(0.3, 0.12));
  const Painted coarse = baked(make_torus(113, 57), {&fine}, kSide);
  double sum = 0;
  std::size_t count = 0;
  const auto& triangles = coarse.mesh.triangles;
  for (std::size_t t = 0; t + 1 < triangles.size(); t += 2) {  // two of a square
    const Colour one = shown(coarse, t, 0, 0.5), other = shown(coarse, t + 1, 0.5, 0);
    if (coarse.corners[t][2] == coarse.corners[t + 1][1])
      continue;
    for (std::size_t k = 0; k < 3; ++k)
      sum += std::abs(one[k] - other[k]);
    count += 3;
  }
  ASSERT_GT(count, 100U);
  EXPECT_LT(sum / double(count), 1.7);  // in steps of 0 to 255
}

/// Returns the mean square difference from a painted square, in decibels, for pixels as large as
/// what a bake has lost, by the same measure as at a level's error.
double pixels_psnr(const Painted& of, const Paint& paint, double pixel) {
  constexpr int kSamples = 8;
  double squares = 0, count = 0;
  for (double top = 0.1; top + pixel < 0.9; top += pixel) {
    for (double left = 0.1; left + pixel < 0.9; left += pixel) {
      std::array<float, 3> is{}, should{};
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const double x = left + pixel * (i % kSamples + 0.5) / kSamples;
        const double y = top + pixel * (i / kSamples + 0.5) / kSamples;
        const Colour a = shown_at(of, x, y), b = paint({x, y, 0});
        for (std::size_t k = 0; k < 3; ++k) {
          is[k] += light_of(a[k]) / (kSamples * kSamples);
          should[k] += light_of(b[k]) / (kSamples * kSamples);
        }
      }
      for (std::size_t k = 0; k < 3; ++k)
        squares += std::pow(value_of_light(is[k]) - value_of_light(should[k]), 2);
      count += 3;
    }
  }
  return 10 * std::log10(255 * 255 / (squares / count));
}

/// A square checker of full contrast.
Paint flat_checker(double side, double blur) {
  return [paint = checker(side, blur), side](const Vec3d& p) {
    return paint({p.x, p.y, side - 0.017});
  };
}

TEST(Bake, SLOW_TellsTheSizeOfPixelsThatHardlyDiffer) {
  for (const double side : {0.035, 0.039, 0.043}) {
    const Paint paint = flat_checker(side, side / 3);
    const Painted fine = painted(square(20), 512, paint);
    const Painted coarse = baked(square(10), {&fine}, 64);
    EXPECT_GT(coarse.lost, coarse.texel) << side;
    EXPECT_NEAR(pixels_psnr(coarse, paint, coarse.lost), 32, 6) << side;  // a pixel's double
  }
}

TEST(Bake, LittleIsLostWhereThereIsLittleToSee) {
  const Painted fine = painted(square(20), 512, checker(0.4, 0.4));
  const Painted coarse = baked(square(10), {&fine}, 64);
  EXPECT_LT(coarse.lost, coarse.texel / 2);
  EXPECT_EQ(baked(square(10), {}, 64).lost, 0);
}

TEST(Bake, NoTexelIsSmallerThanWasAskedFor) {
  const Painted fine = painted(square(10), 128, plain({1, 2, 3}));
  const Painted coarse = baked(square(7), {&fine}, 512, 2 * fine.texel);
  EXPECT_FLOAT_EQ(coarse.texel, 2 * fine.texel);
  EXPECT_LE(coarse.image.width, 128U);
  EXPECT_LE(coarse.image.height, 128U);
  EXPECT_NEAR(texel_size(coarse.surface(), coarse.image.width, coarse.image.height), coarse.texel,
              0.01 * coarse.texel);
}

TEST(Bake, WhatIsClearLendsNoColour) {
  Painted fine = painted(square(8), 128, plain({0, 0, 0}));
  images::Image image(fine.image.width, fine.image.height, 4);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const bool clear = (x / 2 + y / 2) % 2 == 0;
      const std::uint8_t texel[] = {200, 100, 50, 255}, none[] = {0, 255, 0, 0};
      std::copy_n(clear ? none : texel, 4, image.at(x, y));
    }
  }
  fine.image = image;
  const Painted coarse = baked(square(5), {&fine}, 64);
  ASSERT_EQ(coarse.image.channels, 4U);
  for (std::uint32_t y = 0; y < coarse.image.height; ++y) {
    for (std::uint32_t x = 0; x < coarse.image.width; ++x) {
      const std::uint8_t* texel = coarse.image.at(x, y);
      if (texel[3] < 16)
        continue;  // too little is left to tell
      EXPECT_NEAR(texel[0], 200, 1);
      EXPECT_NEAR(texel[1], 100, 1);
      EXPECT_NEAR(texel[2], 50, 1);
    }
  }
}

TEST(Bake, EqualTrianglesGetEqualCorners) {
  Mesh mesh = make_torus(12, 8);
  const std::size_t count = mesh.triangles.size();
  mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  const BakedTexture baked = bake({mesh.positions, mesh.triangles, {}, nullptr}, {}, {64, 0});
  expect_sound(baked, 2 * count, 64);
  for (std::size_t t = 0; t < count; ++t)
    EXPECT_EQ(baked.corners[t], baked.corners[t + count]);
}

TEST(Bake, MoreChartsThanPlacesStillGetTexels) {
  const Mesh mesh = soup(3000, 0.05, 3);
  const Colour colour{40, 50, 60};
  const Painted fine = painted(mesh, 512, plain(colour));
  const Painted coarse = baked(mesh, {&fine}, 64);
  EXPECT_LE(coarse.image.width, 64U);
  EXPECT_LE(coarse.image.height, 64U);
  expect_colour(coarse, 0, mesh.triangles.size(), colour);
}

TEST(Bake, IsTheSameEachTime) {
  const Painted fine = painted(make_torus(60, 30, 0.05), kSide, checker(0.3, 0.12));
  const Painted a = baked(make_torus(40, 20, 0.05), {&fine}, kSide);
  const Painted b = baked(make_torus(40, 20, 0.05), {&fine}, kSide);
  EXPECT_EQ(a.image, b.image);
  EXPECT_EQ(a.corners, b.corners);
}

/// A helix, all of whose steps lie above each other.
Mesh stairs() {
  Mesh stairs;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const double turn = i * 0.3;
    stairs.positions.push_back(to_float(Vec3d{0, 0, i * 1e-4}));
    stairs.positions.push_back(to_float(Vec3d{std::cos(turn), std::sin(turn), i * 1e-4}));
    if (i > 0) {
      const std::uint32_t at = 2 * i - 2;
      stairs.triangles.push_back({TileVertex{at}, TileVertex{at + 1}, TileVertex{at + 3}});
      stairs.triangles.push_back({TileVertex{at}, TileVertex{at + 3}, TileVertex{at + 2}});
    }
  }
  return stairs;
}

/// Meshes that have nothing of a surface, at any scale.
std::vector<Mesh> odd_meshes() {
  std::vector<Mesh> meshes;
  Mesh needles;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto at = float(i);
    needles.positions.insert(needles.positions.end(),
                             {{at * 1e-6f, 0, 0}, {1, 1 + at * 1e-6f, 0}, {1, 1, at * 1e-6f}});
    needles.triangles.push_back({TileVertex{3 * i}, TileVertex{3 * i + 1}, TileVertex{3 * i + 2}});
  }
  meshes.push_back(needles);
  Mesh fan;  // all triangles at one edge
  fan.positions = {{0, 0, 0}, {1, 0, 0}};
  for (std::uint32_t i = 0; i < 1000; ++i) {
    fan.positions.push_back({0.5f, std::cos(float(i)), std::sin(float(i))});
    fan.triangles.push_back({TileVertex{0}, TileVertex{1}, TileVertex{i + 2}});
  }
  meshes.push_back(fan);
  Mesh point = square(4);
  for (Vec3f& p : point.positions)
    p = {1, 2, 3};
  meshes.push_back(point);
  Mesh line = square(4);
  for (Vec3f& p : line.positions)
    p = {p.x, p.x, p.x};
  meshes.push_back(line);
  Mesh twice = square(4);
  twice.triangles.push_back({TileVertex{0}, TileVertex{0}, TileVertex{1}});
  meshes.push_back(twice);
  for (const float scale : {1e30f, 1e-30f, 1e-38f})
    meshes.push_back(moved(make_torus(12, 8), {}, scale));
  meshes.push_back(moved(make_torus(12, 8), {1e6f, -1e6f, 3e6f}));
  meshes.push_back(stairs());
  meshes.push_back(soup(500, 1, 9));
  return meshes;
}

/// Texels whose middles are in several triangles, of 1.
double covered_twice(const BakedTexture& baked) {
  std::vector<int> covered(std::size_t{baked.image.width} * baked.image.height);
  for (const CornerTexcoords& corners : baked.corners) {
    std::array<TexelPoint, 3> at;
    for (std::size_t k = 0; k < 3; ++k)
      at[k] = {double(corners[k].u) * baked.image.width, double(corners[k].v) * baked.image.height};
    RasterTriangle(at).for_each(baked.image.width, baked.image.height,
                                [&](std::uint32_t x, std::uint32_t y, double, double) {
                                  ++covered[std::size_t{y} * baked.image.width + x];
                                });
  }
  const auto twice = std::ranges::count_if(covered, [](int count) { return count > 1; });
  return double(twice) / double(covered.size());
}

// Floats move a corner by a part of a texel's 4,000th: a middle may fall on another side.
TEST(Bake, TrianglesDoNotCoverEachOther) {
  for (const Mesh& mesh : {make_torus(60, 30, 0.3), stairs(), make_sphere(30, 15)}) {
    const BakedTexture baked = bake({mesh.positions, mesh.triangles, {}, nullptr}, {}, {kSide, 0});
    EXPECT_LT(covered_twice(baked), 0.002);
  }
}

TEST(Bake, OddMeshesAreSound) {
  const Colour colour{12, 34, 56};
  int number = 0;
  for (const Mesh& mesh : odd_meshes()) {
    SCOPED_TRACE(number++);
    const Painted fine = painted(mesh, 128, plain(colour));
    for (const std::uint32_t side : {64U, 256U}) {
      const TexturedSurface finer[] = {fine.surface()};
      const BakedTexture baked =
          bake({mesh.positions, mesh.triangles, {}, nullptr}, finer, {side, 0});
      expect_sound(baked, mesh.triangles.size(), side);
      EXPECT_EQ(bake({mesh.positions, mesh.triangles, {}, nullptr}, {}, {side, 0}).corners,
                baked.corners);
    }
  }
}

TEST(Bake, FinerSurfacesMayHaveAnyCoordinates) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::array<float, 6> values = {0, 0.5f, 1e30f, -1e30f, kInfinity, -kInfinity};
  RandomNumbers random(4);
  Painted fine = painted(make_torus(20, 10), 64, plain({1, 2, 3}));
  for (CornerTexcoords& corners : fine.corners) {
    for (Vec2f& at : corners)
      at = {values[random.below(6)], values[random.below(6)]};
  }
  const Painted coarse = baked(make_torus(12, 8), {&fine}, 64);
  EXPECT_GT(coarse.image.width, 0U);
  EXPECT_EQ(reduced(fine.image, fine.corners, 2).width, fine.image.width / 2);
}

// As boxes have it whose every side shows all of a picture.
TEST(Bake, SLOW_ReducingIsQuickHoweverOftenATexelIsShown) {
  const std::vector<CornerTexcoords> corners(20000, {Vec2f{0, 0}, {1, 0}, {0, 1}});
  const images::Image image(1024, 1024, 3);
  EXPECT_EQ(reduced(image, corners, 4).width, 256U);
}

TEST(Bake, ReducingTakesWhatIsShownAlone) {
  images::Image image(16, 16, 3);
  for (std::uint32_t i = 0; i < 256; ++i)
    image.texels[3 * i] = i % 16 < 6 ? 200 : 0;  // black from the seventh column on
  const std::vector<CornerTexcoords> corners = {{Vec2f{0, 0}, {6 / 16.0f, 0}, {0, 1}},
                                                {Vec2f{6 / 16.0f, 0}, {6 / 16.0f, 1}, {0, 1}}};
  const images::Image smaller = reduced(image, corners, 4);
  for (std::size_t i = 0; i < smaller.texels.size(); i += 3)
    EXPECT_EQ(smaller.texels[i], 200) << i / 3;
}

}  // namespace
}  // namespace meshhier::texture
