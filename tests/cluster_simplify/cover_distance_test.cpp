#include "cluster_simplify/cover_distance.h"

#include "tests/cluster_simplify/sampling.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::Corners;

constexpr int kCoverDistanceSteps = 24;
constexpr double kCoverDistanceSlack = 1e-12;  // rounding of sums in double precision near one

/// The header's promise where pieces suffice.
constexpr double kTight = 1.25;

Vec3d random_point(std::uint64_t index, std::uint64_t stream = 1) {
  return {tests::hash_noise(index, stream), tests::hash_noise(index, stream + 1),
          tests::hash_noise(index, stream + 2)};
}

/// Triangles that may cover one, and what counts in addition.
struct Scene {
  Corners triangle;
  std::vector<Corners> surface;
  std::vector<double> extras;

  std::vector<Cover> covers() const {
    std::vector<Cover> result;
    for (std::size_t i = 0; i < surface.size(); ++i)
      result.push_back({{surface[i][0], surface[i][1], surface[i][2]}, extras[i]});
    return result;
  }
  double distance(Vec3d p, std::size_t cover) const {
    return tests::distance_to_triangle(p, surface[cover]) + extras[cover];
  }
  double distance(Vec3d p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < surface.size(); ++i)
      least = std::min(least, distance(p, i));
    return least;
  }
  double sampled() const {
    double most = 0;
    for (const Vec3d p : tests::samples_of(triangle, kCoverDistanceSteps))
      most = std::max(most, distance(p));
    return most;
  }
};

/// Any triangles, up to six covers, some without area.
Scene wild_scene(std::uint64_t seed) {
  const auto corner = [&](std::uint64_t i) { return random_point(seed * 32 + i); };
  Scene scene{{corner(0), corner(1), corner(2)}, {}, {}};
  for (std::uint64_t i = 0; i < 1 + seed % 6; ++i) {
    Corners cover{corner(3 * i + 3), corner(3 * i + 4), corner(3 * i + 5)};
    if ((seed + i) % 7 == 0)
      cover[2] = cover[0];
    if ((seed + i) % 11 == 0)
      cover[1] = cover[2] = cover[0];
    scene.surface.push_back(cover);
    scene.extras.push_back(seed % 3 == 0 ? 0 : 0.1 + 0.1 * random_point(seed * 32 + i, 7).x);
  }
  return scene;
}

/// A triangle over a fan around a point near its middle, whose corners are up to `height` away.
Scene fan_scene(std::uint64_t seed, double height) {
  Scene scene{{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, {}, {0, 0, 0}};
  const auto lifted = [&](Vec3d p, std::uint64_t i) {
    return p + Vec3d{0, 0, height * random_point(seed * 4 + i, 11).x};
  };
  const Vec3d middle = lifted({1.2 + 0.3 * random_point(seed, 17).x, 1.3, 0}, 3);
  std::array<Vec3d, 3> boundary;
  for (std::size_t k = 0; k < 3; ++k)
    boundary[k] = lifted(scene.triangle[k], k);
  for (std::size_t k = 0; k < 3; ++k)
    scene.surface.push_back({middle, boundary[k], boundary[(k + 1) % 3]});
  return scene;
}

TEST(CoverDistanceTest, NoSampleIsFartherThanTheBound) {
  CoverDistance distance;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Scene scene = wild_scene(seed);
    const double bound = distance(scene.triangle, scene.covers(), 0);
    ASSERT_GE(bound * (1 + kCoverDistanceSlack), scene.sampled()) << seed;
    ASSERT_LE(bound, 2 * std::sqrt(12.0) + 0.2);  // the farthest that points of the scene can be
  }
}

TEST(CoverDistanceTest, EveryPointIsAsNearToACoverAsItsLandingSays) {
  CoverDistance distance;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Scene scene = wild_scene(seed);
    const double bound = distance(scene.triangle, scene.covers(), 0);
    const std::span<const double> landings = distance.landings();
    ASSERT_EQ(landings.size(), scene.surface.size());
    ASSERT_LE(*std::ranges::max_element(landings), bound);
    for (const Vec3d p : tests::samples_of(scene.triangle, kCoverDistanceSteps)) {
      bool landed = false;
      for (std::size_t i = 0; i < landings.size(); ++i)
        landed = landed || scene.distance(p, i) <= landings[i] * (1 + kCoverDistanceSlack);
      ASSERT_TRUE(landed) << seed;
    }
  }
}

