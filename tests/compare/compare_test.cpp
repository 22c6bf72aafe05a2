// Distances of one surface to another: each against all triangles, sides against winding numbers.
#include "compare/compare.h"

#include "base/error.h"
#include "compare/cut_surface.h"
#include "compare/farthest_bound.h"
#include "compare/surface_distance.h"
#include "compare/surface_samples.h"
#include "compare/surface_sides.h"
#include "mesh_io/mesh_source.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::comparing {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kRounding = 1e-12;

std::vector<SurfaceTriangle> all_triangles(const CutSurface& surface) {
  std::vector<SurfaceTriangle> all;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TileSurface tile = surface.load(i);
    all.insert(all.end(), tile.triangles.begin(), tile.triangles.end());
  }
  return all;
}

double least_distance(Vec3d point, const std::vector<SurfaceTriangle>& triangles) {
  double least = std::numeric_limits<double>::infinity();
  for (const SurfaceTriangle& triangle : triangles)
    least = std::min(least, squared_distance(point, triangle));
  return std::sqrt(least);
}

/// How often a closed surface goes around a point (van Oosterom & Strackee 1983).
double winding_number(Vec3d point, const std::vector<SurfaceTriangle>& triangles) {
  double sum = 0;
  for (const SurfaceTriangle& t : triangles) {
    const Vec3d a = to_double(t[0]) - point, b = to_double(t[1]) - point,
                c = to_double(t[2]) - point;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)),
                          la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

tests::TestMesh moved(tests::TestMesh mesh, double scale, Vec3d by) {
  for (Vec3f& p : mesh.positions)
    p = to_float(to_double(p) * scale + by);
  return mesh;
}

class CompareTest : public testing::Test {
 protected:
  fs::path write(const std::string& name, const tests::TestMesh& mesh,
                 const tests::SampleOptions& options = {}) {
    tests::Sample sample = tests::make_sample(mesh, options);
    const fs::path path = directory_.path() / name;
    tests::write_sample(*files_, path, sample);
    return path;
  }

  SurfaceComparison compare(const fs::path& from, const fs::path& to,
                            const CompareOptions& options = {}) {
    execution::NoProgress progress;
    return compare_surfaces({*files_, from}, {*files_, to}, *files_, options, progress,
                            execution::CancelToken());
  }

  CutSurface original(const fs::path& path) {
    readers_.push_back(std::make_unique<storage::HierarchyReader>(*files_, path));
    const storage::HierarchyReader& reader = *readers_.back();
    return {reader, Cut::of_level(reader.tree(), reader.tree().depth()), 1 << 20};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::vector<std::unique_ptr<storage::HierarchyReader>> readers_;
};

std::vector<Vec3d> points_near(const CutSurface& surface, double size) {
  std::vector<Vec3d> points;
  const SurfaceSampler sampler(surface, 600, 9);
  std::uint64_t k = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TileSurface tile = surface.load(i);
    for (const SurfaceSample& sample : sampler.draw(i, tile, sampler.on_tile(i))) {
      ++k;
      points.push_back(
          sample.point +
          Vec3d{tests::hash_noise(k, 1), tests::hash_noise(k, 2), tests::hash_noise(k, 3)} * size);
    }
    // Nearest to vertices and edges.
    for (std::size_t t = 0; t < tile.triangles.size(); t += 5) {
      const Vec3d corner = to_double(tile.triangles[t][0]);
      points.push_back(corner * 1.01);
      points.push_back(corner * 0.99);
    }
  }
  return points;
}

TEST_F(CompareTest, SidesOfClosedSurfacesAreThoseOfWindingNumbers) {
  int name = 0;
  for (const tests::TestMesh& mesh : {tests::sphere(1500, 0.01F), tests::torus(1500, 0.01F),
                                      tests::genus_n(3, 2000), tests::nested_shells(1500)}) {
    SCOPED_TRACE(name);
    const fs::path path = write(std::to_string(name++), mesh, {.partitions = 9});
    const CutSurface surface = original(path);
    const auto triangles = all_triangles(surface);
    const std::vector<Vec3d> points = points_near(surface, 0.05);
    SurfaceDistance search(surface, 1 << 16);
    const auto nearest = search.nearest(points, execution::CancelToken());
    const auto sides =
        surface_sides(surface, search.trees(), points, nearest, execution::CancelToken());
    std::size_t known = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double turns = winding_number(points[i], triangles);
      if (std::abs(turns - std::round(turns)) > 1e-6 || nearest[i].squared < 1e-18)
        continue;
      ++known;
      EXPECT_EQ(sides[i], std::lround(turns) % 2 != 0 ? Side::inside : Side::outside)
          << i << ": " << turns;
    }
    EXPECT_GT(known, points.size() * 9 / 10);
  }
}

