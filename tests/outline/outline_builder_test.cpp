#include "outline/outline_builder.h"

#include "base/bounds.h"
#include "base/error.h"
#include "outline/polyline.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <gtest/gtest.h>

namespace meshhier::outline {
namespace {

using tests::MeshTriangle;
using tests::TestMesh;

/// The tiles of a mesh whose vertex v is in sector sectors[v], as tile_mesh.h describes them.
std::vector<TileMesh> cut(const TestMesh& mesh, const std::vector<std::uint32_t>& sectors) {
  std::vector<TileMesh> tiles(1 + *std::max_element(sectors.begin(), sectors.end()));
  const auto is_border = [&](const MeshTriangle& t) {
    return sectors[t[0]] != sectors[t[1]] || sectors[t[0]] != sectors[t[2]];
  };
  std::vector<bool> boundary(sectors.size(), false);
  for (const MeshTriangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t)
      boundary[corner] = boundary[corner] || is_border(t);
  }
  std::vector<std::uint32_t> index(sectors.size());
  for (const bool in_boundary : {true, false}) {
    for (std::size_t v = 0; v < sectors.size(); ++v) {
      TileMesh& tile = tiles[sectors[v]];
      if (boundary[v] != in_boundary)
        continue;
      index[v] = tile.own_count++;
      tile.boundary_count += in_boundary ? 1 : 0;
      tile.vertices.positions.push_back(mesh.positions[v]);
    }
  }
  std::vector<std::map<GhostRef, std::uint32_t>> ghosts(tiles.size());  // to the mesh's vertex
  for (const MeshTriangle& t : mesh.triangles) {
    for (const std::uint32_t a : t) {
      for (const std::uint32_t b : t) {
        if (sectors[a] != sectors[b])
          ghosts[sectors[a]][{sectors[b], index[b]}] = b;
      }
    }
  }
  for (std::size_t s = 0; s < tiles.size(); ++s) {
    std::map<std::uint32_t, std::uint32_t> ghost_index;
    for (const auto& [ref, vertex] : ghosts[s]) {
      ghost_index[vertex] = static_cast<std::uint32_t>(tiles[s].vertices.size());
      tiles[s].ghosts.push_back(ref);
      tiles[s].vertices.positions.push_back(mesh.positions[vertex]);
    }
    const auto local = [&](std::uint32_t v) {
      return TileVertex{sectors[v] == s ? index[v] : ghost_index.at(v)};
    };
    for (const MeshTriangle& t : mesh.triangles) {
      if (sectors[t[0]] != s && sectors[t[1]] != s && sectors[t[2]] != s)
        continue;
      (is_border(t) ? tiles[s].border : tiles[s].interior)
          .push_back({local(t[0]), local(t[1]), local(t[2])});
    }
    normalize_triangles(tiles[s].interior, false);
    normalize_triangles(tiles[s].border, false);
  }
  return tiles;
}

std::vector<std::uint32_t> sectors_by(const TestMesh& mesh,
                                      const std::function<std::uint32_t(Vec3f)>& sector_at) {
  std::vector<std::uint32_t> sectors;
  for (const Vec3f p : mesh.positions)
    sectors.push_back(sector_at(p));
  return sectors;
}

/// The nearest of `count` pseudo-random seeds on the unit sphere.
std::function<std::uint32_t(Vec3f)> nearest_of(std::uint32_t count) {
  return [seeds = tests::points(count).positions](Vec3f p) {
    const auto distance = [&](Vec3f seed) { return length(seed * (1 / length(seed)) - p); };
    const auto nearest = std::min_element(
        seeds.begin(), seeds.end(), [&](Vec3f a, Vec3f b) { return distance(a) < distance(b); });
    return static_cast<std::uint32_t>(nearest - seeds.begin());
  };
}

/// The sizes a file of 12-byte vertices and 4-byte segments has.
std::size_t file_bytes(std::size_t vertices, std::size_t segments) {
  return 1000 + 12 * vertices + 4 * segments;
}

std::size_t bytes_of(const Outline& outline) {
  return file_bytes(outline.vertices.size(), outline.vertices.size() - outline.polyline_count());
}

OutlineOptions options_for(const TestMesh& mesh, double tolerance) {
  return {.tolerance = tolerance,
          .diagonal = diagonal(bounds_of(mesh.positions)),
          .max_bytes = 32768,
          .file_bytes = file_bytes};
}

OutlineOptions unlimited(OutlineOptions options) {
  options.file_bytes = nullptr;
  return options;
}

OutlineResult finished(OutlineBuilder& builder, const OutlineOptions& options) {
  builder.join();
  return builder.finish(options);
}

OutlineResult outline_of(const std::vector<TileMesh>& tiles, const OutlineOptions& options) {
  OutlineBuilder builder;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    builder.add({static_cast<std::uint32_t>(i), tiles[i]});
  }
  return finished(builder, options);
}

