// Triangles, surfaces of cuts, samples on them and distances to them, each against the plain way.
#include "compare/surface_distance.h"

#include "base/error.h"
#include "compare/cut_surface.h"
#include "compare/surface_rays.h"
#include "compare/surface_samples.h"
#include "compare/tile_trees.h"
#include "compare/triangle_search.h"
#include "export/random_cut.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::comparing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Where two triangles are equally near, which of them was asked decides the last bits.
constexpr double kRounding = 1e-14;

Vec3d noise_point(std::uint64_t index, std::uint64_t stream) {
  return {tests::hash_noise(index, 3 * stream), tests::hash_noise(index, 3 * stream + 1),
          tests::hash_noise(index, 3 * stream + 2)};
}

/// Triangles in [-1, 1]^3 of edges up to `size`; every fifth has no area.
std::vector<SurfaceTriangle> scattered(std::size_t count, double size) {
  std::vector<SurfaceTriangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d a = noise_point(i, 1);
    const Vec3d b = a + noise_point(i, 2) * size, c = a + noise_point(i, 3) * size;
    triangles.push_back({to_float(a), to_float(b), to_float(i % 5 == 4 ? b : c)});
  }
  return triangles;
}

double brute_force(Vec3d point, const std::vector<SurfaceTriangle>& triangles) {
  double least = kInfinity;
  for (const SurfaceTriangle& triangle : triangles)
    least = std::min(least, squared_distance(point, triangle));
  return least;
}

// ---- one triangle

TEST(TriangleDistanceTest, IsThatToTheNearestPartOfTheTriangle) {
  const SurfaceTriangle triangle{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 3}, triangle), 9);    // above the inside
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 0}, triangle), 0);    // on it
  EXPECT_DOUBLE_EQ(squared_distance({2, -3, 4}, triangle), 25);  // an edge
  EXPECT_DOUBLE_EQ(squared_distance({-2, 1, 0}, triangle), 4);   // another
  EXPECT_DOUBLE_EQ(squared_distance({4, 4, 0}, triangle), 8);    // the long one
  EXPECT_DOUBLE_EQ(squared_distance({-1, -1, 1}, triangle), 3);  // a corner
  EXPECT_DOUBLE_EQ(squared_distance({6, -1, -2}, triangle), 9);  // another
  EXPECT_DOUBLE_EQ(squared_distance({-1, 6, 2}, triangle), 9);   // the third
}

TEST(TriangleDistanceTest, WithoutAreaItIsThatToTheSegmentOrPoint) {
  const SurfaceTriangle needle{{{0, 0, 0}, {4, 0, 0}, {1, 0, 0}}};
  EXPECT_DOUBLE_EQ(squared_distance({3, 1, 0}, needle), 1);
  EXPECT_DOUBLE_EQ(squared_distance({5, 0, 2}, needle), 5);
  const SurfaceTriangle bent_back{{{1, 0, 0}, {0, 0, 0}, {4, 0, 0}}};
  EXPECT_DOUBLE_EQ(squared_distance({3, 1, 0}, bent_back), 1);
  const SurfaceTriangle speck{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 3}, speck), 4);
}

TEST(TriangleDistanceTest, NoPointOfTheTriangleIsNearer) {
  constexpr int kSteps = 120;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const SurfaceTriangle triangle{
        {to_float(noise_point(i, 11)), to_float(noise_point(i, 12)), to_float(noise_point(i, 13))}};
    const Vec3d a = to_double(triangle[0]), b = to_double(triangle[1]), c = to_double(triangle[2]);
    const Vec3d point = noise_point(i, 14) * 2;
    double least = kInfinity;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        const Vec3d on =
            a + (b - a) * (double{1} / kSteps * u) + (c - a) * (double{1} / kSteps * v);
        least = std::min(least, length(point - on));
      }
    }
    const double step = (length(b - a) + length(c - a)) / kSteps;
    const double distance = std::sqrt(squared_distance(point, triangle));
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - step);
  }
}

