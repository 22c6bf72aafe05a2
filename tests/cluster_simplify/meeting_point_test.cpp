#include "cluster_simplify/meeting_point.h"

#include "base/four_floats.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

float noise(std::uint64_t index, std::uint64_t stream) {
  return tests::hash_noise(index, stream);
}

Vec3f random_vector(std::uint64_t index, std::uint64_t stream) {
  return {noise(index, stream), noise(index, stream + 1), noise(index, stream + 2)};
}

Vec3f unit(Vec3f v) {
  return v * (1 / length(v));
}

/// `planes` planes near the vertex, in any direction.
VertexQuadric random_quadric(std::uint64_t seed, int planes, std::uint64_t stream) {
  VertexQuadric sum;
  for (int i = 0; i < planes; ++i) {
    const std::uint64_t at = seed * 16 + static_cast<std::uint64_t>(i);
    VertexQuadric plane;
    plane.add_plane(unit(random_vector(at, stream)), 1 + 0.5F * noise(at, stream + 3));
    sum += plane.about(random_vector(at, stream + 4) * 0.05F);
  }
  sum.area = 2 + noise(seed, stream + 7);
  return sum;
}

Planes<float> planes_of(const VertexQuadric& q) {
  return {q.xx, q.xy, q.xz, q.yy, q.yz, q.zz, q.b.x, q.b.y, q.b.z, q.c, q.area};
}

/// An edge: the quadrics of its ends, half the way from the first to the second.
struct Case {
  VertexQuadric p, q;
  Vec3f half;

  MeetingPoint<float> meet() const {
    return meeting_point(planes_of(p), planes_of(q), half.x, half.y, half.z);
  }
  float squared_edge() const { return 4 * dot(half, half); }
  /// In double precision, `x` from the middle; without what the edge's length costs.
  double plane_cost(Vec3d x) const {
    return at(p, x + to_double(half)) + at(q, x - to_double(half));
  }

 private:
  static double at(const VertexQuadric& q, Vec3d x) {
    return q.xx * x.x * x.x + q.yy * x.y * x.y + q.zz * x.z * x.z +
           2 * (q.xy * x.x * x.y + q.xz * x.x * x.z + q.yz * x.y * x.z) +
           2 * dot(to_double(q.b), x) + q.c;
  }
};

Case random_case(std::uint64_t seed) {
  const int planes = static_cast<int>(seed % 5);
  return {random_quadric(seed, planes, 40), random_quadric(seed, planes, 60),
          random_vector(seed, 80) * 0.3F};
}

Planes<FourFloats> four_of(const std::array<Case, 4>& cases, bool second) {
  Planes<FourFloats> result;
  for (int lane = 0; lane < 4; ++lane) {
    const Case& c = cases[static_cast<std::size_t>(lane)];
    const Planes<float> one = planes_of(second ? c.q : c.p);
    result.xx[lane] = one.xx;
    result.xy[lane] = one.xy;
    result.xz[lane] = one.xz;
    result.yy[lane] = one.yy;
    result.yz[lane] = one.yz;
    result.zz[lane] = one.zz;
    result.bx[lane] = one.bx;
    result.by[lane] = one.by;
    result.bz[lane] = one.bz;
    result.c[lane] = one.c;
    result.area[lane] = one.area;
  }
  return result;
}

TEST(MeetingPointTest, FourLanesAreFourSingleOnesBitForBit) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    std::array<Case, 4> cases;
    FourFloats hx, hy, hz;
    for (std::size_t lane = 0; lane < 4; ++lane) {
      cases[lane] = random_case(4 * seed + lane);
      if (seed % 10 == lane)
        cases[lane].half = {};
      hx[lane] = cases[lane].half.x;
      hy[lane] = cases[lane].half.y;
      hz[lane] = cases[lane].half.z;
    }
    const auto four = meeting_point(four_of(cases, false), four_of(cases, true), hx, hy, hz);
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const MeetingPoint<float> one = cases[lane].meet();
      const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
      ASSERT_EQ(bits(four.x[lane]), bits(one.x));
      ASSERT_EQ(bits(four.y[lane]), bits(one.y));
      ASSERT_EQ(bits(four.z[lane]), bits(one.z));
      ASSERT_EQ(bits(four.cost[lane]), bits(one.cost));
    }
  }
}

/// The least of the pulled function by Newton's method in double precision: one step.
Vec3d least_in_double(const Case& c) {
  const auto sum = [](float a, float b) { return double{a} + double{b}; };
  const Vec3d h = to_double(c.half);
  double xx = sum(c.p.xx, c.q.xx), yy = sum(c.p.yy, c.q.yy), zz = sum(c.p.zz, c.q.zz);
  const double xy = sum(c.p.xy, c.q.xy), xz = sum(c.p.xz, c.q.xz), yz = sum(c.p.yz, c.q.yz);
  const auto slope = [&](const VertexQuadric& q, Vec3d x) {
    return to_double(q.b) + Vec3d{q.xx * x.x + q.xy * x.y + q.xz * x.z,
                                  q.xy * x.x + q.yy * x.y + q.yz * x.z,
                                  q.xz * x.x + q.yz * x.y + q.zz * x.z};
  };
  const Vec3d b = slope(c.p, h) + slope(c.q, h * -1.0);
  const double pull = double{kMiddlePull} * (xx + yy + zz);
  xx += pull;
  yy += pull;
  zz += pull;
  const Vec3d r0{xx, xy, xz}, r1{xy, yy, yz}, r2{xz, yz, zz};
  const double determinant = dot(r0, cross(r1, r2));
  return (cross(r1, r2) * b.x + cross(r2, r0) * b.y + cross(r0, r1) * b.z) * (-1 / determinant);
}

