#include "tests/texture/painted.h"
#include "tests/texture/random_numbers.h"
#include "texture/chart_overlap.h"
#include "texture/chart_projection.h"
#include "texture/distinct_triangles.h"
#include "texture/faces.h"
#include "texture/texel_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

constexpr TexelRange kAll{0, 0, 64, 64};

/// Adds a sheet of squares, whose inner points are moved a little.
void add_sheet(Mesh& mesh, double left, double top, double side, RandomNumbers& random) {
  constexpr std::uint32_t kSquares = 6;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const double step = side / kSquares;
  for (std::uint32_t y = 0; y <= kSquares; ++y) {
    for (std::uint32_t x = 0; x <= kSquares; ++x) {
      const auto off = [&] { return (random.part() - 0.5) * step * 0.4; };
      mesh.positions.push_back(to_float(Vec3d{left + x * step + off(), top + y * step + off(), 0}));
    }
  }
  const auto at = [&](std::uint32_t x, std::uint32_t y) {
    return TileVertex{first + y * (kSquares + 1) + x};
  };
  for (std::uint32_t y = 0; y < kSquares; ++y) {
    for (std::uint32_t x = 0; x < kSquares; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
}

std::vector<FixedTexelPoint> places_of(const Mesh& mesh) {
  std::vector<FixedTexelPoint> places;
  for (const Vec3f& p : mesh.positions)
    places.push_back(FixedTexelPoint::of({double(p.x), double(p.y)}));
  return places;
}

std::vector<std::uint32_t> all_of(const Mesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

TexelRange overlap_of(const Mesh& mesh) {
  const Faces faces = faces_of(mesh.positions, mesh.triangles);
  return ChartOverlap(mesh.triangles, faces)(all_of(mesh), places_of(mesh), kAll);
}

/// The same by drawing all triangles.
TexelRange drawn_overlap_of(const Mesh& mesh) {
  const std::vector<FixedTexelPoint> places = places_of(mesh);
  std::vector<int> counts(std::size_t{kAll.right} * kAll.bottom);
  for (const TileTriangle& t : mesh.triangles)
    RasterTriangle(std::array{places[raw(t[0])], places[raw(t[1])], places[raw(t[2])]})
        .for_each(kAll.right, kAll.bottom, [&](std::uint32_t x, std::uint32_t y, double, double) {
          ++counts[y * std::size_t{kAll.right} + x];
        });
  TexelRange range{kAll.right, kAll.bottom, 0, 0};
  for (std::uint32_t y = 0; y < kAll.bottom; ++y) {
    for (std::uint32_t x = 0; x < kAll.right; ++x) {
      if (counts[y * std::size_t{kAll.right} + x] > 1)
        range = {std::min(range.left, x), std::min(range.top, y), std::max(range.right, x + 1),
                 std::max(range.bottom, y + 1)};
    }
  }
  return range.left < range.right ? range : TexelRange{};
}

void expect_equal(const TexelRange& a, const TexelRange& b) {
  EXPECT_EQ((std::array{a.left, a.top, a.right, a.bottom}),
            (std::array{b.left, b.top, b.right, b.bottom}));
}

TEST(ChartOverlap, IsWhatDrawingAllTrianglesFinds) {
  RandomNumbers random(11);
  int overlapping = 0;
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    Mesh mesh;
    for (std::uint32_t sheets = 1 + random.below(3); sheets > 0; --sheets)
      add_sheet(mesh, random.part() * 50, random.part() * 50, 4 + random.part() * 20, random);
    const TexelRange drawn = drawn_overlap_of(mesh);
    expect_equal(overlap_of(mesh), drawn);
    overlapping += drawn.right > 0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 30);
  EXPECT_LT(overlapping, 170);
}

// Middles of texels on edges belong to one of both sides.
TEST(ChartOverlap, SheetsThatTouchDoNotCoverEachOther) {
  for (const double at : {8.0, 8.5, 8.25}) {
    Mesh mesh;
    for (const double left : {at, at + 6}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [x, y] : {std::pair{0., 0.}, {6., 0.}, {6., 6.}, {0., 6.}})
        mesh.positions.push_back(to_float(Vec3d{left + x, at + y, 0}));
      mesh.triangles.push_back({TileVertex{first}, TileVertex{first + 1}, TileVertex{first + 2}});
      mesh.triangles.push_back({TileVertex{first}, TileVertex{first + 2}, TileVertex{first + 3}});
    }
    expect_equal(overlap_of(mesh), {});
  }
}

TEST(ChartOverlap, IsAllWhereATriangleShowsItsBackSide) {
  RandomNumbers random(3);
  Mesh mesh;
  add_sheet(mesh, 10, 10, 20, random);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  expect_equal(overlap_of(mesh), kAll);
}

// It takes bounded memory.
TEST(ChartOverlap, IsAllWhereTheBorderIsTooLong) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 6000; ++i) {
    for (const auto& [x, y] : {std::pair{9., 1.}, {12., 1.}, {9., 63.}})
      mesh.positions.push_back(to_float(Vec3d{x, y, 0}));
    mesh.triangles.push_back({TileVertex{3 * i}, TileVertex{3 * i + 1}, TileVertex{3 * i + 2}});
  }
  expect_equal(overlap_of(mesh), kAll);
}

