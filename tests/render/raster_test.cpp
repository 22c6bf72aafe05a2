#include "render/raster.h"

#include "render/distinct_places.h"
#include "tests/render/drawn.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

constexpr std::uint32_t kSize = 24;

const Sample& sample_at(const Raster& raster, std::size_t column, std::size_t row) {
  return raster.samples()[row * raster.columns() + column];
}

std::size_t covered_count(const Raster& raster) {
  return static_cast<std::size_t>(
      std::ranges::count_if(raster.samples(), [](const Sample& s) { return s.covered(); }));
}

/// How often each sample is covered.
std::vector<int> hits(const Camera& camera, const std::vector<Facet>& facets) {
  std::vector<int> counts(std::size_t{camera.columns()} * camera.rows());
  for (const Facet& facet : facets) {
    const Raster raster = drawn(camera, {facet});
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] += raster.samples()[i].covered() ? 1 : 0;
  }
  return counts;
}

/// A point `way` along the outline of a square around the grid, 0 to 1.
Vec3f on_frame(double way) {
  const double side = kSize + 20.0, along = std::fmod(way * 4, 1.0) * side - 10;
  switch (static_cast<int>(way * 4)) {
    case 0:
      return to_float(Vec3d{along, -10, 0});
    case 1:
      return to_float(Vec3d{side - 10, along, 0});
    case 2:
      return to_float(Vec3d{kSize - along, side - 10, 0});
    default:
      return to_float(Vec3d{-10, kSize - along, 0});
  }
}

/// Covers the whole grid around one point: on the middle or border of a sample, or anywhere.
std::vector<Facet> random_fan(std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(0, 1);
  const double grain = random() % 2 == 0 ? 2 : 256 * 3;
  const auto coordinate = [&] {
    return static_cast<float>(std::floor(any(random) * kSize * grain) / grain);
  };
  const Vec3f middle{coordinate(), coordinate(), 0};
  // The corners of the frame must be there, or the fan would not cover the grid.
  std::vector<double> ways{0, 0.25, 0.5, 0.75};
  for (std::uint64_t more = random() % 12; more > 0; --more)
    ways.push_back(any(random));
  std::ranges::sort(ways);
  std::vector<Facet> fan;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Facet facet =
        flat_facet(middle, on_frame(ways[i]), on_frame(ways[(i + 1) % ways.size()]));
    fan.push_back(random() % 2 == 0 ? facet : mirrored(facet));
  }
  return fan;
}

TEST(RasterTest, AFanCoversEachSampleOnce) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 200; ++round) {
    const std::vector<int> counts = hits(square_camera(kSize), random_fan(random));
    ASSERT_EQ(std::ranges::count(counts, 1), kSize * kSize) << "round " << round;
  }
}

TEST(RasterTest, AGridOfSquaresThroughTheMiddlesOfSamplesCoversEachOnce) {
  std::vector<Facet> facets;
  for (float y = -0.5F; y < kSize; ++y) {
    for (float x = -0.5F; x < kSize; ++x) {
      facets.push_back(flat_facet({x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}));
      facets.push_back(mirrored(flat_facet({x, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0})));
    }
  }
  const std::vector<int> counts = hits(square_camera(kSize), facets);
  EXPECT_EQ(std::ranges::count(counts, 1), kSize * kSize);
}

TEST(RasterTest, SamplesWithinATriangleAreCovered) {
  const Raster raster = drawn(square_camera(4), {flat_facet({0, 0, 0}, {4, 0, 0}, {0, 4, 0})});
  // The middles on its long side belong to what lies to the right.
  EXPECT_EQ(covered_count(raster), 6U);
  EXPECT_TRUE(sample_at(raster, 0, 3).covered());
  EXPECT_TRUE(sample_at(raster, 2, 3).covered());
  EXPECT_FALSE(sample_at(raster, 3, 3).covered());
  EXPECT_FALSE(sample_at(raster, 3, 0).covered());
}