TEST(MeetingPointTest, IsWherePlanesAreNearestInDoublePrecision) {
  int met = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const Case c{random_quadric(seed, 4, 40), random_quadric(seed, 4, 60),
                 random_vector(seed, 80) * 0.3F};
    const MeetingPoint<float> found = c.meet();
    const Vec3d place{found.x, found.y, found.z};
    const Vec3d least = least_in_double(c);
    if (length(least) > 1.99 * std::sqrt(double{c.squared_edge()}))
      continue;
    ++met;
    ASSERT_LE(length(place - least), 1e-3 * (length(least) + 1e-2)) << seed;
    const double length_cost =
        double{kLengthCost} * double{c.p.area + c.q.area} * double{c.squared_edge()};
    ASSERT_NEAR(double{found.cost}, c.plane_cost(place) + length_cost, 1e-5);
    for (std::uint64_t i = 0; i < 10; ++i) {
      const Vec3d nearby = place + to_double(random_vector(i, 90)) * 0.05;
      ASSERT_GE(c.plane_cost(nearby), c.plane_cost(place) - 1e-5) << seed;
    }
  }
  EXPECT_GT(met, 300);
}

TEST(MeetingPointTest, ThreePlanesMeetInTheirCorner) {
  // The corner of a cube, half an edge's length from the edge's middle.
  Case c{{}, {}, {0.5F, 0, 0}};
  for (const Vec3f axis : {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}}) {
    VertexQuadric plane;
    plane.add_plane(axis, 1);
    c.p += plane.about({-0.25F, -0.5F, -0.125F});
  }
  const MeetingPoint<float> found = c.meet();  // the first vertex lies half an edge back
  EXPECT_NEAR(found.x, -0.25F, 1e-4);
  EXPECT_NEAR(found.y, 0.5F, 1e-4);
  EXPECT_NEAR(found.z, 0.125F, 1e-4);
  EXPECT_NEAR(found.cost, 0, 1e-6);
}

TEST(MeetingPointTest, OnOnePlaneItIsTheNearestPointOfIt) {
  Case c{{}, {}, {0.5F, 0, 0}};
  VertexQuadric plane;
  plane.add_plane({0, 0, 1}, 2);
  c.p = c.q = plane.about({0, 0, -0.25F});
  const MeetingPoint<float> found = c.meet();
  EXPECT_NEAR(found.x, 0, 1e-4);
  EXPECT_NEAR(found.y, 0, 1e-4);
  EXPECT_NEAR(found.z, 0.25F, 1e-4);
}

void expect_middle(const Case& c) {
  const MeetingPoint<float> found = c.meet();
  EXPECT_EQ(found.x, 0);
  EXPECT_EQ(found.y, 0);
  EXPECT_EQ(found.z, 0);
  EXPECT_TRUE(std::isfinite(found.cost));
  EXPECT_GE(found.cost, 0);
}

TEST(MeetingPointTest, IsTheMiddleWherePlanesSayNothing) {
  expect_middle({{}, {}, {0.5F, 0.25F, 0}});
  expect_middle({{}, {}, {}});
}

TEST(MeetingPointTest, IsTheMiddleWherePlanesLeadTooFar) {
  // Two planes that meet at a small angle, far along x.
  Case c{{}, {}, {0.01F, 0, 0}};
  for (const float tilt : {0.02F, -0.02F}) {
    VertexQuadric plane;
    plane.add_plane(unit({tilt, 0, 1}), 1);
    (tilt > 0 ? c.p : c.q) = plane.about({0, 0, tilt});
  }
  EXPECT_GT(length(least_in_double(c)), 0.5);
  expect_middle(c);
}

TEST(MeetingPointTest, ShortEdgesGoFirstOnFlatGround) {
  VertexQuadric flat;
  flat.add_plane({0, 0, 1}, 1);
  flat.area = 1;
  const float short_edge = Case{flat, flat, {0.1F, 0, 0}}.meet().cost;
  const float long_edge = Case{flat, flat, {0.2F, 0, 0}}.meet().cost;
  EXPECT_GT(short_edge, 0);
  EXPECT_NEAR(long_edge, 4 * short_edge, 1e-3 * long_edge);
}

TEST(MeetingPointTest, IsFiniteForTheSmallestTriangles) {
  for (const float size : {1e-3F, 1e-10F, 1e-18F, 1e-22F, 1e-30F, 1e-44F}) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      Case c = random_case(seed);
      for (VertexQuadric* q : {&c.p, &c.q}) {
        for (float* value : {&q->xx, &q->xy, &q->xz, &q->yy, &q->yz, &q->zz, &q->b.x, &q->b.y,
                             &q->b.z, &q->c, &q->area})
          *value *= size;
      }
      const MeetingPoint<float> found = c.meet();
      ASSERT_TRUE(std::isfinite(found.x) && std::isfinite(found.y) && std::isfinite(found.z));
      ASSERT_GE(found.cost, 0);
    }
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
