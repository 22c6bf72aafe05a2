// Polygons seen from above, and what triangles have in them.
#include "export/plan_region.h"

#include "base/error.h"
#include "export/geojson.h"
#include "support/memory_files.h"
#include "support/taken_memory.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::exporting {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using Corners = std::array<Vec3d, 3>;

double twice_area(PlanPoint a, PlanPoint b, PlanPoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Returns the area of the part of one triangle that lies in another one, by clipping at its sides;
/// positive.
double common_area(std::vector<PlanPoint> polygon, std::array<PlanPoint, 3> in) {
  if (twice_area(in[0], in[1], in[2]) < 0)
    std::swap(in[1], in[2]);
  for (std::size_t side = 0; side < 3; ++side) {
    std::vector<PlanPoint> next;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const PlanPoint a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double x = twice_area(in[side], in[(side + 1) % 3], a);
      const double y = twice_area(in[side], in[(side + 1) % 3], b);
      if (x >= 0)
        next.push_back(a);
      if (x * y < 0) {
        const double t = x / (x - y);
        next.push_back({a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t});
      }
    }
    polygon = next;
  }
  double twice = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    twice += twice_area(polygon[0], polygon[i], polygon[i + 1]);
  return std::abs(twice) / 2;
}

/// Returns the area of the part of a triangle in a polygon without crossings: rings as sums of
/// signed triangles.
double area_in(const PlanPolygon& polygon, const std::array<PlanPoint, 3>& triangle) {
  double area = 0;
  for (const PlanRing& ring : polygon) {
    double in_ring = 0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
      const double turn = twice_area(ring[0], ring[i], ring[i + 1]);
      if (turn != 0)
        in_ring += std::copysign(
            common_area({triangle.begin(), triangle.end()}, {ring[0], ring[i], ring[i + 1]}), turn);
    }
    area += (&ring == &polygon[0] ? 1 : -1) * std::abs(in_ring);
  }
  return area;
}

std::array<PlanPoint, 3> plan(const Corners& corners) {
  return {PlanPoint{corners[0].x, corners[0].y},
          {corners[1].x, corners[1].y},
          {corners[2].x, corners[2].y}};
}

Vec3d place_of(const Corners& c, const TriangleCut& cut, std::uint32_t vertex) {
  if (vertex < 3)
    return c[vertex];
  const TriangleCut::Vertex& made = cut.vertices[vertex - 3];
  if (made.edge < 0)
    return c[0] + (c[1] - c[0]) * made.to + (c[2] - c[0]) * made.rest;
  const auto edge = static_cast<std::size_t>(made.edge);
  EXPECT_NEAR(made.to + made.rest, 1, 1e-15);
  return c[edge] + (c[(edge + 1) % 3] - c[edge]) * made.to;
}

/// Seen from above, turned as the triangle is.
double area_of(const Corners& corners, const TriangleCut& cut) {
  const auto [a, b, c] = plan(corners);
  const double whole = twice_area(a, b, c);
  if (cut.is_whole)
    return std::abs(whole) / 2;
  double twice = 0;
  for (const auto& t : cut.triangles) {
    const auto p = [&](std::size_t k) {
      const Vec3d place = place_of(corners, cut, t[k]);
      return PlanPoint{place.x, place.y};
    };
    const double part = twice_area(p(0), p(1), p(2));
    EXPECT_GE(part * whole, -1e-12) << "turned as the whole";
    twice += std::abs(part);
  }
  return twice / 2;
}

/// A comb with a hole: far from convex.
const PlanPolygon kComb{{{0, 0},
                         {8, 0},
                         {8, 6},
                         {6, 6},
                         {6, 2},
                         {5, 2},
                         {5, 6},
                         {3, 6},
                         {3, 2},
                         {2, 2},
                         {2, 6},
                         {0, 6}},
                        {{1, 0.5}, {7, 0.5}, {7, 1}, {1, 1}}};