TEST(ChartOverlap, BeyondThePictureNothingIsCovered) {
  RandomNumbers random(5);
  Mesh mesh;
  add_sheet(mesh, 55, 55, 20, random);
  add_sheet(mesh, 66, 66, 20, random);
  expect_equal(overlap_of(mesh), {});
  add_sheet(mesh, -10, 50, 100, random);
  expect_equal(overlap_of(mesh), drawn_overlap_of(mesh));
}

struct Extent {
  double low = std::numeric_limits<double>::max(), high = -low;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

TEST(ChartProjector, TheBoxHoldsAllCornersAndIsSmall) {
  const Mesh mesh = make_torus(24, 12, 0.05);
  const Faces faces = faces_of(mesh.positions, mesh.triangles);
  ChartProjector project(mesh.positions, mesh.triangles, faces);
  for (std::uint32_t begin = 0; begin + 40 < mesh.triangles.size(); begin += 31) {
    SCOPED_TRACE(begin);
    std::vector<std::uint32_t> chart(1 + begin % 40);
    std::iota(chart.begin(), chart.end(), begin);
    const ChartPlane plane = project(chart);
    EXPECT_NEAR(dot(plane.x, plane.y), 0, 1e-12);
    EXPECT_GE(dot(cross(plane.x, plane.y), plane.normal), 1 - 1e-12);
    EXPECT_GE(plane.width, plane.height);
    double least = std::numeric_limits<double>::max();
    for (int turn = 0; turn < 90; ++turn) {
      const double angle = turn * (std::acos(-1.0) / 180);
      Extent x, y, own_x, own_y;
      for (const std::uint32_t t : chart) {
        for (const TileVertex corner : mesh.triangles[t]) {
          const Vec3d at = to_double(mesh.positions[raw(corner)]);
          own_x.add(dot(at, plane.x));
          own_y.add(dot(at, plane.y));
          x.add(dot(at, plane.x * std::cos(angle) + plane.y * std::sin(angle)));
          y.add(dot(at, plane.y * std::cos(angle) + plane.x * -std::sin(angle)));
        }
      }
      EXPECT_NEAR(own_x.low, plane.low_x, 1e-12);
      EXPECT_NEAR(own_y.low, plane.low_y, 1e-12);
      EXPECT_NEAR(own_x.high - own_x.low, plane.width, 1e-12);
      EXPECT_NEAR(own_y.high - own_y.low, plane.height, 1e-12);
      least = std::min(least, (x.high - x.low) * (y.high - y.low));
    }
    EXPECT_LE(plane.width * plane.height, 1.15 * least + 1e-12);
  }
}

TEST(DistinctTriangles, AreTheFirstOfEqualOnesInAnyOrder) {
  RandomNumbers random(17);
  for (int round = 0; round < 50; ++round) {
    std::vector<TileTriangle> all(60);
    for (TileTriangle& t : all)
      t = {TileVertex{random.below(3)}, TileVertex{random.below(3)}, TileVertex{random.below(3)}};
    if (round % 3 > 0)  // as tiles have them
      std::sort(all.begin(), all.begin() + 20 * (round % 3));
    if (round % 3 > 0)
      std::sort(all.begin() + 20 * (round % 3), all.end());
    const DistinctTriangles distinct(all);
    std::vector<TileTriangle> expected;
    for (const TileTriangle& t : all) {
      if (std::ranges::find(expected, t) == expected.end())
        expected.push_back(t);
    }
    EXPECT_EQ(std::vector(distinct.triangles().begin(), distinct.triangles().end()), expected);
    EXPECT_EQ(distinct.expanded(expected), all);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(std::ranges::find(all, expected[i]) - all.begin(), distinct.firsts()[i]);
  }
}

}  // namespace
}  // namespace meshhier::texture