TEST(TriangleDistanceTest, SliversAreAsGoodAsTheirLongEdge) {
  const SurfaceTriangle sliver{{{0, 0, 0}, {1, 1e-7F, 0}, {0.5F, 1e-7F, 0}}};
  EXPECT_GT(doubled_area(sliver), 0);
  EXPECT_NEAR(std::sqrt(squared_distance({0.25, 2, 1}, sliver)), std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(std::sqrt(squared_distance({0.25, -2, 1}, sliver)), std::sqrt(5.0), 1e-6);
}

TEST(TriangleDistanceTest, OfPointsOfANeedleIsRounding) {
  const SurfaceTriangle needle{{{2, 4, 0.58F}, {3, 5, -0.204F}, {84800, 61400, 58400}}};
  const auto at = [&](std::size_t k) { return to_double(needle[k % 3]); };
  for (std::size_t k = 0; k < 3; ++k) {
    const SurfaceTriangle turned{{needle[k], needle[(k + 1) % 3], needle[(k + 2) % 3]}};
    for (const double along : {0.1, 0.5, 0.9}) {
      const Vec3d between = (at(0) + at(1)) * 0.5;
      const Vec3d point = between * (1 - along) + at(2) * along;
      EXPECT_LE(std::sqrt(squared_distance(point, turned)), 1e-9) << k << ", " << along;
    }
  }
}

// ---- many

TEST(TriangleSearchTest, FindsWhatTryingAllFinds) {
  const auto triangles = scattered(700, 0.2);
  const TriangleSearch search(triangles);
  EXPECT_EQ(search.size(), triangles.size());
  std::uint32_t chained = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3d point = noise_point(i, 21) * 1.5;
    const double expected = brute_force(point, triangles);
    EXPECT_EQ(search.nearest(point, kInfinity, chained), expected);
    EXPECT_EQ(squared_distance(point, triangles[chained]), expected);
    std::uint32_t bad_hint = static_cast<std::uint32_t>(i % triangles.size());
    EXPECT_EQ(search.nearest(point, kInfinity, bad_hint), expected);
  }
}

TEST(TriangleSearchTest, FarFromTheOriginFindsWhatTryingAllFinds) {
  const Vec3d there{1e6, -3e5, 7e4};  // where the points are in no float
  std::vector<SurfaceTriangle> triangles = scattered(700, 0.2);
  for (SurfaceTriangle& triangle : triangles) {
    for (Vec3f& corner : triangle)
      corner = to_float(to_double(corner) + there);
  }
  const TriangleSearch search(triangles);
  std::uint32_t chained = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3d point = noise_point(i, 21) * 1.5 + there;
    EXPECT_EQ(search.nearest(point, kInfinity, chained), brute_force(point, triangles));
  }
}

TEST(TriangleSearchTest, OfAnySizeAndHoweverFarItFindsWhatTryingAllFinds) {
  for (const double size : {1e-19, 1.0, 1e21}) {
    std::vector<SurfaceTriangle> triangles = scattered(300, 0.2);
    for (SurfaceTriangle& triangle : triangles) {
      for (Vec3f& corner : triangle)
        corner = to_float(to_double(corner) * size);
    }
    const TriangleSearch search(triangles);
    std::uint32_t chained = 0;
    for (const double away : {0.0, 200.0, 5e6}) {
      for (std::uint64_t i = 0; i < 50; ++i) {
        const Vec3d point = (noise_point(i, 21) * 1.5 + Vec3d{away, away, -away}) * size;
        EXPECT_EQ(search.nearest(point, kInfinity, chained), brute_force(point, triangles));
      }
    }
  }
}

TEST(TriangleSearchTest, HoweverFarTheFirstOfNearestTrianglesIsThatOfTryingAll) {
  std::vector<SurfaceTriangle> triangles = scattered(300, 0.2);
  triangles.insert(triangles.end(), triangles.begin(), triangles.begin() + 100);
  const TriangleSearch search(triangles);
  for (const double away : {0.0, 200.0, 300.0, 5e4, 5e6, 1e9, 1e12, 1e15, 1e20}) {
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Vec3d point = noise_point(i, 21) * (1.5 + away) + Vec3d{away, 0, 0};
      NearTriangle expected;
      for (std::uint32_t k = 0; k < triangles.size(); ++k) {
        if (const double squared = squared_distance(point, triangles[k]);
            squared < expected.squared)
          expected = {squared, k};
      }
      const auto hint = static_cast<std::uint32_t>(i % triangles.size());
      const NearTriangle found = search.first_nearest(point, kInfinity, hint);
      ASSERT_EQ(found.squared, expected.squared) << away;
      ASSERT_EQ(found.triangle, expected.triangle) << away;
    }
  }
}