std::span<const Vec3f> polyline(const Outline& outline, std::size_t i) {
  return std::span(outline.vertices)
      .subspan(outline.starts[i], outline.starts[i + 1] - outline.starts[i]);
}

bool is_loop(std::span<const Vec3f> points) {
  return points.front() == points.back();
}

std::array<float, 3> as_array(Vec3f p) {
  return {p.x, p.y, p.z};
}

/// How many open polylines end at each point.
std::map<std::array<float, 3>, int> loose_ends(const Outline& outline) {
  std::map<std::array<float, 3>, int> ends;
  for (std::size_t i = 0; i < outline.polyline_count(); ++i) {
    ++ends[as_array(polyline(outline, i).front())];
    ++ends[as_array(polyline(outline, i).back())];
  }
  return ends;
}

TEST(OutlineBuilder, NothingGivesAnEmptyOutline) {
  const OutlineResult none = outline_of({}, options_for(tests::sphere(8), 0.01));
  EXPECT_EQ(none.outline.polyline_count(), 0u);
  EXPECT_EQ(none.polylines_found, 0u);
  const TestMesh mesh = tests::sphere(100);  // closed, in one sector
  const std::vector<std::uint32_t> one(mesh.positions.size(), 0);
  EXPECT_EQ(outline_of(cut(mesh, one), options_for(mesh, 0.01)).polylines_found, 0u);
  const TestMesh points = tests::points(10);
  EXPECT_EQ(outline_of(cut(points, std::vector<std::uint32_t>(10, 0)), options_for(points, 0.01))
                .polylines_found,
            0u);
}

TEST(OutlineBuilder, AGridInFourSectorsGivesACrossAndItsBorder) {
  const TestMesh mesh = tests::open_grid(7, 7);
  const auto tiles = cut(mesh, sectors_by(mesh, [](Vec3f p) {
                           return (p.x > 3.5f ? 1u : 0u) + (p.y > 3.5f ? 2u : 0u);
                         }));
  // The arms are straight but for the junctions, a sixth of a cell (0.017 of the diagonal) off.
  const OutlineResult result = outline_of(tiles, options_for(mesh, 0.02));
  EXPECT_EQ(result.polylines_dropped, 0u);
  EXPECT_EQ(result.tolerance, 0.02);
  // Four arms; the middle cell's diagonal between its two triangles, both junctions; four corners.
  ASSERT_EQ(result.outline.polyline_count(), 9u);
  std::set<std::array<float, 3>> corners;
  std::size_t arms = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const auto points = polyline(result.outline, i);
    if (points.size() == 2) {
      ++arms;
    } else {
      ASSERT_EQ(points.size(), 3u);
      corners.insert(as_array(points[1]));
    }
  }
  EXPECT_EQ(arms, 5u);
  EXPECT_EQ(corners, (std::set<std::array<float, 3>>{{0, 0, 0}, {7, 0, 0}, {0, 7, 0}, {7, 7, 0}}));
  const auto ends = loose_ends(result.outline);
  EXPECT_EQ(ends.size(), 6u);
  for (const auto& [point, count] : ends)
    EXPECT_EQ(count, 3);
  for (const std::array<float, 3> middle :
       {std::array{3.5f, 0.f, 0.f}, {3.5f, 7.f, 0.f}, {0.f, 3.5f, 0.f}, {7.f, 3.5f, 0.f}}) {
    EXPECT_TRUE(ends.contains(middle));
  }
}

