// The lines of cuts, as promises: closed on closed meshes, whatever lies on the plane.
#include "drawing/line_store.h"
#include "drawing/tile_lines.h"
#include "drawing/view.h"
#include "tests/drawing/drawn_models.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

namespace meshhier::drawing {
namespace {

using nlohmann::json;
using testing::HasSubstr;

exporting::CutPart part_of(const tests::TestMesh& mesh) {
  exporting::CutPart part;
  part.vertices.positions = mesh.positions;
  for (const auto& t : mesh.triangles)
    part.triangles.push_back({t[0], t[1], t[2]});
  return part;
}

exporting::MapFrame plain_frame() {
  exporting::MapFrame frame;
  frame.rows = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  return frame;
}

TileLines lines_at(const tests::TestMesh& mesh, std::vector<double> heights) {
  const exporting::CutPart part = part_of(mesh);
  return tile_lines(SlicedPart(part, plain_frame()), CutLevels(std::move(heights)));
}

/// A block of unit cubes' faces: [0, n]^3, all corners on whole numbers, each face in 2 n^2.
tests::TestMesh block(int n) {
  tests::TestMesh mesh;
  const auto add_face = [&](Vec3f origin, Vec3f along, Vec3f up) {
    const auto at = [&](int i, int k) {
      return origin + along * static_cast<float>(i) + up * static_cast<float>(k);
    };
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Vec3f& p : {at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)})
          mesh.positions.push_back(p);
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
      }
    }
  };
  const auto m = static_cast<float>(n);
  add_face({0, 0, 0}, {0, 1, 0}, {1, 0, 0});
  add_face({0, 0, m}, {1, 0, 0}, {0, 1, 0});
  add_face({0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  add_face({0, m, 0}, {0, 0, 1}, {1, 0, 0});
  add_face({0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  add_face({m, 0, 0}, {0, 1, 0}, {0, 0, 1});
  return mesh;
}

double length_of(const TileLines& lines) {
  double sum = 0;
  std::size_t first = 0;
  for (const TileStretch& stretch : lines.stretches) {
    for (std::size_t i = 1; i < stretch.points; ++i)
      sum += length(lines.points[first + i] - lines.points[first + i - 1]);
    if (stretch.is_closed)
      sum += length(lines.points[first] - lines.points[first + stretch.points - 1]);
    first += stretch.points;
  }
  return sum;
}

double area_of(const TileLines& lines) {
  double sum = 0;
  std::size_t first = 0;
  for (const TileStretch& stretch : lines.stretches) {
    for (std::size_t i = 0; i < stretch.points; ++i) {
      const Vec3d& a = lines.points[first + i];
      const Vec3d& b = lines.points[first + (i + 1) % stretch.points];
      sum += (a.x * b.y - b.x * a.y) / 2;
    }
    first += stretch.points;
  }
  return sum;
}

TEST(SectionLines, OfABlockAreSquaresWhateverLiesOnThePlane) {
  constexpr int kSide = 5;
  const tests::TestMesh mesh = block(kSide);
  for (const double height : {0.5, 1.0, 3.0, 4.25, 5.0}) {
    const TileLines lines = lines_at(mesh, {height});
    ASSERT_EQ(lines.stretches.size(), 1U) << height;
    EXPECT_TRUE(lines.stretches[0].is_closed) << height;
    EXPECT_DOUBLE_EQ(length_of(lines), 4 * kSide) << height;
    EXPECT_DOUBLE_EQ(area_of(lines), kSide * kSide) << height << ": solid is on the left";
  }
  EXPECT_TRUE(lines_at(mesh, {0.0}).stretches.empty()) << "all is on it or above";
  EXPECT_TRUE(lines_at(mesh, {5.001}).stretches.empty());
}

TEST(SectionLines, OfClosedMeshesAreClosed) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(2000, 0.01F), tests::torus(3000), tests::genus_n(3, 4000, 0.005F),
        tests::nested_shells(3000)}) {
    std::vector<double> heights;
    for (const Vec3f& p : mesh.positions) {
      if (heights.size() < 40 && std::abs(p.z) < 0.6F)
        heights.push_back(p.z);  // each passes through a vertex, exactly
    }
    heights.push_back(0);
    const TileLines lines = lines_at(mesh, heights);
    EXPECT_FALSE(lines.stretches.empty());
    for (const TileStretch& stretch : lines.stretches)
      EXPECT_TRUE(stretch.is_closed) << heights[stretch.level];
  }
}