TEST(TriangleSearchTest, FromFarAwayRoundingIsLessThanATriangle) {
  for (const double distance : {1.0, 100.0, 1e3, 1e6, 1e9})
    EXPECT_LT(with_rounding(distance * distance, 1), (distance + 1e-3) * (distance + 1e-3))
        << distance;
}

TEST(TriangleSearchTest, NeverExceedsTheLimit) {
  const TriangleSearch search(scattered(50, 0.1));
  std::uint32_t hint = 7;
  EXPECT_EQ(search.nearest({9, 9, 9}, 4, hint), 4);
  EXPECT_EQ(hint, 7U);
}

TEST(TriangleSearchTest, OneTriangleOrNoneIsFine) {
  std::uint32_t hint = 0;
  EXPECT_EQ(TriangleSearch({}).nearest({0, 0, 0}, 5, hint), 5);
  const SurfaceTriangle one{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  EXPECT_DOUBLE_EQ(TriangleSearch({one}).nearest({0, 0, 0}, 5, hint), 1);
  EXPECT_DOUBLE_EQ(TriangleSearch({one, one}).nearest({0, 0, 0}, 5, hint), 1);
}

// ---- surfaces of cuts

/// A hierarchy on disk, as its reader sees it.
class SurfaceTest : public testing::Test {
 protected:
  void write(const tests::TestMesh& mesh, const tests::SampleOptions& options = {}) {
    sample_ = std::make_unique<tests::Sample>(tests::make_sample(mesh, options));
    const auto path = directory_.path() / "mesh.hier";
    std::filesystem::remove_all(path);
    tests::write_sample(*files_, path, *sample_);
    reader_ = std::make_unique<storage::HierarchyReader>(*files_, path);
  }

  CutSurface surface_of(Cut cut, std::uint64_t cache_bytes = 1 << 20) {
    execution::NoProgress progress;
    return {*reader_, std::move(cut), cache_bytes, progress, execution::CancelToken()};
  }
  CutSurface original() { return surface_of(Cut::of_level(tree(), tree().depth())); }
  const Tree& tree() const { return reader_->tree(); }

  static std::vector<SurfaceTriangle> all_triangles(const CutSurface& surface) {
    std::vector<SurfaceTriangle> all;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const TileSurface tile = surface.load(i);
      all.insert(all.end(), tile.triangles.begin(), tile.triangles.end());
    }
    return all;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::unique_ptr<tests::Sample> sample_;
  std::unique_ptr<storage::HierarchyReader> reader_;
};

using Numbers = std::vector<std::array<float, 9>>;

/// The triangle's coordinates, turned so that the least comes first.
std::array<float, 9> numbers_of(const SurfaceTriangle& t) {
  std::array<float, 9> least{};
  for (std::size_t turn = 0; turn < 3; ++turn) {
    std::array<float, 9> now{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3f p = t[(i + turn) % 3];
      now[3 * i] = p.x;
      now[3 * i + 1] = p.y;
      now[3 * i + 2] = p.z;
    }
    if (turn == 0 || now < least)
      least = now;
  }
  return least;
}

Numbers sorted_numbers(const std::vector<SurfaceTriangle>& triangles) {
  Numbers numbers;
  for (const SurfaceTriangle& t : triangles)
    numbers.push_back(numbers_of(t));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

/// Returns the triangles that a cut must show: the image of every original triangle under the
/// sample's maps, duplicates once unless they are the input's own.
std::vector<SurfaceTriangle> image_of(tests::Sample& sample, const Cut& cut) {
  using Key = std::array<std::pair<std::size_t, std::uint32_t>, 3>;  // node in the cut, vertex
  std::set<Key> seen;
  std::vector<SurfaceTriangle> image;
  for (const tests::MeshTriangle& t : sample.ranked.triangles) {
    Key key{};
    SurfaceTriangle corners{};
    bool original = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t position = cut.position_of(sample.tree.partition_of(t[i]));
      const NodeId node = cut[position];
      const std::uint32_t vertex = sample.local[raw(node.level)][t[i]];
      key[i] = {position, vertex};
      corners[i] = sample.tile(node).mesh.vertices.positions[vertex];
      original = original && sample.tree.is_partition(node);
    }
    if (key[0] == key[1] || key[1] == key[2] || key[2] == key[0])
      continue;
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    if (original || seen.insert(key).second)
      image.push_back(corners);
  }
  return image;
}

TEST_F(SurfaceTest, EveryCutShowsTheImageOfTheOriginalOnce) {
  for (const auto& mesh : {tests::sphere(1500), tests::duplicates(1000), tests::moebius(900)}) {
    write(mesh, {7, 25, false, false, {}});
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const CutSurface surface =
          surface_of(exporting::random_cut(tree(), seed), seed % 2 == 0 ? 0 : 1 << 20);
      const auto expected = image_of(*sample_, surface.cut());
      EXPECT_EQ(surface.total().triangles, expected.size());
      EXPECT_EQ(sorted_numbers(all_triangles(surface)), sorted_numbers(expected));
    }
  }
}