TEST_F(CompareTest, BordersHaveNoSideAndOthersThatOfTheirNormals) {
  const fs::path path = write("grid", tests::open_grid(9, 9), {.partitions = 6});
  const CutSurface surface = original(path);
  SurfaceDistance search(surface, 1 << 16);
  const Bounds box = surface.total().bounds;
  const double x = (box.min.x + box.max.x) / 2, y = (box.min.y + box.max.y) / 2;
  const std::vector<Vec3d> points{{x, y, 0.3},
                                  {x, y, -0.3},
                                  {4, 4, 1},
                                  {4, 4, -1},
                                  {box.max.x + 1.0, y, 0.3},
                                  {-1, -1, -1},
                                  {2, 2, 0},
                                  {x, box.max.y + 1.0, 0}};
  const auto sides =
      surface_sides(surface, search.trees(), points,
                    search.nearest(points, execution::CancelToken()), execution::CancelToken());
  const SurfaceTriangle first = surface.load(0).triangles.front();
  const bool faces_up =
      cross(to_double(first[1]) - to_double(first[0]), to_double(first[2]) - to_double(first[0]))
          .z > 0;
  const Side above = faces_up ? Side::outside : Side::inside;
  const Side below = faces_up ? Side::inside : Side::outside;
  EXPECT_THAT(sides, testing::ElementsAre(above, below, above, below, Side::unknown, Side::unknown,
                                          Side::outside, Side::unknown));
}

TEST_F(CompareTest, DistancesAreThoseToAllTriangles) {
  const tests::TestMesh mesh = tests::torus(3000, 0.03F);
  const fs::path to = write("to", mesh, {.partitions = 11, .origin = {100, -5, 2}});
  const fs::path from = write("from", moved(tests::torus(1700, 0.04F), 1.02, {0.01, 0.02, -0.01}),
                              {.partitions = 5, .origin = {100, -5, 2}});
  const CutSurface target = original(to), source = original(from);
  const auto triangles = all_triangles(target);
  double farthest = 0, largest = -1e9, least = 1e9;
  std::size_t vertices = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const PlacedTile tile = source.load_placed(i);
    vertices += tile.own_count;
    for (std::uint32_t v = 0; v < tile.own_count; ++v) {
      const Vec3d p = to_double(tile.places[v]);
      const double distance = least_distance(p, triangles);
      const double given = std::abs(winding_number(p, triangles)) > 0.5 ? -distance : distance;
      farthest = std::max(farthest, distance);
      largest = std::max(largest, given);
      least = std::min(least, given);
    }
  }
  const SurfaceComparison result = compare(from, to);
  EXPECT_EQ(result.from.vertices, vertices);
  EXPECT_NEAR(result.farthest, farthest, kRounding);
  EXPECT_NEAR(result.distances.largest(), largest, kRounding);
  EXPECT_NEAR(result.distances.least(), least, kRounding);
  EXPECT_EQ(result.unknown_sides, 0U);
  EXPECT_NEAR(
      result.distances.weight(),
      [&] {
        double area = 0;
        for (const SurfaceTriangle& t : all_triangles(source))
          area += doubled_area(t) / 2;
        return area;
      }(),
      1e-4);
  EXPECT_THAT(result.warnings, IsEmpty());

  // Nor is any point between the vertices farther than is said.
  const SurfaceSampler sampler(source, 500, 3);
  double sampled = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    for (const SurfaceSample& s : sampler.draw(i, source.load(i), sampler.on_tile(i)))
      sampled = std::max(sampled, least_distance(s.point, triangles));
  }
  EXPECT_LE(sampled, result.no_farther_than);
  const SurfaceComparison bounded = compare(from, to, {.bounds_triangles = true});
  EXPECT_LE(sampled, bounded.no_farther_than);
  EXPECT_LE(bounded.no_farther_than, 1.02 * std::max(sampled, farthest));
}

TEST_F(CompareTest, ASurfaceIsAtItself) {
  const fs::path path = write("a", tests::sphere(2000, 0.1F));
  const SurfaceComparison result = compare(path, path, {.tolerance = 0.0});
  EXPECT_EQ(result.farthest, 0);
  EXPECT_TRUE(result.is_within());
  EXPECT_EQ(result.distances.weight_within(), result.distances.weight());
  const SurfaceComparison bounded = compare(path, path, {.bounds_triangles = true});
  EXPECT_EQ(bounded.farthest, 0);
  EXPECT_LT(bounded.no_farther_than, 1e-6);
}