TEST(RasterTest, TheNearestIsSeenInAnyOrder) {
  const auto square = [](float z, float red) {
    Facet facet = flat_facet({-40, -40, z}, {80, -40, z}, {-40, 80, z});
    for (FacetCorner& corner : facet)
      corner.colour = {red, 0, 0};
    return facet;
  };
  std::vector<int> order{0, 1, 2};
  const std::vector<Facet> facets{square(1, 0.25F), square(3, 0.75F), square(2, 0.5F)};
  do {
    Raster raster(square_camera(8));
    for (const int i : order)
      raster.draw(facets[static_cast<std::size_t>(i)]);
    for (const Sample& sample : raster.samples()) {
      ASSERT_NEAR(sample.colour.x, 0.75F, 1e-6F);
      ASSERT_NEAR(sample.depth, -3, 1e-5);
    }
  } while (std::ranges::next_permutation(order).found);
}

TEST(RasterTest, TrianglesThatCrossAreSeenWhereTheyAreNearer) {
  const Facet rising = flat_facet({-80, -40, -80}, {88, -40, 88}, {4, 800, 4});
  const Facet level = flat_facet({-40, -40, 4}, {80, -40, 4}, {-40, 80, 4});
  const Raster raster = drawn(square_camera(8), {rising, level});
  for (std::size_t x = 0; x < 8; ++x) {
    const double slope = static_cast<double>(x) + 0.5;
    const Sample& sample = sample_at(raster, x, 7);
    ASSERT_NEAR(-sample.depth, std::max(slope, 4.0), 1e-2) << x;
  }
}

TEST(RasterTest, OfEquallyNearOnesTheFirstIsSeen) {
  Facet first = flat_facet({-40, -40, 0}, {80, -40, 0}, {-40, 80, 0});
  Facet second = first;
  second[0].colour = second[1].colour = second[2].colour = {0, 1, 0};
  EXPECT_EQ(sample_at(drawn(square_camera(4), {first, second}), 1, 1).colour.x,
            sample_at(drawn(square_camera(4), {first}), 1, 1).colour.x);
}

/// Triangles anywhere in the grid and around it, at any depth.
std::vector<Facet> soup(std::size_t count, std::uint32_t size) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<float> place(-20, static_cast<float>(size) + 20), depth(-90, 0);
  const auto point = [&] { return Vec3f{place(random), place(random), depth(random)}; };
  std::vector<Facet> facets;
  for (std::size_t i = 0; i < count; ++i) {
    facets.push_back(flat_facet(point(), point(), point()));
    for (FacetCorner& corner : facets.back())
      corner.colour = {static_cast<float>(i), 0, 0};
  }
  return facets;
}

TEST(RasterTest, SLOW_WhatIsSkippedIsHidden) {
  constexpr std::uint32_t kSide = 150;
  const std::vector<Facet> facets = soup(3000, kSide);
  const Camera camera = square_camera(kSide);
  const Raster together = drawn(camera, facets);
  std::vector<Sample> nearest(together.samples().size());
  for (const Facet& facet : facets) {
    const Raster alone = drawn(camera, {facet});
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      if (alone.samples()[i].depth < nearest[i].depth)
        nearest[i] = alone.samples()[i];
    }
  }
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    ASSERT_EQ(together.samples()[i].depth, nearest[i].depth);
    ASSERT_EQ(together.samples()[i].colour, nearest[i].colour);
  }
}

std::vector<std::uint32_t> bits_of(const Raster& raster) {
  std::vector<std::uint32_t> bits;
  for (const Sample& sample : raster.samples()) {
    for (const float value : {sample.depth, sample.normal.x, sample.normal.y, sample.normal.z,
                              sample.colour.x, sample.colour.y, sample.colour.z})
      bits.push_back(std::bit_cast<std::uint32_t>(value));
  }
  return bits;
}

TEST(RasterTest, PlacesOnceAndPlacesOfEachFacetGiveTheSameBits) {
  std::vector<Facet> facets = facets_around_origin(tests::torus(700));
  facets.push_back(
      flat_facet({std::numeric_limits<float>::quiet_NaN(), 0, 0}, {1, 0, 0}, {0, 1, 0}));
  facets.push_back(facets[3]);
  facets.push_back(flat_facet({-1e30F, 0, 0}, {1e30F, 0, 0}, {0, 1e30F, 0}));
  const DistinctPlaces distinct = distinct_places(facets);
  ASSERT_EQ(distinct.corners.size(), facets.size());
  EXPECT_LT(distinct.places.size(), facets.size());  // 3 corners each, some 6 facets a place
  const Camera camera = square_camera(64);
  Raster once(camera);
  once.draw(facets, distinct);
  EXPECT_EQ(bits_of(once), bits_of(drawn(camera, facets)));
}