TEST_F(SurfaceTest, FactsAreThoseOfTheTriangles) {
  write(tests::open_grid(12, 9), {5, 20, false, false, {}});
  const CutSurface surface = original();
  EXPECT_NEAR(surface.total().area, 12 * 9, 1e-9);
  EXPECT_EQ(surface.total().triangles, 2U * 12 * 9);
  EXPECT_EQ(surface.total().bounds, (Bounds{{0, 0, 0}, {12, 9, 0}}));
  EXPECT_EQ(surface.total().flat, 0U);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    Bounds bounds;
    for (const SurfaceTriangle& t : surface.load(i).triangles) {
      for (Vec3f corner : t)
        bounds.add(corner);
    }
    EXPECT_EQ(surface.facts(i).bounds, bounds);
  }
}

TEST_F(SurfaceTest, BorderTrianglesNameTheTilesTheyTouch) {
  write(tests::torus(1200), {6, 30, false, false, {}});
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const CutSurface surface = surface_of(exporting::random_cut(tree(), seed));
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const TileSurface tile = surface.load(i);
      ASSERT_EQ(tile.facts.interior_count + tile.touched.size(), tile.triangles.size());
      for (std::size_t t = 0; t < tile.touched.size(); ++t) {
        EXPECT_THAT(tile.touched[t], testing::Contains(i));
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const NodeId node = surface.cut()[tile.touched[t][corner]];
          const TileMesh& mesh = sample_->tile(node).mesh;
          const auto own = std::span(mesh.vertices.positions).first(mesh.own_count);
          EXPECT_THAT(own,
                      testing::Contains(tile.triangles[tile.facts.interior_count + t][corner]));
        }
      }
    }
  }
}

// ---- samples

TEST_F(SurfaceTest, SamplesAreAsManyAsAskedAndOnTheirTriangles) {
  write(tests::sphere(900, 0.02F), {5, 30, false, false, {}});
  const CutSurface surface = original();
  for (std::uint64_t count : {1, 2, 999, 20000}) {
    const SurfaceSampler sampler(surface, count, 1);
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const SampleRange range = sampler.on_tile(i);
      EXPECT_EQ(range.begin, next);
      next = range.end;
      const TileSurface tile = surface.load(i);
      const auto samples = sampler.draw(i, tile, range);
      ASSERT_EQ(samples.size(), range.size());
      for (const SurfaceSample& sample : samples)
        EXPECT_LT(squared_distance(sample.point, tile.triangles[sample.triangle]), 1e-28);
    }
    EXPECT_EQ(next, count);
  }
}

TEST_F(SurfaceTest, EveryTriangleHasItsShareOfTheSamples) {
  write(tests::non_manifold(800, 0.01F), {5, 30, false, false, {}});
  const CutSurface surface = original();
  constexpr std::uint64_t kCount = 5000;
  const SurfaceSampler sampler(surface, kCount, 3);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TileSurface tile = surface.load(i);
    std::vector<double> found(tile.triangles.size());
    for (const SurfaceSample& sample : sampler.draw(i, tile, sampler.on_tile(i)))
      found[sample.triangle] += 1;
    for (std::size_t t = 0; t < found.size(); ++t) {
      const double area = doubled_area(tile.triangles[t]) / 2;
      EXPECT_NEAR(found[t], area / surface.total().area * kCount, 2);
    }
  }
}