TEST(SectionLines, ATopThatTouchesAPlaneMakesNoLine) {
  const TileLines lines = lines_at(tests::sphere(512), {1.0, -1.0});
  EXPECT_TRUE(lines.stretches.empty());
}

TEST(SectionLines, OfOpenMeshesEndAtTheBorder) {
  tests::TestMesh mesh = tests::open_grid(20, 10);
  for (Vec3f& p : mesh.positions)
    p.z = p.y;
  const TileLines lines = lines_at(mesh, {2.5, 4});
  ASSERT_EQ(lines.stretches.size(), 2U);
  EXPECT_FALSE(lines.stretches[0].is_closed);
  EXPECT_DOUBLE_EQ(length_of(lines), 40);
}

// ---- of hierarchies -----------------------------------------------------------------------------

class LinesOfHierarchies : public DrawnModels {
 protected:
  struct Found {
    std::size_t lines = 0, closed = 0;
    double length = 0;
  };
  Found found(const DrawingOptions& options) {
    const json made = json::parse(drawn(options, "lines.geojson"));
    Found all;
    for (const json& feature : made.at("features")) {
      ++all.lines;
      const bool is_closed = feature.at("properties").at("closed");
      all.closed += is_closed ? 1 : 0;
      const json& points = feature.at("geometry").at("coordinates");
      EXPECT_EQ(points.front() == points.back(), is_closed);
      for (std::size_t i = 1; i < points.size(); ++i) {
        const auto at = [&](std::size_t k) {
          return Vec3d{points[k][0], points[k][1], points[k][2]};
        };
        EXPECT_NE(at(i), at(i - 1));
        all.length += length(at(i) - at(i - 1));
      }
    }
    return all;
  }
};

TEST_F(LinesOfHierarchies, AreJoinedAcrossTiles) {
  build(tests::torus(20000));
  const Found level = found({.cut_heights = {0}});
  EXPECT_EQ(level.lines, 2U);
  EXPECT_EQ(level.closed, 2U);
  EXPECT_NEAR(level.length, 2 * 3.14159 * (1.0 + 0.4), 0.01);
  const Found upright = found({.view = SectionLine{{-2, 0}, {2, 0}}});
  EXPECT_EQ(upright.closed, 2U);
  EXPECT_NEAR(upright.length, 2 * 2 * 3.14159 * 0.3, 0.01);
  const Found oblique = found({.view = SectionPlane{{1, 2, 3}, 0.1}});
  EXPECT_EQ(oblique.closed, oblique.lines);
}

TEST_F(LinesOfHierarchies, OfSimplifiedLevelsAreClosedToo) {
  build(tests::torus(20000));
  for (const int level : {0, 2, 4}) {
    const Found lines = found({.cut_heights = {0, 0.1, 0.2},
                               .selection = exporting::ExportSelection(static_cast<Level>(level))});
    EXPECT_EQ(lines.lines, 6U) << level;
    EXPECT_EQ(lines.closed, 6U) << level;
  }
  const Found mixed =
      found({.cut_heights = {0},
             .selection = exporting::ExportSelection(exporting::LargestError{0.002})});
  EXPECT_EQ(mixed.lines, 2U);
  EXPECT_EQ(mixed.closed, 2U);
}

TEST_F(LinesOfHierarchies, AreTheSameBytesForAnyThreadsAndBudget) {
  build(tests::torus(20000));
  for (const char* name : {"a.svg", "a.dxf", "a.geojson"}) {
    DrawingOptions options{.contours = 0.05};
    options.paper.has_grid = true;
    const std::string first = drawn(options, name);
    options.memory_budget = std::uint64_t{24} << 20;
    for (const std::size_t threads : {1, 2, 7}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(drawn(options, name), first) << name << ' ' << threads;
    }
  }
}

