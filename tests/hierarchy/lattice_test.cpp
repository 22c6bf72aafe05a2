#include "hierarchy/lattice.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

const std::vector<Bounds> kBoxes = {
    {{0, 0, 0}, {1, 1, 1}},
    {{-0.3F, 5, 0}, {0.7F, 5.001F, 0}},
    {{1e6F, -1e6F, 3}, {1e6F + 10, -1e6F + 8, 4}},
    {{7, 7, 7}, {7, 7, 7}},
    {{0, 0, 0}, {0, 0, 0}},
    {{-1e-30F, 0, 0}, {1e-30F, 1e-38F, 0}},
    {{-0.4e38F, 0, -0.1e38F}, {0.4e38F, 1, 0.6e38F}},
};

std::vector<Vec3f> points_in(const Bounds& box, std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(0, 1);
  const Vec3d min = to_double(box.min), size = to_double(box.max) - to_double(box.min);
  std::vector<Vec3f> points{box.min, box.max};
  while (points.size() < count) {
    points.push_back(to_float({min.x + part(random) * size.x, min.y + part(random) * size.y,
                               min.z + part(random) * size.z}));
  }
  return points;
}

TEST(LatticeTest, HoldsItsBoundsWithinHalfAStep) {
  for (const Bounds& box : kBoxes) {
    for (const int bits : {8, 12, 16, 17, 24}) {
      const Lattice lattice = make_lattice(box, bits);
      ASSERT_TRUE(lattice.is_sound()) << bits;
      for (const Vec3f& p : points_in(box, 200)) {
        const Vec3d way = to_double(lattice.nearest(p)) - to_double(p);
        for (const int axis : {0, 1, 2})
          ASSERT_LE(std::abs(way[axis]), lattice.step / 2) << bits << " bits, " << p[axis];
      }
    }
  }
}

TEST(LatticeTest, PointsAreFloatsThatComeBack) {
  for (const Bounds& box : kBoxes) {
    const Lattice lattice = make_lattice(box, 14);
    for (const Vec3f& p : points_in(box, 200)) {
      const Vec3<std::uint32_t> numbers = lattice.numbers_of(p);
      const Vec3f point = lattice.point(numbers);
      EXPECT_EQ(lattice.numbers_of(point), numbers);
      EXPECT_EQ(lattice.nearest(point), point);
      for (const int axis : {0, 1, 2}) {
        ASSERT_LE(numbers[axis], 16383U);
        // As viewers may add it up, in single precision.
        const float sum = static_cast<float>(lattice.corner[axis]) +
                          static_cast<float>(numbers[axis]) * static_cast<float>(lattice.step);
        EXPECT_EQ(sum, point[axis]);
      }
    }
  }
}

TEST(LatticeTest, TheLargestFloatsStayFinite) {
  const float largest = std::numeric_limits<float>::max();
  const Lattice lattice = make_lattice({{-largest, 0, 0}, {largest, 1, 1}}, 8);
  ASSERT_TRUE(lattice.is_sound());
  for (const float x : {-largest, largest}) {
    const Vec3f point = lattice.nearest({x, 0, 0});
    EXPECT_TRUE(std::isfinite(point.x));
    EXPECT_LE(std::abs(double{point.x} - x), lattice.step);
  }
}

TEST(LatticeTest, IsTheFinestThatHolds) {
  // 255 steps a side: 2/255 fits no finer power of two than 1/64.
  EXPECT_EQ(make_lattice({{0, 0, 0}, {2, 1, 0}}, 8).step, 1.0 / 64);
  EXPECT_EQ(make_lattice({{0, 0, 0}, {255, 1, 0}}, 8).step, 1);
  EXPECT_EQ(make_lattice({{0, 0, 0}, {256, 1, 0}}, 8).step, 2);
  // Far from 0 floats have no finer points.
  EXPECT_EQ(make_lattice({{16777216, 0, 0}, {16777216, 0, 0}}, 24).step, 1);
}

TEST(LatticeTest, WhatLiesOutsideGoesToTheEdge) {
  const Lattice lattice = make_lattice({{0, 0, 0}, {255, 255, 255}}, 8);
  EXPECT_EQ(lattice.nearest({-5, 300, 7.5F}), (Vec3f{0, 255, 8}));
  std::vector<Vec3f> positions{{-3, 300 - 41, 7}, {1, 1, 1.25F}};
  EXPECT_EQ(round_to(lattice, positions), 5);
  EXPECT_EQ(positions, (std::vector<Vec3f>{{0, 255, 7}, {1, 1, 1}}));
}

TEST(LatticeTest, UnsoundOnesAreTold) {
  const Lattice good = make_lattice({{-1, 0, 0}, {1, 1, 1}}, 16);
  const auto with = [&](auto change) {
    Lattice lattice = good;
    change(lattice);
    return lattice.is_sound();
  };
  EXPECT_TRUE(with([](Lattice&) {}));
  EXPECT_FALSE(with([](Lattice& l) { l.bits = 7; }));
  EXPECT_FALSE(with([](Lattice& l) { l.bits = 25; }));
  EXPECT_FALSE(with([](Lattice& l) { l.step = 0; }));
  EXPECT_FALSE(with([](Lattice& l) { l.step = -l.step; }));
  EXPECT_FALSE(with([](Lattice& l) { l.step *= 1.5; }));
  EXPECT_FALSE(with([](Lattice& l) { l.step = 1e-40; }));
  EXPECT_FALSE(with([](Lattice& l) { l.step = std::numeric_limits<double>::infinity(); }));
  EXPECT_FALSE(with([](Lattice& l) { l.corner.y += l.step / 2; }));
  EXPECT_FALSE(with([](Lattice& l) { l.corner.z = l.step * 16777216; }));
  EXPECT_FALSE(with([](Lattice& l) { l.corner.z = l.step * -16777217; }));
}

TEST(LatticeTest, FloatAboveIsTheLeastThatIsNotBelow) {
  EXPECT_EQ(float_above(0), 0);
  EXPECT_EQ(float_above(0.5), 0.5F);
  EXPECT_EQ(float_above(0.1), 0.1F);  // 0.1F is above 0.1
  EXPECT_GT(float_above(0.7), 0.7F);  // and 0.7F below 0.7
  EXPECT_EQ(float_above(1 + 1e-12), std::nextafter(1.0F, 2.0F));
}

}  // namespace
}  // namespace meshhier::tests