TEST_F(SurfaceTest, PartsOfATilesSamplesAreThoseOfTheWhole) {
  write(tests::sphere(500), {2, 30, false, false, {}});
  const CutSurface surface = original();
  const SurfaceSampler sampler(surface, 3000, 1);
  const TileSurface tile = surface.load(1);
  const SampleRange all = sampler.on_tile(1);
  const std::uint64_t middle = all.begin + all.size() / 3;
  auto parts = sampler.draw(1, tile, {all.begin, middle});
  const auto rest = sampler.draw(1, tile, {middle, all.end});
  parts.insert(parts.end(), rest.begin(), rest.end());
  const auto whole = sampler.draw(1, tile, all);
  ASSERT_EQ(parts.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(parts[i].point, whole[i].point);
    EXPECT_EQ(parts[i].triangle, whole[i].triangle);
  }
}

TEST_F(SurfaceTest, SamplesFillATriangleEvenly) {
  tests::TestMesh mesh;
  mesh.positions = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}};
  mesh.triangles = {{0, 1, 2}};
  write(mesh, {1, 3, false, false, {}});
  const CutSurface surface = original();
  const SurfaceSampler sampler(surface, 30000, 1);
  Vec3d sum;
  std::size_t in_corner = 0;  // the corner triangle of half the size: a quarter of the area
  for (const SurfaceSample& sample : sampler.draw(0, surface.load(0), sampler.on_tile(0))) {
    sum = sum + sample.point;
    in_corner += sample.point.x + sample.point.y < 1.5 ? 1 : 0;
  }
  EXPECT_NEAR(sum.x / 30000, 1, 0.02);
  EXPECT_NEAR(sum.y / 30000, 1, 0.02);
  EXPECT_NEAR(static_cast<double>(in_corner) / 30000, 0.25, 0.01);
}

TEST_F(SurfaceTest, WithoutAreaThereAreNoSamples) {
  tests::TestMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  write(mesh, {1, 3, false, false, {}});
  const CutSurface surface = original();
  EXPECT_EQ(surface.total().flat, 1U);
  const SurfaceSampler sampler(surface, 1000, 1);
  EXPECT_EQ(sampler.count(), 0U);
  EXPECT_EQ(sampler.on_tile(0).size(), 0U);
}

TEST(CurveOrderTest, IsAPermutationThatKeepsNeighboursTogether) {
  std::vector<Vec3d> points;
  for (std::uint64_t i = 0; i < 4000; ++i)
    points.push_back(noise_point(i, 31));
  const auto order = curve_order(points);
  ASSERT_EQ(order.size(), points.size());
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), points.size());
  double along = 0, as_given = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    along += length(points[order[i]] - points[order[i - 1]]);
    as_given += length(points[i] - points[i - 1]);
  }
  EXPECT_LT(along, as_given / 5);
  EXPECT_THAT(curve_order({}), testing::IsEmpty());
  EXPECT_THAT(curve_order({{1, 1, 1}, {1, 1, 1}}), testing::ElementsAre(0, 1));
}

// ---- distances

TEST(BoxDistanceTest, IsZeroInsideAndToTheNearestFaceEdgeOrCornerElse) {
  const Bounds box{{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(squared_distance({0.5, 1, 1}, box), 0);
  EXPECT_EQ(squared_distance({3, 1, 1}, box), 4);
  EXPECT_EQ(squared_distance({-1, 3, 1}, box), 2);
  EXPECT_EQ(squared_distance({2, 3, 5}, box), 6);
}

std::vector<Vec3d> points_around(const CutSurface& surface) {
  std::vector<Vec3d> points;
  for (std::uint64_t i = 0; i < 400; ++i)
    points.push_back(noise_point(i, 41) * (i % 4 == 0 ? 5.0 : 1.1));
  const SurfaceSampler sampler(surface, 400, 5);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    for (const SurfaceSample& sample : sampler.draw(i, surface.load(i), sampler.on_tile(i)))
      points.push_back(sample.point);
  }
  return points;
}

TEST_F(SurfaceTest, DistancesAreExactForEveryCutAndCache) {
  write(tests::torus(3000, 0.02F), {13, 40, false, false, {}});
  const auto points = points_around(original());
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const CutSurface surface = surface_of(exporting::random_cut(tree(), seed));
    const auto triangles = all_triangles(surface);
    std::vector<double> expected;
    for (Vec3d point : points)
      expected.push_back(std::sqrt(brute_force(point, triangles)));
    SurfaceDistance poor(surface, 0), rich(surface, 1 << 24);
    const auto distances = poor.distances(points, execution::CancelToken());
    EXPECT_THAT(distances, testing::Pointwise(testing::DoubleNear(kRounding), expected));
    EXPECT_EQ(rich.distances(points, execution::CancelToken()), distances);
    EXPECT_EQ(rich.distances(points, execution::CancelToken()), distances) << "from the cache";
  }
}