class Chance {
 public:
  /// Returns a coordinate on a coarse lattice, so that corners meet borders and corners, or any.
  double coordinate(bool on_lattice) {
    const double number = std::uniform_real_distribution<double>(-1, 9)(engine_);
    return on_lattice ? std::round(number * 2) / 2 : number;
  }
  Vec3d corner(bool on_lattice) {
    return {coordinate(on_lattice), coordinate(on_lattice), coordinate(on_lattice)};
  }

 private:
  std::mt19937 engine_{7};
};

TEST(PlanRegion, PartsHaveTheAreaOfWhatLiesInIt) {
  const PlanRegion region({kComb}, UpAxis::z);
  Chance chance;
  std::size_t cut_ones = 0;
  for (int i = 0; i < 2000; ++i) {
    const bool on_lattice = i % 2 == 0;
    const Corners corners{chance.corner(on_lattice), chance.corner(on_lattice),
                          chance.corner(on_lattice)};
    const TriangleCut cut = region.cut(corners);
    EXPECT_NEAR(area_of(corners, cut), area_in(kComb, plan(corners)), 1e-9) << i;
    EXPECT_TRUE(!cut.is_whole || cut.triangles.empty());
    cut_ones += cut.triangles.empty() ? 0 : 1;
  }
  EXPECT_GT(cut_ones, 500U);
}

/// Ways along the edge from `a` to `b` at which a triangle is cut, measured from the one or the
/// other end.
std::set<double> ways(const TriangleCut& cut, int edge, bool from_its_end) {
  std::set<double> all;
  for (const auto& t : cut.triangles) {
    for (const std::uint32_t v : t) {
      if (v >= 3 && cut.vertices[v - 3].edge == edge)
        all.insert(from_its_end ? cut.vertices[v - 3].rest : cut.vertices[v - 3].to);
    }
  }
  return all;
}

TEST(PlanRegion, NeighboursAreCutAtTheSamePlacesOfTheirEdge) {
  const PlanRegion region({kComb}, UpAxis::z);
  Chance chance;
  std::size_t cut_edges = 0;
  for (int i = 0; i < 2000; ++i) {
    const bool on_lattice = i % 2 == 0;
    const Vec3d a = chance.corner(on_lattice), b = chance.corner(on_lattice);
    Vec3d c = chance.corner(on_lattice), d = chance.corner(on_lattice);
    if (i % 3 == 0)  // one of them is a wall above the edge
      d = a + (b - a) * 0.5 + Vec3d{0, 0, 1};
    if (a.x == b.x && a.y == b.y)
      continue;
    const TriangleCut one = region.cut({a, b, c}), other = region.cut({b, a, d});
    // Where both have something beside the edge, they have the same of it.
    const auto here = ways(one, 0, false), there = ways(other, 0, true);
    if (one.is_whole || other.is_whole) {
      EXPECT_TRUE(here.empty() || other.is_whole);
      continue;
    }
    if (!here.empty() && !there.empty()) {
      ++cut_edges;
      // On a border that runs along the edge the one side may have nothing.
      EXPECT_TRUE(here == there || on_lattice) << i;
      for (const double way : here)
        EXPECT_TRUE(way > 0 && way < 1);
    }
  }
  EXPECT_GT(cut_edges, 300U);
}

TEST(PlanRegion, AWholeTriangleBesideACutOneHasNoVertexOnItsEdge) {
  // A border that ends on the edge, and one that runs along it.
  const PlanRegion region({{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}}}, UpAxis::z);
  EXPECT_TRUE(region.cut({Vec3d{0, 0, 0}, {4, 0, 0}, {2, 2, 5}}).is_whole);
  EXPECT_TRUE(region.cut({Vec3d{1, 1, 0}, {2, 1, 0}, {1, 2, 5}}).is_whole);
  EXPECT_THAT(region.cut({Vec3d{0, 0, 0}, {4, 0, 0}, {2, -2, 5}}).triangles, SizeIs(0));
  EXPECT_THAT(region.cut({Vec3d{9, 9, 0}, {8, 9, 0}, {9, 8, 5}}).triangles, SizeIs(0));
}