// Random soup of 30,000 triangles took 17 s of CPU time to draw.
TEST(RasterTest, LittleIsLookedAtBehindOthers) {
  constexpr std::uint32_t kSide = 256;
  RunDepths depths(kSide, kSide);
  std::vector<float> samples(std::size_t{kSide} * kSide, std::numeric_limits<float>::infinity());
  std::size_t asked = 0, covered = 0;
  for (int i = 0; i < 1000; ++i) {
    const float depth = static_cast<float>(i % 100);
    const std::array corners{snapped({-300, -300, 0}), snapped({900, -300, 0}),
                             snapped({-300, 900, 0})};
    GridTriangle(corners).visit(
        box_of(corners, kSide, kSide),
        [&](std::int64_t run, std::int64_t row) {
          ++asked;
          return !depths.hides(run, row, depth, [&](std::size_t at) { return samples[at]; });
        },
        [&](std::int64_t column, std::int64_t row, const Weights&) {
          ++covered;
          float& sample = samples[static_cast<std::size_t>(row * kSide + column)];
          sample = std::min(sample, depth);
        });
  }
  const std::size_t runs = kSide / kRunSamples * kSide;
  EXPECT_LE(asked, runs * 1000);
  EXPECT_LE(covered, samples.size() * 20);
  EXPECT_EQ(std::ranges::count(samples, 0.0F), std::ssize(samples));
}

TEST(RasterTest, NormalsAreInterpolated) {
  Facet facet = flat_facet({0, -8, 0}, {8, -8, 0}, {0, 24, 0});
  facet[0].normal = facet[2].normal = {-3, 0, 3};  // any length
  facet[1].normal = {0.5F, 0, 0.5F};
  const Raster raster = drawn(square_camera(8), {facet});
  const Sample& left = sample_at(raster, 0, 7);
  const double weight = 0.5 / 8;
  const double x = -(1 - weight) + weight;
  EXPECT_NEAR(left.normal.x, x / std::sqrt(x * x + 1), 1e-3);
  EXPECT_NEAR(left.normal.y, 0, 1e-6);
  EXPECT_NEAR(length(left.normal), 1, 1e-6);
  EXPECT_GT(sample_at(raster, 4, 7).normal.x, left.normal.x);
}

TEST(RasterTest, WithoutNormalsThereIsTheFacetsOwn) {
  // z = x / 2.
  const Facet facet = flat_facet({0, 0, 0}, {8, 0, 4}, {0, 8, 0});
  for (const Facet& turned : {facet, mirrored(facet)}) {
    const Vec3f normal = sample_at(drawn(square_camera(8), {turned}), 1, 6).normal;
    EXPECT_NEAR(normal.x, -1 / std::sqrt(5.0), 1e-6);
    EXPECT_NEAR(normal.y, 0, 1e-6);
    EXPECT_NEAR(normal.z, 2 / std::sqrt(5.0), 1e-6);
  }
}

TEST(RasterTest, NormalsOfTheFarSideAreTurnedRound) {
  Facet facet = flat_facet({0, 0, 0}, {8, 0, 0}, {0, 8, 0});
  for (FacetCorner& corner : facet)
    corner.normal = {0.6F, 0, 0.8F};
  Facet from_behind = mirrored(facet);  // its outside looks away from the viewer,
  for (FacetCorner& corner : from_behind)
    corner.normal = {-0.6F, 0, -0.8F};  // and so do its normals
  for (const Facet& drawn_facet : {facet, from_behind}) {
    const Vec3f normal = sample_at(drawn(square_camera(8), {drawn_facet}), 1, 6).normal;
    EXPECT_NEAR(normal.x, 0.6, 1e-6);
    EXPECT_NEAR(normal.z, 0.8, 1e-6);
  }
}

TEST(RasterTest, NormalsThatCancelGiveWayToTheFacetsOwn) {
  Facet facet = flat_facet({-40, -40, 0}, {80, -40, 0}, {-40, 80, 0});
  facet[0].normal = {std::numeric_limits<float>::quiet_NaN(), 0, 1};
  facet[1].normal = {0, 0, std::numeric_limits<float>::infinity()};
  const Raster raster = drawn(square_camera(8), {facet});
  for (const Sample& sample : raster.samples())
    ASSERT_EQ(sample.normal, (Vec3f{0, 0, 1}));
}