TEST_F(CompareTest, ATransformMovesTheFirst) {
  const tests::TestMesh mesh = tests::sphere(2000, 0.1F);
  const fs::path a = write("a", mesh);
  const fs::path b = write("b", moved(mesh, 2, {10, 0, 0}));
  const SurfaceComparison apart = compare(a, b);
  EXPECT_GT(apart.farthest, 5);
  EXPECT_THAT(apart.warnings, testing::Contains(HasSubstr("--transform")));
  const SurfaceComparison result =
      compare(a, b, {.transform = parse_transform("2 0 0 10\n0 2 0 0\n0 0 2 0\n0 0 0 1\n", "t")});
  EXPECT_LT(result.farthest, 1e-5);
  EXPECT_THAT(result.warnings, IsEmpty());
  EXPECT_THROW(
      compare(a, b, {.transform = parse_transform("1e99 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "t")}),
      Error);
}

TEST(TransformTest, IsSixteenNumbersOfAnAffineMap) {
  const PlaceTransform expected{1, 0, 0, 5, 0, 1, 0, -6.5, 0, 0, 1, 7, 0, 0, 0, 1};
  EXPECT_EQ(parse_transform("[[1,0,0,5],[0,1,0,-6.5],[0,0,1,7],[0,0,0,1]]", "t"), expected);
  for (const char* text :
       {"", "1 2 3", "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1 1", "1 0 0 nan 0 1 0 6 0 0 1 7 0 0 0 1",
        "1 0 0 x 0 1 0 6 0 0 1 7 0 0 0 1", "1 0 0 5 0 1 0 6 0 0 1 7 0 0 1 1"}) {
    EXPECT_THROW(parse_transform(text, "t"), Error) << text;
  }
}

TEST(TransformTest, AMarkOfUtf8IsNoNumber) {
  EXPECT_EQ(parse_transform("\xef\xbb\xbf"
                            "1 0 0 0\r\n0 1 0 0\r\n0 0 1 0.5\r\n0 0 0 1\r\n",
                            "t"),
            (PlaceTransform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 1}));
}

TEST(TransformTest, LeavesAVolume) {
  for (const char* flat : {"0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1",
                           "1 2 3 0 2 4 6 0 0 0 1 0 0 0 0 1", "1 2 3 0 4 5 6 0 7 8 9 0 0 0 0 1"}) {
    try {
      parse_transform(flat, "t.txt");
      ADD_FAILURE() << flat;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_THAT(error.what(), HasSubstr("t.txt: expected 16 numbers"));
      EXPECT_THAT(error.what(), HasSubstr("makes all flat"));
    }
  }
  for (const char* small :
       {"1e-30 0 0 0 0 1e-30 0 0 0 0 1e-30 0 0 0 0 1", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
        "1e-9 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"})
    EXPECT_NO_THROW(parse_transform(small, "t")) << small;
}

TEST_F(CompareTest, TolerancesSayHowMuchIsWithin) {
  tests::TestMesh flat = tests::open_grid(20, 20), dented = flat;
  for (Vec3f& p : dented.positions)
    p.z += p.x > 10 ? 0.5F : 0.0F;
  const fs::path a = write("a", dented), b = write("b", flat);
  const SurfaceComparison result = compare(a, b, {.tolerance = 0.1});
  EXPECT_FALSE(result.is_within());
  EXPECT_EQ(result.farthest, 0.5);
  const double part = result.distances.weight_within() / result.distances.weight();
  EXPECT_GT(part, 0.4);
  EXPECT_LT(part, 0.6);
  EXPECT_TRUE(compare(a, b, {.tolerance = 0.5}).is_within());
  EXPECT_TRUE(compare(a, b).is_within()) << "without one";
  EXPECT_THROW(compare(a, b, {.tolerance = -1.0}), Error);
  EXPECT_THROW(compare(a, b, {.tolerance = 1.0, .tolerance_unit = Unit::mm}), Error)
      << "the hierarchy does not know its unit";
  const std::string text = comparison_text(result);
  EXPECT_THAT(text, HasSubstr("NOT within the tolerance of 0.1"));
  EXPECT_FALSE(comparison_json(result).at("within").get<bool>());
}

TEST_F(CompareTest, LevelsAndErrorsAreCoarserWithTheirBounds) {
  const fs::path a = write("a", tests::torus(3000)), b = write("b", tests::torus(2900, 0.01F));
  const SurfaceComparison whole = compare(a, b);
  const SurfaceComparison level = compare(a, b, {.selection = static_cast<Level>(1)});
  EXPECT_LT(level.from.vertices, whole.from.vertices);
  EXPECT_GE(level.no_farther_than, whole.farthest);
  EXPECT_LT(level.to.tiles, whole.to.tiles);
  const SurfaceComparison deepest = compare(a, b, {.selection = exporting::LargestError{0}});
  EXPECT_EQ(deepest.farthest, whole.farthest);
  EXPECT_THROW(compare(a, b, {.selection = static_cast<Level>(30)}), Error);
}

TEST_F(CompareTest, OnlyTilesNearbyAreRead) {
  const fs::path to = write("to", tests::open_grid(60, 30), {.partitions = 40});
  tests::TestMesh corner = tests::open_grid(4, 4);
  for (Vec3f& p : corner.positions)
    p.z += 0.25F;
  const SurfaceComparison result = compare(write("from", corner, {.partitions = 2}), to);
  EXPECT_EQ(result.farthest, 0.25);
  EXPECT_LT(result.tiles_read, result.to.tiles / 3);
}

TEST_F(CompareTest, VerticesOfNoTriangleAreNoSurface) {
  tests::TestMesh mesh = tests::open_grid(6, 6);
  mesh.positions.push_back({100, 0, 0});
  const fs::path path = write("a", mesh);
  const SurfaceComparison result = compare(path, path, {.tolerance = 0.0});
  EXPECT_EQ(result.lone_vertices, 1U);
  EXPECT_EQ(result.farthest, 0);
  EXPECT_TRUE(result.is_within());
}

TEST_F(CompareTest, VerticesOfTrianglesWithoutAreaCountAsOthersDo) {
  tests::TestMesh mesh = tests::open_grid(6, 6);
  const fs::path to = write("to", mesh);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  const SurfaceComparison result =
      compare(write("from", mesh), to, {.is_signed = false, .tolerance = 1.0});
  EXPECT_EQ(result.lone_vertices, 0U);
  EXPECT_EQ(result.farthest, 2);
  EXPECT_EQ(result.distances.largest(), 2);
  EXPECT_EQ(result.distances.least(), 0);
  EXPECT_EQ(result.distances.mean(), 0) << "they have no area";
  EXPECT_FALSE(result.is_within());
}

TEST_F(CompareTest, PointsAndSurfacesWithoutTriangles) {
  const fs::path cloud = write("cloud", tests::points(50), {3, 10, false, false, {}});
  const fs::path ball = write("ball", tests::sphere(500));
  const SurfaceComparison result = compare(cloud, ball);
  EXPECT_EQ(result.distances.weight(), 50) << "each weighs the same";
  try {
    compare(ball, cloud);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
  }
}

TEST_F(CompareTest, ResultsDependOnNeitherThreadsNorMemory) {
  const fs::path a = write("a", tests::torus(3000, 0.05F), {.partitions = 12});
  const fs::path b = write("b", tests::torus(2500, 0.05F), {.partitions = 9});
  const auto expected = comparison_json(compare(a, b)).dump();
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(comparison_json(compare(a, b, {.memory_budget = 1})).dump(), expected);
  }
}

TEST_F(CompareTest, ThePlyHasTheDistances) {
  const tests::TestMesh mesh = tests::torus(1500, 0.03F);
  const fs::path to = write("to", mesh);
  const fs::path from = write("from", moved(mesh, 1.1, {}), {.origin = {1000, 0, 0}});
  const fs::path ply = directory_.path() / "difference.ply";
  const CompareOptions options{
      .transform = parse_transform("1 0 0 -1000 0 1 0 0 0 0 1 0 0 0 0 1", "t"), .output = ply};
  const SurfaceComparison result = compare(from, to, options);
  EXPECT_THROW(compare(from, to, options), Error) << "it is there";
  const auto source = mesh_io::open_mesh(*files_, ply);
  EXPECT_EQ(source->description().vertex_count, result.from.vertices);
  EXPECT_EQ(source->read_triangles([](auto) {}).triangles, result.from.triangles);

  const std::string bytes = [&] {
    const auto read = storage::read_file(*files_, ply, 1 << 24);
    return std::string(reinterpret_cast<const char*>(read.data()), read.size());
  }();
  EXPECT_THAT(bytes, HasSubstr("property double x\nproperty double y\nproperty double z\n"
                               "property float distance\nelement face"));
  const std::size_t data = bytes.find("end_header\n") + 11;
  const auto triangles = all_triangles(original(to));
  for (std::size_t v = 0; v < result.from.vertices; v += 7) {
    std::array<double, 3> p{};
    float distance = 0;
    std::memcpy(p.data(), bytes.data() + data + v * 28, 24);
    std::memcpy(&distance, bytes.data() + data + v * 28 + 24, 4);
    const Vec3d at{p[0] - 1000, p[1], p[2]};
    EXPECT_NEAR(std::abs(distance), least_distance(at, triangles), 1e-6);
    EXPECT_EQ(distance<0, std::abs(winding_number(at, triangles))> 0.5);
  }
}

/// The farthest point from scattered ones is seldom a corner.
TEST(FarthestBoundTest, IsHardlyAboveTheFarthestPoint) {
  std::vector<Vec3d> targets;
  for (std::uint64_t i = 0; i < 40; ++i)
    targets.push_back({tests::hash_noise(i, 1), tests::hash_noise(i, 2), 0});
  const auto distance = [&](Vec3d point) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3d target : targets)
      least = std::min(least, length(point - target));
    return least;
  };
  FarthestBound bound;
  double farthest = 0;
  std::size_t measured = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    std::array<Vec3d, 3> corners;
    for (std::uint64_t k = 0; k < 3; ++k)
      corners[k] = {tests::hash_noise(3 * i + k, 3), tests::hash_noise(3 * i + k, 4),
                    0.2 * tests::hash_noise(3 * i + k, 5)};
    bound.add(corners, {distance(corners[0]), distance(corners[1]), distance(corners[2])});
    constexpr int kSteps = 60;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        farthest = std::max(farthest, distance(corners[0] + (corners[1] - corners[0]) * (u / 60.0) +
                                               (corners[2] - corners[0]) * (v / 60.0)));
      }
    }
  }
  const double result = bound.refine([&](std::span<const Vec3d> points) {
    measured += points.size();
    std::vector<double> distances;
    for (const Vec3d point : points)
      distances.push_back(distance(point));
    return distances;
  });
  EXPECT_GE(result, farthest);
  EXPECT_LE(result, 1.02 * farthest);
  EXPECT_LT(measured, 40'000U);
}