TEST(PlanRegion, WallsAreCutIntoStrips) {
  const PlanRegion region({kComb}, UpAxis::z);
  // Along y = 4 the comb has three teeth: 0 to 2, 3 to 5, 6 to 8.
  const Corners wall{Vec3d{-1, 4, 0}, {9, 4, 0}, {9, 4, 10}};
  const TriangleCut cut = region.cut(wall);
  double area = 0;
  for (const auto& t : cut.triangles) {
    const Vec3d a = place_of(wall, cut, t[0]), b = place_of(wall, cut, t[1]),
                c = place_of(wall, cut, t[2]);
    const Vec3d normal = cross(b - a, c - a);
    EXPECT_LE(normal.y, 0) << "turned as the wall";
    area += length(normal) / 2;
  }
  // Heights grow from 0 at x = -1 by 1 each 1.
  EXPECT_NEAR(area, 2 * 2 + 2 * 5 + 2 * 8, 1e-12);
  // A needle without an extent from above.
  EXPECT_TRUE(region.cut({Vec3d{1, 4, 0}, {1, 4, 2}, {1, 4, 5}}).is_whole);
  EXPECT_FALSE(region.cut({Vec3d{2.5, 4, 0}, {2.5, 4, 2}, {2.5, 4, 5}}).is_whole);
}

TEST(PlanRegion, PolygonsThatOverlapAreOne) {
  const PlanRegion region({{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}}, {{{2, 2}, {6, 2}, {6, 6}, {2, 6}}}},
                          UpAxis::z);
  const Corners large{Vec3d{-10, -10, 0}, {30, -10, 0}, {-10, 30, 0}};
  EXPECT_NEAR(area_of(large, region.cut(large)), 16 + 16 - 4, 1e-9);
  EXPECT_TRUE(region.contains({3, 3, 7}));
  EXPECT_FALSE(region.contains({5, 1, 7}));
}

TEST(PlanRegion, YMayPointUp) {
  const PlanRegion region({{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}}}, UpAxis::y);
  EXPECT_TRUE(region.contains({1, 100, -1}));
  EXPECT_FALSE(region.contains({1, 100, 1}));
  EXPECT_TRUE(region.may_meet({{3, -1, -9}, {9, 1, -3}}));
  EXPECT_FALSE(region.may_meet({{3, -1, 1}, {9, 1, 3}}));
}

TEST(PlanRegion, BoxesWithinAndAroundItMeetIt) {
  const PlanRegion region({kComb}, UpAxis::z);
  EXPECT_TRUE(region.may_meet({{0.2, 3, 0}, {0.4, 3.5, 0}})) << "wholly in a tooth";
  EXPECT_FALSE(region.may_meet({{2.2, 3, 0}, {2.4, 3.5, 0}})) << "wholly between teeth";
  EXPECT_FALSE(region.may_meet({{2, 0.6, 0}, {3, 0.7, 0}})) << "wholly in the hole";
  EXPECT_TRUE(region.may_meet({{-9, -9, 0}, {9, 9, 0}}));
  EXPECT_FALSE(region.may_meet({{9, 9, 0}, {10, 10, 0}}));
  EXPECT_FALSE(PlanRegion({}, UpAxis::z).may_meet({{-9, -9, 0}, {9, 9, 0}}));
}

TEST(GeoJson, PolygonsOfAllItsKinds) {
  tests::MemoryFiles files;
  files.put("a",
            "\xef\xbb\xbf"
            R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "geometry": {"type": "Polygon", "coordinates":
      [[[0, 0], [1, 0, 5], [1, 1], [0, 0]], [[0.1, 0], [0.2, 0], [0.2, 0.1]]]}},
    {"type": "Feature", "geometry": null},
    {"type": "Feature", "geometry": {"type": "Point", "coordinates": [1, 2]}},
    {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [
      {"type": "MultiPolygon", "coordinates": [[[[5, 5], [6, 5], [6, 6]]], [[[7, 7], [8, 7], [8, 8]]]]}
    ]}}]})");
  const auto polygons = read_polygons(files, "a");
  ASSERT_THAT(polygons, SizeIs(3));
  ASSERT_THAT(polygons[0], SizeIs(2));
  EXPECT_EQ(polygons[0][0], (PlanRing{{0, 0}, {1, 0}, {1, 1}})) << "the last one is the first";
  EXPECT_EQ(polygons[2][0][1], (PlanPoint{8, 7}));
}