TEST(OutlineBuilder, ASphereInTwoHalvesGivesOneLoop) {
  const TestMesh mesh = tests::sphere(20'000);
  const auto tiles = cut(mesh, sectors_by(mesh, [](Vec3f p) { return p.z > 0.01f ? 1u : 0u; }));
  const OutlineResult result = outline_of(tiles, options_for(mesh, 0.002));
  ASSERT_EQ(result.outline.polyline_count(), 1u);
  const auto points = polyline(result.outline, 0);
  EXPECT_TRUE(is_loop(points));
  EXPECT_GT(points.size(), 10u);
  EXPECT_LT(points.size(), 200u);  // a line through the triangles has about 400
  for (const Vec3f p : points)
    EXPECT_LT(std::abs(p.z), 0.04f);
  EXPECT_NEAR(length_of(points), 2 * 3.14159, 0.1);
}

TEST(OutlineBuilder, ALoopKeepsAtLeastATriangle) {
  const TestMesh mesh = tests::sphere(2000);
  const auto tiles = cut(mesh, sectors_by(mesh, [](Vec3f p) { return p.z > 0.9f ? 1u : 0u; }));
  const OutlineResult result = outline_of(tiles, options_for(mesh, 10));
  ASSERT_EQ(result.outline.polyline_count(), 1u);
  const auto points = polyline(result.outline, 0);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_TRUE(is_loop(points));
  EXPECT_NE(points[1], points[2]);
}

TEST(OutlineBuilder, OpenMeshesShowTheirOwnBorders) {
  const TestMesh band = tests::moebius(1000);
  const std::vector<std::uint32_t> one(band.positions.size(), 0);
  const OutlineResult border = outline_of(cut(band, one), unlimited(options_for(band, 1e-9)));
  ASSERT_EQ(border.outline.polyline_count(), 1u);
  EXPECT_TRUE(is_loop(polyline(border.outline, 0)));
  EXPECT_EQ(border.outline.vertices.size(), tests::boundary_edges(band.triangles).size() + 1);

  const TestMesh sheets = tests::non_manifold(600);
  const std::vector<std::uint32_t> alone(sheets.positions.size(), 0);
  const OutlineResult result = outline_of(cut(sheets, alone), options_for(sheets, 0.001));
  EXPECT_EQ(result.outline.polyline_count(), 5u);  // three sheets that share two points, two cones
  EXPECT_EQ(loose_ends(result.outline).at({-1, 0, 0}), 3);
  EXPECT_EQ(loose_ends(result.outline).at({1, 0, 0}), 3);
}

TEST(OutlineBuilder, TheMeshesOwnBorderIsTheSameInAnySectors) {
  const TestMesh mesh = tests::open_grid(30, 20);
  for (const std::uint32_t count : {2u, 9u, 40u}) {
    std::vector<std::uint32_t> sectors;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      sectors.push_back(static_cast<std::uint32_t>(v * count / mesh.positions.size()));
    }
    const OutlineResult result = outline_of(cut(mesh, sectors), unlimited(options_for(mesh, 1e-9)));
    double length_on_border = 0;
    for (std::size_t i = 0; i < result.outline.polyline_count(); ++i) {
      const auto points = polyline(result.outline, i);
      for (std::size_t j = 1; j < points.size(); ++j) {
        const Vec3f a = points[j - 1], b = points[j];
        const bool on_x = a.x == b.x && (a.x == 0 || a.x == 30);
        const bool on_y = a.y == b.y && (a.y == 0 || a.y == 20);
        if (on_x || on_y)
          length_on_border += length(to_double(b) - to_double(a));
      }
    }
    EXPECT_DOUBLE_EQ(length_on_border, 100) << count << " sectors";
  }
}