TEST(FarthestBoundTest, EndsWhereNothingIsFarAndCountsPointsWithoutTriangles) {
  FarthestBound bound;
  EXPECT_EQ(bound.refine([](auto) { return std::vector<double>(); }), 0);
  bound.add(0.75);
  EXPECT_EQ(bound.refine([](auto) { return std::vector<double>(); }), 0.75);
  FarthestBound same;
  for (int i = 0; i < 1000; ++i)
    same.add({Vec3d{0.0 + i, 0, 0}, Vec3d{1.0 + i, 0, 0}, Vec3d{0.0 + i, 1, 0}}, {0, 0, 0});
  std::size_t measured = 0;
  const double result = same.refine([&](std::span<const Vec3d> points) {
    measured += points.size();
    return std::vector<double>(points.size());
  });
  EXPECT_LE(measured, 400'000U);
  EXPECT_LT(result, 0.25);
}

TEST(DistanceTallyTest, QuantilesAreThoseOfSortedDistances) {
  DistanceTally tally(0.5);
  std::vector<double> sorted;
  for (std::uint64_t i = 0; i < 4001; ++i) {
    const double distance = std::pow(static_cast<double>(tests::hash_noise(i, 1)), 3);
    sorted.push_back(distance);
    tally.add(distance, 2);
  }
  std::ranges::sort(sorted);
  for (const double part : {0.001, 0.01, 0.25, 0.5, 0.75, 0.99, 1.0}) {
    const double expected =
        sorted[static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size()))) - 1];
    EXPECT_NEAR(tally.quantile(part), expected, std::abs(expected) / 2048 + 1e-30) << part;
  }
  std::vector<double> sizes;
  for (const double distance : sorted)
    sizes.push_back(std::abs(distance));
  std::ranges::sort(sizes);
  EXPECT_NEAR(tally.size_quantile(0.5), sizes[2000], sizes[2000] / 2048);
  EXPECT_EQ(tally.least(), sorted.front());
  EXPECT_EQ(tally.farthest(), sizes.back());
  EXPECT_EQ(tally.weight_within(), 2 * static_cast<double>(std::ranges::count_if(
                                           sizes, [](double s) { return s <= 0.5; })));
  const std::vector<double> histogram = tally.histogram(-0.1, 0.1, 10);
  EXPECT_THAT(histogram, SizeIs(10));
  EXPECT_EQ(std::accumulate(histogram.begin(), histogram.end(), 0.0), tally.weight());
  EXPECT_TRUE(DistanceTally({}).empty());
}

}  // namespace
}  // namespace meshhier::comparing