TEST(GeoJson, WhatIsNoneIsTold) {
  tests::MemoryFiles files;
  const auto refused = [&](const std::string& text) -> std::string {
    files.put("a.geojson", text);
    return tests::error_message(ErrorCode::input, [&] { read_polygons(files, "a.geojson"); });
  };
  EXPECT_THAT(refused("polygon (0 0)"), HasSubstr("a.geojson: is WKT"));
  EXPECT_THAT(refused("(0 0, 1 0)"), HasSubstr("a.geojson: is not valid JSON"));
  EXPECT_THAT(refused("[1]"), HasSubstr("expected an object, found array"));
  EXPECT_THAT(refused("{}"), HasSubstr("no \"type\""));
  EXPECT_THAT(refused(R"({"type": 7})"), HasSubstr("no \"type\""));
  EXPECT_THAT(refused(R"({"type": "FeatureCollection"})"), HasSubstr("has no list \"features\""));
  EXPECT_THAT(refused(R"({"type": "LineString", "coordinates": [[0, 0], [1, 1]]})"),
              HasSubstr("has no polygon"));
  EXPECT_THAT(refused(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [0, 0]]]})"),
              HasSubstr("fewer than three corners"));
  EXPECT_THAT(refused(R"({"type": "Polygon", "coordinates": [7]})"),
              HasSubstr("fewer than three corners"));
  EXPECT_THAT(refused(R"({"type": "MultiPolygon", "coordinates": [7]})"),
              HasSubstr("a polygon is no list of rings"));
  EXPECT_THAT(refused(R"({"type": "Polygon", "coordinates": [[[0, "x"], [1, 1], [0, 0]]]})"),
              HasSubstr("a position that is no list of numbers"));
  EXPECT_THAT(refused(R"({"type": "Polygon", "coordinates": [[[0, 1e999], [1, 1], [0, 0]]]})"),
              HasSubstr("a.geojson"));
  std::string deep;
  for (int i = 0; i < 100; ++i)
    deep += R"({"type": "GeometryCollection", "geometries": [)";
  EXPECT_THAT(refused(deep), HasSubstr("nested deeper than 64 levels"));
}

TEST(GeoJson, OtherFormatsAreNamedWithWhatToDo) {
  tests::MemoryFiles files;
  const std::string polygon =
      R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]})";
  const auto refused = [&](const std::string& text) -> std::string {
    files.put("a", text);
    return tests::error_message(ErrorCode::input, [&] { read_polygons(files, "a"); });
  };
  for (const char* wkt : {"POLYGON ((0 0, 1 0, 1 1, 0 0))", " multipolygon (((0 0, 1 0)))",
                          "SRID=4326;POLYGON((0 0, 1 0))", "\xef\xbb\xbfPolygon Z ((0 0 0))",
                          "LINESTRING (0 0, 1 1)", "GEOMETRYCOLLECTION EMPTY"})
    EXPECT_THAT(refused(wkt), HasSubstr("is WKT")) << wkt;
  EXPECT_THAT(refused("POLYGON ((0 0))"), HasSubstr(R"({"type": "Polygon", "coordinates")"));
  for (const std::string& lines :
       {polygon + '\n' + polygon + '\n', polygon + "\r\n\r\n" + polygon,
        "\x1e" + polygon + "\n\x1e" + polygon + '\n', "\xef\xbb\xbf" + polygon + '\n' + polygon})
    EXPECT_THAT(refused(lines), HasSubstr("one GeoJSON text a line")) << lines;
  EXPECT_THAT(refused("<?xml version='1.0'?><kml>"), HasSubstr("is XML"));
  EXPECT_THAT(refused(std::string("\0\0\x27\x0a\0\0", 6)), HasSubstr("is a shapefile"));
  EXPECT_THAT(refused(std::string("SQLite format 3\0", 16)), HasSubstr("ogr2ogr"));
  EXPECT_EQ(refused(polygon + '\n'), "");
  EXPECT_THAT(refused(polygon + "\nx"), HasSubstr("is not valid JSON"));
}