TEST(OutlineBuilder, OnAClosedSurfaceNoLineEndsLoose) {
  const TestMesh mesh = tests::sphere(20'000, 0.002f);
  const auto tiles = cut(mesh, sectors_by(mesh, nearest_of(30)));
  const OutlineResult result = outline_of(tiles, options_for(mesh, 0.002));
  EXPECT_GT(result.outline.polyline_count(), 60u);
  for (const auto& [point, count] : loose_ends(result.outline))
    EXPECT_GE(count, 2);
  std::size_t junctions = 0;
  for (const auto& [point, count] : loose_ends(result.outline))
    junctions += count >= 3 ? 1 : 0;
  EXPECT_GT(junctions, 40u);  // 2 (30 - 2) for cells that meet in threes
}

/// Each vertex in the sector that its place names.
Sectors sectors_of(const std::vector<TileMesh>& tiles,
                   const std::function<std::uint32_t(Vec3f)>& sector_at) {
  Sectors sectors;
  for (const TileMesh& tile : tiles) {
    auto& parts = sectors.emplace_back();
    for (std::uint32_t v = 0; v < tile.own_count; ++v)
      parts.push_back(static_cast<std::uint16_t>(sector_at(tile.vertices.positions[v])));
  }
  return sectors;
}

OutlineResult outline_of(const std::vector<TileMesh>& tiles, const Sectors& sectors,
                         const OutlineOptions& options) {
  OutlineBuilder builder;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    builder.add({static_cast<std::uint32_t>(i), tiles[i], sectors});
  return finished(builder, options);
}

double total_length(const Outline& outline) {
  double sum = 0;
  for (std::size_t i = 0; i < outline.polyline_count(); ++i)
    sum += length_of(polyline(outline, i));
  return sum;
}

TEST(OutlineBuilder, SectorsAreTheSameWhetherTheyAreTilesOrPartsOfThem) {
  for (const TestMesh& mesh : {tests::sphere(5000, 0.01f), tests::open_grid(30, 30, 0.01f)}) {
    const auto sector_at = nearest_of(20);
    const OutlineOptions options = unlimited(options_for(mesh, 1e-9));
    const OutlineResult tiles = outline_of(cut(mesh, sectors_by(mesh, sector_at)), options);
    const std::vector<TileMesh> one = cut(mesh, std::vector<std::uint32_t>(mesh.positions.size()));
    const OutlineResult parts = outline_of(one, sectors_of(one, sector_at), options);
    EXPECT_EQ(parts.polylines_found, tiles.polylines_found);
    EXPECT_NEAR(total_length(parts.outline), total_length(tiles.outline), 1e-3);
    // Tiles by one rule, sectors in them by another: lines of both.
    const auto half_at = [](Vec3f p) { return p.x > 0.3F ? 1U : 0U; };
    const std::vector<TileMesh> halves = cut(mesh, sectors_by(mesh, half_at));
    const OutlineResult both = outline_of(halves, sectors_of(halves, sector_at), options);
    const OutlineResult fine = outline_of(
        cut(mesh, sectors_by(mesh, [&](Vec3f p) { return 20 * half_at(p) + sector_at(p); })),
        options);
    EXPECT_EQ(both.polylines_found, fine.polylines_found);
    EXPECT_NEAR(total_length(both.outline), total_length(fine.outline), 1e-3);
  }
}

TEST(OutlineBuilder, CreasesAreLinesAndBendsAreNot) {
  // A roof: two sheets of 6 x 3 that meet at the ridge.
  const auto ridge_of = [](float height) {
    TestMesh mesh = tests::open_grid(6, 6);
    for (Vec3f& p : mesh.positions)
      p.z = p.x <= 3 ? height * p.x : height * (6 - p.x);
    return mesh;
  };
  const auto found = [&](const TestMesh& mesh) {
    const auto tiles = cut(mesh, std::vector<std::uint32_t>(mesh.positions.size()));
    return outline_of(tiles, unlimited(options_for(mesh, 1e-9))).outline;
  };
  EXPECT_EQ(found(ridge_of(0.2F)).polyline_count(), 1U) << "the border alone";
  EXPECT_EQ(found(ridge_of(1)).polyline_count(), 2U);
}

TEST(OutlineBuilder, TheOrderOfSectorsDoesNotMatter) {
  for (const TestMesh& mesh : {tests::sphere(5000, 0.01f), tests::moebius(5000, 0.005f),
                               tests::duplicates(3000, 0.01f), tests::soup(300)}) {
    const auto tiles = cut(mesh, sectors_by(mesh, nearest_of(17)));
    const OutlineOptions options = options_for(mesh, 0.001);
    const OutlineResult forward = outline_of(tiles, options);
    EXPECT_GT(forward.outline.polyline_count(), 10u);
    for (const std::size_t step : {16u, 5u, 3u}) {  // 16 is backwards modulo 17
      OutlineBuilder builder;
      for (std::size_t i = 0; i < 17; ++i) {
        const std::size_t index = (i + 1) * step % 17;
        if (index < tiles.size())
          builder.add({static_cast<std::uint32_t>(index), tiles[index]});
      }
      const OutlineResult other = finished(builder, options);
      EXPECT_EQ(other.outline.vertices, forward.outline.vertices);
      EXPECT_EQ(other.outline.starts, forward.outline.starts);
    }
  }
}

TEST(OutlineBuilder, RepeatedAndMirroredBorderTrianglesMakeOneLine) {
  TestMesh mesh = tests::open_grid(9, 1);
  const auto sector_at = [](Vec3f p) { return p.x > 4.5f ? 1u : 0u; };
  const OutlineOptions options = unlimited(options_for(mesh, 1e-9));
  const OutlineResult plain = outline_of(cut(mesh, sectors_by(mesh, sector_at)), options);
  // The quad of the triangles 8 and 9 crosses: 9 twice, 8 mirrored too.
  const MeshTriangle lower = mesh.triangles[8], upper = mesh.triangles[9];
  mesh.triangles.push_back(upper);
  mesh.triangles.push_back({lower[0], lower[2], lower[1]});
  const OutlineResult repeated = outline_of(cut(mesh, sectors_by(mesh, sector_at)), options);
  // The border loses an edge: one of two triangles is no border any more. The line stays.
  EXPECT_EQ(plain.outline.polyline_count(), 3u);
  EXPECT_EQ(repeated.outline.polyline_count(), 3u);
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto points = polyline(repeated.outline, i);
    if (points.front().x == 4.5f)
      longest = std::max(longest, length_of(points));
  }
  EXPECT_DOUBLE_EQ(longest, 1);  // straight across
}