/// What trying all triangles finds: the least number, and its first triangle.
template <class Found, class Measure>
Found first_of_all(const CutSurface& surface, Found best, const Measure& measure) {
  for (std::uint32_t tile = 0; tile < surface.size(); ++tile) {
    const TileSurface triangles = surface.load(tile);
    for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i)
      measure(triangles.triangles[i], tile, i, best);
  }
  return best;
}

NearestOnSurface first_nearest_of_all(const CutSurface& surface, Vec3d point) {
  return first_of_all(surface, NearestOnSurface{},
                      [&](const SurfaceTriangle& triangle, std::uint32_t tile, std::uint32_t i,
                          NearestOnSurface& best) {
                        const double squared = squared_distance(point, triangle);
                        if (squared < best.squared)
                          best = {squared, tile, i};
                      });
}

HitOnSurface first_hit_of_all(const CutSurface& surface, const Ray& ray) {
  return first_of_all(surface, HitOnSurface{},
                      [&](const SurfaceTriangle& triangle, std::uint32_t tile, std::uint32_t i,
                          HitOnSurface& best) {
                        const auto hit = ray.hit(triangle[0], triangle[1], triangle[2]);
                        if (hit && *hit < best.distance)
                          best = {*hit, tile, i};
                      });
}

/// Meshes with many equally near triangles: at corners, in duplicates, in a grid.
std::vector<tests::TestMesh> meshes_with_ties() {
  return {tests::torus(700, 0.02F), tests::duplicates(600), tests::open_grid(15, 15),
          tests::non_manifold(500), tests::soup(300)};
}

TEST_F(SurfaceTest, TheFirstOfNearestTrianglesIsThatOfTryingAll) {
  for (const tests::TestMesh& mesh : meshes_with_ties()) {
    write(mesh, {7, 40, false, false, {}});
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const CutSurface surface = surface_of(exporting::random_cut(tree(), seed));
      auto points = points_around(surface);
      for (const Vec3f corner : mesh.positions)
        points.push_back(to_double(corner));
      SurfaceDistance search(surface, seed == 0 ? 0 : 1 << 22);
      const auto found = search.nearest(points, execution::CancelToken(), Ties::first);
      std::ranges::reverse(points);
      const auto reversed = search.nearest(points, execution::CancelToken(), Ties::first);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const NearestOnSurface expected = first_nearest_of_all(surface, points[i]);
        for (const NearestOnSurface& one : {reversed[i], found[points.size() - 1 - i]}) {
          ASSERT_EQ(one.squared, expected.squared);
          ASSERT_EQ(std::pair(one.tile, one.triangle), std::pair(expected.tile, expected.triangle));
        }
      }
    }
  }
}