TEST(CoverDistanceTest, IsTightOverAFan) {
  CoverDistance distance;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Scene scene = fan_scene(seed, 0.3);
    const double bound = distance(scene.triangle, scene.covers(), 0);
    const double sampled = scene.sampled();
    ASSERT_GE(bound * (1 + kCoverDistanceSlack), sampled) << seed;
    ASSERT_LE(bound, kTight * sampled * 1.02) << seed;  // the samples miss a little
  }
}

TEST(CoverDistanceTest, OfOneCoverItIsThatOfTheFarthestCorner) {
  CoverDistance distance;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Scene scene = wild_scene(6 * seed);
    ASSERT_EQ(scene.surface.size(), 1U);
    double farthest = 0;
    for (const Vec3d corner : scene.triangle)
      farthest = std::max(farthest, scene.distance(corner));
    ASSERT_NEAR(distance(scene.triangle, scene.covers(), 0), farthest,
                1e-11);  // its own rounding counted
  }
}

TEST(CoverDistanceTest, WithoutCoversNothingIsNear) {
  CoverDistance distance;
  EXPECT_EQ(distance({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {}, 100),
            std::numeric_limits<double>::infinity());
  distance.begin({}, std::array<Vec3d, 3>{});
  EXPECT_EQ(distance.triangle({0, 1, 2}, 0), std::numeric_limits<double>::infinity());
}

TEST(CoverDistanceTest, BelowEnoughItMayBeLooseButNeverWrong) {
  CoverDistance distance;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Scene scene = fan_scene(seed, 0.3);
    const double sampled = scene.sampled();
    for (const double part : {0.5, 0.9, 1.5, 4.0}) {
      const double enough = part * sampled;
      const double bound = distance(scene.triangle, scene.covers(), enough);
      ASSERT_GE(bound * (1 + kCoverDistanceSlack), sampled) << seed;
      ASSERT_LE(bound, std::max(enough, kTight * sampled * 1.02) * (1 + kCoverDistanceSlack))
          << seed;
    }
  }
}

TEST(CoverDistanceTest, TrianglesOfCommonPointsAreLikeSingleOnes) {
  CoverDistance one_by_one;
  CoverDistance together;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Scene scene = wild_scene(seed);
    const std::vector<Cover> covers = scene.covers();
    std::vector<Vec3d> points;
    for (std::uint64_t i = 0; i < 6; ++i)
      points.push_back(random_point(seed * 8 + i, 21));
    together.begin(covers, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_NEAR(together.nearest(i), scene.distance(points[i]), kCoverDistanceSlack);
    for (std::size_t i = 0; i + 2 < points.size(); ++i) {
      const Corners triangle{points[i], points[i + 1], points[i + 2]};
      ASSERT_EQ(together.triangle({i, i + 1, i + 2}, 0), one_by_one(triangle, covers, 0));
      ASSERT_TRUE(std::ranges::equal(together.landings(), one_by_one.landings()));
    }
  }
}

TEST(CoverDistanceTest, OneCoverIsNearIfAllCornersAre) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Scene scene = wild_scene(seed);
    const std::vector<Cover> covers = scene.covers();
    for (std::size_t i = 0; i < covers.size(); ++i) {
      double farthest = 0;
      for (const Vec3d corner : scene.triangle)
        farthest = std::max(farthest, scene.distance(corner, i));
      ASSERT_NEAR(CoverDistance::near_one(scene.triangle, covers[i], farthest * 1.001), farthest,
                  1e-11);
      ASSERT_LT(CoverDistance::near_one(scene.triangle, covers[i], farthest * 0.999), 0);
    }
  }
}

TEST(CoverDistanceTest, TrianglesWithoutAreaAreServed) {
  CoverDistance distance;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Scene scene = wild_scene(seed);
    scene.triangle[2] =
        seed % 2 == 0 ? scene.triangle[1] : (scene.triangle[0] + scene.triangle[1]) * 0.5;
    if (seed % 5 == 0)
      scene.triangle[0] = scene.triangle[1] = scene.triangle[2];
    const double bound = distance(scene.triangle, scene.covers(), 0);
    ASSERT_GE(bound * (1 + kCoverDistanceSlack), scene.sampled()) << seed;
    ASSERT_TRUE(std::isfinite(bound));
  }
}

TEST(CoverDistanceTest, ATriangleOnItsCoversIsNowhere) {
  CoverDistance distance;
  const Scene scene = fan_scene(3, 0);
  EXPECT_EQ(distance(scene.surface[1], scene.covers(), 0), 0);
  EXPECT_LE(distance(scene.triangle, scene.covers(), 0.7), 0.7);
}

}  // namespace
}  // namespace meshhier::cluster_simplify