/// The largest distance from a point of `fine` to the polyline `coarse`.
double deviation(std::span<const Vec3f> fine, std::span<const Vec3f> coarse) {
  double result = 0;
  for (const Vec3f p : fine) {
    double nearest = 1e30;
    for (std::size_t i = 1; i < coarse.size(); ++i) {
      nearest = std::min(nearest, distance_to_segment(to_double(p), to_double(coarse[i - 1]),
                                                      to_double(coarse[i])));
    }
    result = std::max(result, nearest);
  }
  return result;
}

TEST(OutlineBuilder, NoPointIsFartherThanTheToleranceFromItsPolyline) {
  const TestMesh mesh = tests::torus(20'000, 0.005f);
  const auto tiles = cut(mesh, sectors_by(mesh, nearest_of(25)));
  const OutlineResult full = outline_of(tiles, unlimited(options_for(mesh, 1e-12)));
  for (const double tolerance : {0.0005, 0.002, 0.01, 0.05}) {
    const OutlineOptions options = unlimited(options_for(mesh, tolerance));
    const OutlineResult result = outline_of(tiles, options);
    ASSERT_EQ(result.outline.polyline_count(), full.outline.polyline_count());
    EXPECT_LT(result.outline.vertices.size(), full.outline.vertices.size());
    for (std::size_t i = 0; i < result.outline.polyline_count(); ++i) {
      const auto fine = polyline(full.outline, i), coarse = polyline(result.outline, i);
      ASSERT_EQ(fine.front(), coarse.front());
      ASSERT_EQ(fine.back(), coarse.back());
      EXPECT_LE(deviation(fine, coarse), tolerance * options.diagonal);
    }
  }
}

TEST(OutlineBuilder, TheToleranceDoublesUntilTheFileFits) {
  const TestMesh mesh = tests::torus(50'000, 0.001f);
  const auto tiles = cut(mesh, sectors_by(mesh, nearest_of(25)));
  OutlineOptions options = options_for(mesh, 1.0 / 4096);
  const OutlineResult full = outline_of(tiles, unlimited(options));
  options.max_bytes = bytes_of(full.outline) / 3;
  const OutlineResult result = outline_of(tiles, options);
  EXPECT_LE(bytes_of(result.outline), options.max_bytes);
  EXPECT_EQ(result.polylines_dropped, 0u);
  EXPECT_GT(result.tolerance, options.tolerance);
  const double doublings = std::log2(result.tolerance / options.tolerance);
  EXPECT_EQ(doublings, std::round(doublings));
  options.tolerance = result.tolerance / 2;  // no more than necessary
  EXPECT_GT(bytes_of(outline_of(tiles, unlimited(options)).outline), options.max_bytes);
}

/// A grid with a large hole, and far from it a hole of one triangle in every fourth cell.
TestMesh sieve(std::size_t side) {
  TestMesh mesh = tests::open_grid(side, side);
  std::vector<MeshTriangle> kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::size_t x = i / 2 % side, y = i / 2 / side;
    const bool large = x >= 20 && x < 40 && y >= 20 && y < 40;
    const bool far = (x < 16 || x > 44) && x + 1 < side && y + 1 < side;
    const bool small = far && x % 2 == 1 && y % 2 == 1 && i % 2 == 0;
    if (!large && !small)
      kept.push_back(mesh.triangles[i]);
  }
  mesh.triangles = kept;
  return mesh;
}

TEST(OutlineBuilder, ThousandsOfLoopsFitTheBudgetAndTheLongestStay) {
  const TestMesh mesh = sieve(200);
  const std::vector<std::uint32_t> one(mesh.positions.size(), 0);
  const OutlineOptions options = options_for(mesh, 0.0005);
  const OutlineResult full = outline_of(cut(mesh, one), unlimited(options));
  EXPECT_GT(full.polylines_found, 5000u);
  const OutlineResult result = outline_of(cut(mesh, one), options);
  EXPECT_LE(bytes_of(result.outline), options.max_bytes);
  EXPECT_GT(bytes_of(result.outline), options.max_bytes - 100);  // no room left for one loop more
  EXPECT_EQ(result.polylines_found, full.polylines_found);
  EXPECT_EQ(result.polylines_dropped, result.polylines_found - result.outline.polyline_count());
  EXPECT_GT(result.polylines_dropped, 4000u);
  // Holes are 1.2 % of the diagonal around: specks for 0.004, not for half of it.
  EXPECT_DOUBLE_EQ(result.tolerance, 0.004);
  double outer = 0, hole = 0;  // the two long loops are there, with all their corners
  for (std::size_t i = 0; i < result.outline.polyline_count(); ++i) {
    const double around = length_of(polyline(result.outline, i));
    if (around > outer)
      std::swap(hole, outer), outer = around;
    else
      hole = std::max(hole, around);
  }
  EXPECT_DOUBLE_EQ(outer, 800);
  EXPECT_DOUBLE_EQ(hole, 80);
}

/// A cube of eight vertices: its edges are what one draws of it, wherever its sectors meet.
TEST(OutlineBuilder, EdgesOfACubeAreLinesWhateverItsSectors) {
  TestMesh mesh;
  for (int v = 0; v < 8; ++v)
    mesh.positions.push_back(
        {static_cast<float>(v & 1), static_cast<float>(v >> 1 & 1), static_cast<float>(v >> 2)});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto tiles = cut(mesh, std::vector<std::uint32_t>(8, 0));
  OutlineBuilder builder;
  builder.add({0, tiles[0], {{0, 1, 2, 3, 4, 5, 6, 7}}});
  const OutlineResult result = finished(builder, unlimited(options_for(mesh, 0.001)));
  ASSERT_EQ(result.outline.form_lines, 12u);
  for (std::size_t i = result.outline.polyline_count() - 12; i < result.outline.polyline_count();
       ++i)
    EXPECT_EQ(length_of(polyline(result.outline, i)), 1);
}

CrestLine line_over_the_grid(float x, float wave) {
  CrestLine line;
  for (int i = 0; i <= 200; ++i)
    line.points.push_back({x + (i % 2 == 0 ? wave : -wave), static_cast<float>(i), 1});
  line.strength = 1;
  return line;
}

TEST(OutlineBuilder, LinesOfTheFormComeLastInTheFileAndFirstIntoIt) {
  const TestMesh mesh = sieve(200);
  const auto tiles = cut(mesh, std::vector<std::uint32_t>(mesh.positions.size(), 0));
  const OutlineOptions options = options_for(mesh, 0.0005);
  const auto with = [&](std::vector<CrestLine> crests) {
    OutlineBuilder builder;
    builder.add({0, tiles[0]});
    builder.add(std::move(crests));
    return finished(builder, options);
  };
  const OutlineResult some = with({line_over_the_grid(50, 1), {{{0, 0, 1}, {1, 0, 1}}, 9}});
  ASSERT_EQ(some.outline.form_lines, 1u) << "the other one is short";
  const auto last = polyline(some.outline, some.outline.polyline_count() - 1);
  EXPECT_EQ(last.size(), 201u) << "the tolerance of the others is larger";
  EXPECT_GT(some.tolerance, options.tolerance);
  EXPECT_LE(bytes_of(some.outline), options.max_bytes);

  std::vector<CrestLine> many;
  for (int i = 0; i < 100; ++i)
    many.push_back(line_over_the_grid(static_cast<float>(i), 1));
  const OutlineResult full = with(std::move(many));
  EXPECT_GE(full.outline.form_lines, 3u);
  std::size_t vertices = 0;
  for (std::size_t i = full.outline.polyline_count() - full.outline.form_lines;
       i < full.outline.polyline_count(); ++i)
    vertices += polyline(full.outline, i).size();
  EXPECT_LE(16 * vertices, options.max_bytes / 2);
  EXPECT_GT(full.outline.polyline_count(), full.outline.form_lines + 2);
}

TEST(OutlineBuilder, AGhostOfAMissingSectorIsRefused) {
  const TestMesh mesh = tests::open_grid(5, 5);
  const auto tiles = cut(mesh, sectors_by(mesh, [](Vec3f p) { return p.x > 2.5f ? 1u : 0u; }));
  OutlineBuilder builder;
  builder.add({0, tiles[0]});
  EXPECT_THROW(finished(builder, options_for(mesh, 0.001)), Error);
}

TEST(OutlineBuilder, ABudgetForNothingDropsAll) {
  const TestMesh mesh = tests::open_grid(5, 5);
  OutlineOptions options = options_for(mesh, 0.001);
  options.max_bytes = 1001;
  const OutlineResult result =
      outline_of(cut(mesh, std::vector<std::uint32_t>(mesh.positions.size(), 0)), options);
  EXPECT_EQ(result.outline.polyline_count(), 0u);
  EXPECT_EQ(result.polylines_dropped, 1u);
  EXPECT_EQ(result.tolerance, kCoarsestTolerance);
  EXPECT_TRUE(result.outline.vertices.empty());
}

}  // namespace
}  // namespace meshhier::outline