TEST_F(SurfaceTest, TheFirstHitOfARayIsThatOfTryingAll) {
  for (const tests::TestMesh& mesh : meshes_with_ties()) {
    write(mesh, {7, 40, false, false, {}});
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const CutSurface surface = surface_of(exporting::random_cut(tree(), seed));
      std::vector<Ray> rays;
      for (const Vec3d target : points_around(surface)) {
        const Vec3d from = noise_point(rays.size(), 51) * 4, way = target - from;
        rays.push_back({from, way * (1 / length(way))});
      }
      for (const Vec3f corner : mesh.positions)
        rays.push_back({to_double(corner) + Vec3d{0, 0, 3}, {0, 0, -1}});
      TreeCache trees(surface, seed == 0 ? 0 : 1 << 22);
      std::vector<ShownTriangle> shown(rays.size());
      const auto found =
          SurfaceRays(surface, trees)
              .first_hits(
                  rays,
                  [&](std::size_t ray, const ShownTriangle& triangle) { shown[ray] = triangle; },
                  execution::CancelToken());
      std::size_t hits = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const HitOnSurface expected = first_hit_of_all(surface, rays[i]);
        ASSERT_EQ(found[i].distance, expected.distance);
        ASSERT_EQ(std::pair(found[i].tile, found[i].triangle),
                  std::pair(expected.tile, expected.triangle));
        hits += expected.is_there() ? 1 : 0;
        if (expected.is_there()) {
          ASSERT_EQ(shown[i].tile, expected.tile);
          ASSERT_EQ(shown[i].corners, surface.load(expected.tile).triangles[expected.triangle]);
        }
      }
      EXPECT_GT(hits, 20U);
    }
  }
}

TEST_F(SurfaceTest, TrianglesAreNamedByTheirNumbersInTheTile) {
  write(tests::torus(900), {6, 30, false, false, {}});
  const CutSurface surface = original();
  TreeCache trees(surface, 1 << 20);
  for (std::uint32_t tile = 0; tile < surface.size(); ++tile) {
    const TileMesh& mesh = sample_->tile(surface.cut()[tile]).mesh;
    const auto tree = trees.get(std::array{tile}).front();
    for (std::uint32_t i = 0; i < tree->search.size(); ++i) {
      const ShownTriangle shown = tree->shown(tile, i);
      const std::size_t number = shown.number_in_tile;
      ASSERT_LT(number, mesh.interior.size() + mesh.border.size());
      const TileTriangle& triangle = number < mesh.interior.size()
                                         ? mesh.interior[number]
                                         : mesh.border[number - mesh.interior.size()];
      for (std::size_t corner = 0; corner < 3; ++corner)
        EXPECT_EQ(shown.corners[corner], mesh.vertices.positions[raw(triangle[corner])]);
    }
  }
}

TEST_F(SurfaceTest, TilesThatInterlockAreSearchedAll) {
  // Scattered merging makes all boxes alike: the likely tile is wrong as often as right.
  write(tests::sphere(2000), {9, 60, true, false, {}});
  const CutSurface surface = surface_of(Cut::of_level(tree(), static_cast<Level>(2)));
  const auto points = points_around(original());
  const auto triangles = all_triangles(surface);
  SurfaceDistance search(surface, 1 << 16);
  const auto distances = search.distances(points, execution::CancelToken());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(distances[i], std::sqrt(brute_force(points[i], triangles)), kRounding);
}

TEST_F(SurfaceTest, WithoutTrianglesEverythingIsInfinitelyFar) {
  write(tests::points(50), {3, 10, false, false, {}});
  const CutSurface surface = original();
  SurfaceDistance search(surface, 1 << 16);
  EXPECT_THAT(search.distances(std::vector<Vec3d>{{0, 0, 0}, {1, 1, 1}}, execution::CancelToken()),
              testing::Each(kInfinity));
  EXPECT_THAT(search.distances({}, execution::CancelToken()), testing::IsEmpty());
}

TEST_F(SurfaceTest, PartsWithoutTrianglesAreNoHindrance) {
  tests::TestMesh mesh = tests::open_grid(4, 4);
  for (int i = 0; i < 60; ++i)
    mesh.positions.push_back({10 + static_cast<float>(i), 0, 0});  // far, in no triangle
  write(mesh, {8, 10, false, false, {}});
  const CutSurface surface = original();
  SurfaceDistance search(surface, 1 << 16);
  const std::vector<Vec3d> points{{2, 2, 1.5}, {40, 0, 0}};
  EXPECT_THAT(search.distances(points, execution::CancelToken()), testing::ElementsAre(1.5, 36));
}

TEST_F(SurfaceTest, StopsWhenAsked) {
  write(tests::sphere(500));
  const CutSurface surface = original();
  SurfaceDistance search(surface, 1 << 16);
  execution::CancelToken cancel;
  cancel.cancel();
  EXPECT_THROW(search.distances(std::vector<Vec3d>{{0, 0, 0}}, cancel), Error);
}

}  // namespace
}  // namespace meshhier::comparing