/// From the left to the right, up and down.
PlanPolygon zigzag(std::size_t corners) {
  PlanRing ring;
  for (std::size_t i = 0; i < corners; ++i)
    ring.push_back({static_cast<double>(i) / static_cast<double>(corners), i % 2 == 0 ? 0.0 : 1.0});
  ring.push_back({1, -1});
  ring.push_back({0, -1});
  return {ring};
}

TEST(PlanRegion, ManyCornersInOneTriangleTakeLittleMoreThanThemselves) {
  const Corners large{Vec3d{-3, -3, 0}, Vec3d{6, -3, 0}, Vec3d{0, 8, 0}};
  // Exact numbers take memory, so what is asked of it tells how many are computed.
  const auto asked = [&](std::size_t corners) {
    const PlanRegion region({zigzag(corners)}, UpAxis::z);
    const std::size_t before = tests::taken_count();
    const TriangleCut cut = region.cut(large);
    const std::size_t count = tests::taken_count() - before;
    EXPECT_NEAR(area_of(large, cut), 1.5 - 0.5 / static_cast<double>(corners), 1e-6);
    return count;
  };
  EXPECT_LT(asked(4000), 5 * asked(1000));
}

TEST(PlanRegion, ACutOfManyCornersCanBeEnded) {
  std::atomic<int> left{100};
  const PlanRegion region({zigzag(1000)}, UpAxis::z, [&left] {
    if (--left < 0)
      throw Error(ErrorCode::interrupted, "interrupted");
  });
  EXPECT_THROW(region.cut({Vec3d{-3, -3, 0}, {6, -3, 0}, {0, 8, 0}}), Error);
}

TEST(PlanRegion, BordersThatMeetAndCrossAreCountedAsOften) {
  // Two squares with a common side, a hole that is filled by another polygon, and a star.
  const PlanPolygon left{{{0, 0}, {2, 0}, {2, 2}, {0, 2}}}, right{{{2, 0}, {4, 0}, {4, 2}, {2, 2}}};
  const PlanPolygon holed{{{0, 3}, {4, 3}, {4, 7}, {0, 7}}, {{1, 4}, {3, 4}, {3, 6}, {1, 6}}};
  const PlanPolygon filling{{{1, 4}, {3, 4}, {3, 6}, {1, 6}}};
  const PlanPolygon star{{{5, 0}, {7, 4}, {9, 0}, {5, 3}, {9, 3}}};
  const Corners large{Vec3d{-9, -9, 0}, {40, -9, 0}, {-9, 40, 0}};
  const auto area = [&](const std::vector<PlanPolygon>& polygons) {
    return area_of(large, PlanRegion(polygons, UpAxis::z).cut(large));
  };
  EXPECT_NEAR(area({left, right}), 8, 1e-9);
  EXPECT_NEAR(area({left, left}), 4, 1e-9) << "in any of them";
  EXPECT_NEAR(area({holed}), 12, 1e-9);
  EXPECT_NEAR(area({holed, filling}), 16, 1e-9);
  EXPECT_NEAR(area({left, holed, right, filling}), 24, 1e-9);
  PlanRing twice = left[0];
  twice.insert(twice.end(), left[0].begin(), left[0].end());
  EXPECT_NEAR(area({{twice}}), 0, 1e-9) << "around twice is outside";
  const PlanRegion region({star}, UpAxis::z);
  Chance chance;
  for (int i = 0; i < 200; ++i) {
    const Corners small{chance.corner(false), chance.corner(false), chance.corner(false)};
    const TriangleCut cut = region.cut(small);
    const double whole = std::abs(twice_area(plan(small)[0], plan(small)[1], plan(small)[2])) / 2;
    EXPECT_LE(area_of(small, cut), whole + 1e-9);
  }
}

}  // namespace
}  // namespace meshhier::exporting