TEST_F(LinesOfHierarchies, LieOnTheMap) {
  tests::TestMesh hill = tests::open_grid(60, 60);
  for (Vec3f& p : hill.positions)
    p = {p.x * 10 + 600000, p.y * 10 + 5300000, p.x + p.y};
  tests::write_ply(hill, path("mesh.ply"));
  build(config::parse_config(
      R"({"input": "mesh.ply", "output": "mesh.hier", "up": "z", "preview": false,
          "placement": {"crs": "EPSG:25832"}, "partition": {"vertices": 500}})",
      {"c", directory_.path()}, {}));
  const json made = json::parse(drawn({.contours = 10}, "lines.geojson"));
  EXPECT_EQ(made.at("features").size(), 11U) << "the corner at 120 is a point";
  const json& first = made.at("features")[0];
  EXPECT_EQ(first.at("properties").at("elevation"), 10);
  const json& place = first.at("geometry").at("coordinates")[0];
  EXPECT_NEAR(place[0], 10.34, 0.01);  // longitude
  EXPECT_NEAR(place[1], 47.84, 0.01);
  EXPECT_THAT(drawn({.contours = 10}, "lines.dxf"), HasSubstr("$INSUNITS\n 70\n6\n"));
}

TEST_F(LinesOfHierarchies, GoIntoTheFormats) {
  build(tests::sphere(3000), Unit::ft);
  const std::string dxf = drawn({.cut_heights = {0.25}}, "a.dxf");
  EXPECT_THAT(dxf, HasSubstr("$INSUNITS\n 70\n2\n"));
  EXPECT_THAT(dxf, HasSubstr("LWPOLYLINE"));
  EXPECT_THAT(dxf, HasSubstr(" 38\n0.25\n"));
  EXPECT_THAT(drawn({.view = SectionLine{{0, -1}, {0, 1}}}, "a.dxf"), HasSubstr("AcDb3dPolyline"));
  DrawingOptions flat{.view = SectionLine{{0, -1}, {0, 1}}};
  flat.is_flat = true;
  EXPECT_THAT(drawn(flat, "a.dxf"), HasSubstr("LWPOLYLINE"));
  DrawingOptions scaled{.cut_heights = {0}};
  scaled.paper.scale = 10;
  const std::string svg = drawn(scaled, "a.svg");
  EXPECT_THAT(svg, HasSubstr("data-level=\"0\""));
  EXPECT_THAT(svg, HasSubstr("mm\" viewBox=\"0 0 "));
  EXPECT_THAT(svg, HasSubstr(">1:10</text>"));
}

TEST_F(LinesOfHierarchies, RefuseWhatCannotBe) {
  build(tests::sphere(3000), std::nullopt);
  EXPECT_THAT(refusal({}, "a.svg"), HasSubstr("--cut-height, --section"));
  EXPECT_THAT(refusal({.cut_heights = {5}}, "a.dxf"), HasSubstr("from -1 to 1"));
  EXPECT_THAT(refusal({.view = SectionLine{{5, 5}, {6, 5}}}, "a.dxf"), HasSubstr("cuts nothing"));
  EXPECT_THAT(refusal({.view = SectionLine{{5, 5}, {5, 5}}}, "a.dxf"), HasSubstr("--section"));
  EXPECT_THAT(refusal({.view = SectionPlane{{0, 0, 0}, 1}}, "a.dxf"), HasSubstr("--plane"));
  EXPECT_THAT(refusal({.cut_heights = {0}}, "a.svg"), HasSubstr("--units"));
  EXPECT_THAT(refusal({.contours = 1e-12}, "a.dxf"), HasSubstr("there may be 100000"));
  EXPECT_THAT(refusal({.view = Side::left, .contours = 0.1}, "a.dxf"), HasSubstr("cut a plan"));
  DrawingOptions tiny{.contours = 1e-4};
  tiny.memory_budget = std::uint64_t{1} << 20;
  EXPECT_THAT(refusal(tiny, "a.dxf", ErrorCode::budget), HasSubstr("--memory-budget"));
  EXPECT_NE(drawn({.cut_heights = {0}}, "b.dxf"), "");
}

}  // namespace
}  // namespace meshhier::drawing