TEST(RasterTest, FlatAndBrokenFacetsAreNotSeen) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const Vec3f a{1, 1, 0}, b{7, 5, 0};
  const Raster raster =
      drawn(square_camera(8),
            {flat_facet(a, a, a), flat_facet(a, b, a), flat_facet(a, {4, 3, 0}, b),
             flat_facet(a, b, {1, nan, 0}), flat_facet(a, b, {7, 1, nan}),
             flat_facet(a, {infinite, 0, 0}, b), flat_facet({7, 1, 0}, {7, 6, 9}, {7, 6, 1})});
  EXPECT_EQ(covered_count(raster), 0U);
}

TEST(RasterTest, WhatReachesFarBeyondTheGridIsSeenWithin) {
  const float far = std::numeric_limits<float>::max();
  const Raster raster =
      drawn(square_camera(8), {flat_facet({-far, -far, 0}, {far, -far, 0}, {0, far, 0})});
  EXPECT_EQ(covered_count(raster), 64U);
}

TEST(RasterTest, NothingIsNoNumber) {
  const float far = std::numeric_limits<float>::max(), tiny = 1e-42F;
  std::mt19937_64 random(11);
  const auto coordinate = [&] {
    const std::vector<float> strange{0, far, -far, tiny, 8, 4, 3.5F, 1e20F};
    return random() % 3 == 0 ? strange[random() % strange.size()]
                             : static_cast<float>(random() % 800) / 100;
  };
  const auto vector = [&] { return Vec3f{coordinate(), coordinate(), coordinate()}; };
  Raster raster(square_camera(16));
  for (int i = 0; i < 5000; ++i) {
    Facet facet = flat_facet(vector(), vector(), vector());
    for (FacetCorner& corner : facet)
      corner.normal = vector();
    raster.draw(facet);
  }
  EXPECT_GT(covered_count(raster), 0U);
  for (const Sample& s : raster.samples()) {
    ASSERT_FALSE(std::isnan(s.depth));
    ASSERT_TRUE(std::isfinite(s.colour.x));
    if (s.covered()) {
      ASSERT_NEAR(length(s.normal), 1, 1e-5);
    }
  }
}

TEST(RasterTest, AClosedSurfaceHasNoHolesInItsDisc) {
  const Camera camera(View{{1, 2, -3}, {0, 1, 0}}, BoundsD{{-1, -1, -1}, {1, 1, 1}},
                      Framing{.width = 64, .height = 64});
  const Raster raster = drawn(camera, facets_around_origin(tests::sphere(5000)));
  for (std::size_t row = 0; row < raster.rows(); ++row) {
    int changes = 0;
    for (std::size_t column = 1; column < raster.columns(); ++column) {
      changes +=
          sample_at(raster, column, row).covered() != sample_at(raster, column - 1, row).covered()
              ? 1
              : 0;
    }
    ASSERT_LE(changes, 2) << "row " << row;
  }
}

TEST(RasterTest, RowsOfAPictureAreThoseOfTheWhole) {
  const std::vector<Facet> facets = facets_around_origin(tests::soup(500));
  const Camera camera(View{{-1, -2, -3}, {0, 0, 1}}, BoundsD{{-1, -1, -1}, {1, 1, 1}},
                      Framing{.width = 40, .height = 30, .samples = 3});
  const Raster whole = drawn(camera, facets);
  for (const PixelRows rows : {PixelRows{0, 30}, PixelRows{0, 1}, PixelRows{7, 11}}) {
    Raster part(camera, rows);
    part.draw(facets);
    ASSERT_EQ(part.rows(), rows.count * 3);
    for (std::size_t i = 0; i < part.samples().size(); ++i) {
      const Sample &here = part.samples()[i],
                   &there = whole.samples()[i + std::size_t{rows.first} * 3 * whole.columns()];
      ASSERT_EQ(here.depth, there.depth);
      ASSERT_EQ(here.normal, there.normal);
    }
  }
}

}  // namespace
}  // namespace meshhier::render
