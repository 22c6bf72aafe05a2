#include "cluster_simplify/deviation.h"

#include "cluster_simplify/contraction.h"
#include "hierarchy/bounds.h"
#include "hierarchy/error.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using Triangles = std::vector<Triangle>;

Triangle triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {TileVertex{a}, TileVertex{b}, TileVertex{c}};
}

/// A contraction of a mesh without context.
struct Pair {
  std::vector<Vec3f> fine, coarse;
  Triangles fine_triangles, coarse_triangles;
  std::vector<std::uint32_t> coarse_of;
  std::vector<float> weights;

  DeviationInput input() const {
    return {.fine = {fine, static_cast<std::uint32_t>(fine.size()), fine_triangles, {}},
            .coarse = {coarse, static_cast<std::uint32_t>(coarse.size()), coarse_triangles, {}},
            .coarse_of = coarse_of,
            .weights = weights};
  }
  /// The coarse triangles as a contraction makes them; every vertex weighs 1.
  void complete() {
    coarse_triangles.clear();
    for (const Triangle& t : fine_triangles) {
      coarse_triangles.push_back(
          triangle(coarse_of[raw(t[0])], coarse_of[raw(t[1])], coarse_of[raw(t[2])]));
    }
    normalize_triangles(coarse_triangles, true);
    weights.assign(fine.size(), 1);
  }
};

Deviation measure(const Pair& pair) {
  return DeviationMeter().measure(pair.input());
}

Pair contracted(const tests::TestMesh& mesh, std::uint32_t target, Method method) {
  BuildTile tile = tests::tile_of(mesh);
  normalize_triangles(tile.mesh.interior, true);
  ContractionOptions options;
  options.method = method;
  const Contraction contraction = contract(tile, target, {}, options);
  Pair pair;
  pair.fine = mesh.positions;
  pair.fine_triangles = tile.mesh.interior;
  pair.coarse = contraction.representatives.positions;
  pair.coarse_of = contraction.parent_of;
  pair.complete();
  return pair;
}

// ---- what the bound is compared with: plain search, textbook formulas ------------------------

double distance_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d ab = b - a;
  const double square = dot(ab, ab);
  const double t = square > 0 ? std::clamp(dot(p - a, ab) / square, 0.0, 1.0) : 0.0;
  return length(p - a - ab * t);
}

double distance_to_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const double edges = std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
  const Vec3d n = cross(b - a, c - a);
  const double square = dot(n, n);
  if (!(square > 0))
    return edges;
  const auto left_of = [&](Vec3d from, Vec3d to) {
    return dot(cross(to - from, p - from), n) >= 0;
  };
  if (!left_of(a, b) || !left_of(b, c) || !left_of(c, a))
    return edges;
  return std::min(edges, std::abs(dot(p - a, n)) / std::sqrt(square));
}

/// Triangles in a tree of boxes.
class Sheet {
 public:
  using Corners = std::array<Vec3d, 3>;
  std::vector<Corners> triangles;

  Sheet(const std::vector<Vec3f>& positions, const Triangles& list) {
    for (const Triangle& t : list) {
      triangles.push_back({to_double(positions[raw(t[0])]), to_double(positions[raw(t[1])]),
                           to_double(positions[raw(t[2])])});
    }
    sorted_ = triangles;
    boxes_.resize(2 * sorted_.size() + 1);
    if (!sorted_.empty())
      build(0, 0, sorted_.size());
  }
  double distance(Vec3d p) const {
    double least = std::numeric_limits<double>::infinity();
    if (!sorted_.empty())
      search(p, 0, 0, sorted_.size(), least);
    return least;
  }

 private:
  // A node's left child follows it; the right one follows the left one's 2 n - 1 nodes.
  void build(std::size_t node, std::size_t begin, std::size_t end) {
    BoundsD& box = boxes_[node];
    for (std::size_t i = begin; i < end; ++i) {
      for (const Vec3d& p : sorted_[i])
        box.add(p);
    }
    if (end - begin == 1)
      return;
    const Vec3d size = box.max - box.min;
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t i) { return sorted_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](const Corners& a, const Corners& b) {
      return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
    });
    build(node + 1, begin, middle);
    build(node + 2 * (middle - begin), middle, end);
  }
  static double distance_to_box(Vec3d p, const BoundsD& box) {
    const auto beyond = [](double x, double low, double high) {
      return std::max({low - x, x - high, 0.0});
    };
    return length(Vec3d{beyond(p.x, box.min.x, box.max.x), beyond(p.y, box.min.y, box.max.y),
                        beyond(p.z, box.min.z, box.max.z)});
  }
  void search(Vec3d p, std::size_t node, std::size_t begin, std::size_t end, double& least) const {
    if (distance_to_box(p, boxes_[node]) >= least)
      return;
    if (end - begin == 1) {
      least = std::min(
          least, distance_to_triangle(p, sorted_[begin][0], sorted_[begin][1], sorted_[begin][2]));
      return;
    }
    const std::size_t middle = (begin + end) / 2;
    const std::size_t left = node + 1;
    const std::size_t right = node + 2 * (middle - begin);
    const bool left_first = distance_to_box(p, boxes_[left]) <= distance_to_box(p, boxes_[right]);
    if (left_first)
      search(p, left, begin, middle, least);
    search(p, right, middle, end, least);
    if (!left_first)
      search(p, left, begin, middle, least);
  }

  std::vector<Corners> sorted_;
  std::vector<BoundsD> boxes_;
};

/// Calls `visit` with points of a triangle and the corner each is nearest to.
void for_each_sample(const std::array<Vec3d, 3>& t, int steps,
                     const std::function<void(Vec3d, std::size_t)>& visit) {
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const std::array<int, 3> part{steps - i - j, i, j};
      const Vec3d p = (t[0] * part[0] + t[1] * part[1] + t[2] * part[2]) * (1.0 / steps);
      visit(p, static_cast<std::size_t>(std::ranges::max_element(part) - part.begin()));
    }
  }
}

double sampled(const Sheet& from, const Sheet& to, int steps) {
  double most = 0;
  for (const auto& t : from.triangles)
    for_each_sample(t, steps, [&](Vec3d p, std::size_t) { most = std::max(most, to.distance(p)); });
  return most;
}

double sampled(const Pair& pair, int steps) {
  const Sheet fine(pair.fine, pair.fine_triangles);
  const Sheet coarse(pair.coarse, pair.coarse_triangles);
  return std::max(sampled(fine, coarse, steps), sampled(coarse, fine, steps));
}

double largest_motion(const Pair& pair) {
  double most = 0;
  for (std::size_t v = 0; v < pair.fine.size(); ++v) {
    most =
        std::max(most, length(to_double(pair.fine[v]) - to_double(pair.coarse[pair.coarse_of[v]])));
  }
  return most;
}

// ---- known distances ---------------------------------------------------------------------------

/// A grid with all inner vertices moved by `shift`, the same triangles.
Pair moved_grid(const std::function<Vec3f(std::uint32_t)>& shift) {
  const tests::TestMesh grid = tests::open_grid(12, 12);
  Pair pair;
  pair.fine = pair.coarse = grid.positions;
  for (std::uint32_t v = 0; v < pair.coarse.size(); ++v) {
    const Vec3f p = pair.fine[v];
    if (p.x > 0 && p.x < 12 && p.y > 0 && p.y < 12)
      pair.coarse[v] = p + shift(v);
    pair.coarse_of.push_back(v);
  }
  for (const tests::MeshTriangle& t : grid.triangles)
    pair.fine_triangles.push_back(triangle(t[0], t[1], t[2]));
  pair.complete();
  return pair;
}

TEST(DeviationTest, MotionWithinAPlaneIsNone) {
  const Pair pair = moved_grid([](std::uint32_t v) {
    return Vec3f{0.3F * tests::hash_noise(v, 1), 0.3F * tests::hash_noise(v, 2), 0};
  });
  EXPECT_GT(largest_motion(pair), 0.2);
  EXPECT_LT(measure(pair).bound, 1e-10);
}

TEST(DeviationTest, LargeTrianglesOnAPlaneAreCoveredByManySmallOnes) {
  const tests::TestMesh grid = tests::open_grid(16, 16);
  Pair pair;
  pair.fine = grid.positions;
  pair.coarse = {{0, 0, 0}, {16, 0, 0}, {0, 16, 0}, {16, 16, 0}};
  for (const Vec3f& p : pair.fine)
    pair.coarse_of.push_back((p.x < 8 ? 0 : 1) + (p.y < 8 ? 0 : 2));
  for (const tests::MeshTriangle& t : grid.triangles)
    pair.fine_triangles.push_back(triangle(t[0], t[1], t[2]));
  pair.complete();
  ASSERT_EQ(pair.coarse_triangles.size(), 2U);
  EXPECT_LT(measure(pair).bound, 1e-10);
}

TEST(DeviationTest, NothingMovedIsNothing) {
  const Pair pair = moved_grid([](std::uint32_t) { return Vec3f{}; });
  const Deviation result = measure(pair);
  EXPECT_LT(result.bound, 1e-10);
  EXPECT_EQ(result.squared_sum, 0);
  EXPECT_EQ(result.weight_sum, 169);
  EXPECT_EQ(result.collapsed_triangles, 0U);
}

/// A pyramid over the square [-1, 1]^2, its tip at height h; the tip joins a corner.
Pair pyramid(float h) {
  Pair pair;
  pair.fine = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, h}};
  pair.fine_triangles = {triangle(0, 1, 4), triangle(1, 2, 4), triangle(2, 3, 4),
                         triangle(3, 0, 4)};
  pair.coarse = {pair.fine.begin(), pair.fine.end() - 1};
  pair.coarse_of = {0, 1, 2, 3, 0};
  pair.complete();
  return pair;
}

TEST(DeviationTest, ACutOffTipIsItsHeight) {
  for (const float h : {0.125F, 0.5F, 0.875F})
    EXPECT_NEAR(measure(pyramid(h)).bound, h, 1e-9);
}

TEST(DeviationTest, TheMeanIsOverWeights) {
  Pair pair = pyramid(0.5F);
  pair.weights = {1, 2, 3, 4, 6};
  const Deviation result = measure(pair);
  EXPECT_DOUBLE_EQ(result.squared_sum, 6 * 0.25);
  EXPECT_DOUBLE_EQ(result.weight_sum, 16);
}

TEST(DeviationTest, ARaisedTipIsSeenFromTheCoarseSide) {
  Pair pair = pyramid(0);
  pair.coarse = pair.fine;
  pair.coarse.back().z = 0.5F;
  pair.coarse_of = {0, 1, 2, 3, 4};
  pair.complete();
  EXPECT_NEAR(measure(pair).bound, 0.5, 1e-9);
}

TEST(DeviationTest, HalfATriangleTwiceIsNotTheWhole) {
  // Two sheets over the same half of the coarse triangle: their areas add up to all of it.
  Pair pair;
  pair.coarse = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  for (std::uint32_t sheet = 0; sheet < 2; ++sheet) {
    pair.fine.insert(pair.fine.end(), {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}});
    pair.fine_triangles.push_back(triangle(3 * sheet, 3 * sheet + 1, 3 * sheet + 2));
    pair.coarse_of.insert(pair.coarse_of.end(), {0, 1, 2});
  }
  pair.complete();
  ASSERT_EQ(pair.coarse_triangles.size(), 1U);
  EXPECT_NEAR(measure(pair).bound, std::sqrt(2.0), 1e-9);
}

TEST(DeviationTest, AFlattenedRoofIsItsHeight) {
  constexpr std::uint32_t kLength = 6;
  Pair pair;
  for (std::uint32_t i = 0; i < kLength; ++i) {
    const auto x = static_cast<float>(i);
    pair.fine.insert(pair.fine.end(), {{x, -1, 0}, {x, 0, 0.25F}, {x, 1, 0}});
    pair.coarse.insert(pair.coarse.end(), {{x, -1, 0}, {x, 1, 0}});
    pair.coarse_of.insert(pair.coarse_of.end(), {2 * i, 2 * i, 2 * i + 1});
  }
  for (std::uint32_t v = 0; v + 3 < 3 * kLength; ++v) {
    if (v % 3 == 2)
      continue;
    pair.fine_triangles.push_back(triangle(v, v + 3, v + 4));
    pair.fine_triangles.push_back(triangle(v, v + 4, v + 1));
  }
  pair.complete();
  EXPECT_NEAR(measure(pair).bound, 0.25, 1e-9);
}

TEST(DeviationTest, AFanOfThousandsOfTrianglesIsServed) {
  constexpr std::uint32_t kRim = 5000;
  Pair pair;
  pair.fine.push_back({0, 0, 0.25F});
  for (std::uint32_t i = 0; i < kRim; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kRim;
    pair.fine.push_back(to_float({std::cos(angle), std::sin(angle), 0}));
    pair.fine_triangles.push_back(triangle(0, 1 + i, 1 + (i + 1) % kRim));
  }
  pair.coarse = pair.fine;
  pair.coarse[0].z = 0;
  for (std::uint32_t v = 0; v <= kRim; ++v)
    pair.coarse_of.push_back(v);
  pair.complete();
  EXPECT_NEAR(measure(pair).bound, 0.25, 1e-9);
}

// ---- certain: sampling never exceeds the bound -------------------------------------------------

struct Case {
  std::string name;
  tests::TestMesh mesh;
  double tightness;  ///< bound / sampled maximum at most
};

/// A grid with holes: coarse triangles span them.
tests::TestMesh holed_grid() {
  tests::TestMesh mesh = tests::open_grid(20, 20, 0.2F);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.positions[v].z = 0.2F * tests::hash_noise(v, 9);
  std::uint64_t index = 0;
  std::erase_if(mesh.triangles, [&](const auto&) { return tests::hash_noise(index++, 10) > 0.6F; });
  return mesh;
}

/// Two sheets so near each other that points are nearest to the wrong one.
tests::TestMesh close_sheets() {
  tests::TestMesh mesh = tests::open_grid(16, 16, 0.2F);
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t v = 0; v < count; ++v) {
    Vec3f p = mesh.positions[v];
    mesh.positions[v].z = 0.1F * tests::hash_noise(v, 11);
    p.z = 0.05F + 0.1F * tests::hash_noise(v, 12);
    mesh.positions.push_back(p);
  }
  for (std::size_t i = 0, n = mesh.triangles.size(); i < n; ++i) {
    const auto [a, b, c] = mesh.triangles[i];
    mesh.triangles.push_back({a + count, c + count, b + count});
  }
  return mesh;
}

std::vector<Case> cases() {
  return {{"sphere", tests::sphere(1200), 1.3},
          {"noisy_sphere", tests::sphere(1200, 0.02F), 1.5},
          {"torus", tests::torus(1200), 1.3},
          {"noisy_torus", tests::torus(1200, 0.02F), 1.5},
          {"genus", tests::genus_n(2, 1000, 0.02F), 2},
          {"shells", tests::nested_shells(1000, 0.01F), 1.5},
          {"open", tests::open_grid(20, 20, 0.3F), 10},
          {"moebius", tests::moebius(800, 0.01F), 2},
          {"non_manifold", tests::non_manifold(600, 0.01F), 10},
          {"soup", tests::soup(200), 10},
          {"duplicates", tests::duplicates(600, 0.02F), 10},
          {"holes", holed_grid(), 10},
          {"sheets", close_sheets(), 10}};
}

void expect_certain(const Case& test, Method method, std::uint32_t divisor, double tightness) {
  SCOPED_TRACE(test.name + " / " + std::to_string(divisor));
  const auto count = static_cast<std::uint32_t>(test.mesh.positions.size());
  const Pair pair = contracted(test.mesh, count / divisor, method);
  if (pair.coarse_triangles.empty())
    return;
  const Deviation result = measure(pair);
  if (result.collapsed_triangles > 0) {  // these are not drawn; from the rest they may be far
    const Sheet fine(pair.fine, pair.fine_triangles);
    const Sheet coarse(pair.coarse, pair.coarse_triangles);
    EXPECT_LE(sampled(coarse, fine, 6), result.bound);
    return;
  }
  const double found = sampled(pair, 6);
  EXPECT_LE(found, result.bound);
  EXPECT_LE(result.bound, std::max(found * tightness, 1e-10));
  EXPECT_LE(result.bound, largest_motion(pair) + 1e-10);
}

TEST(DeviationTest, SamplingNeverExceedsTheBoundOfEdgeCollapse) {
  for (const Case& test : cases())
    expect_certain(test, Method::edge_collapse, 2, test.tightness);
}

TEST(DeviationTest, SamplingNeverExceedsTheBoundOfAStrongEdgeCollapse) {
  for (const Case& test : cases())
    expect_certain(test, Method::edge_collapse, 8, 10);
}

TEST(DeviationTest, SamplingNeverExceedsTheBoundOfCluster) {
  for (const Case& test : cases()) {
    for (const std::uint32_t divisor : {2U, 5U})
      expect_certain(test, Method::cluster, divisor, 10);
  }
}

/// Neighbouring vertices joined at random and moved at random: folds, flips, spikes.
Pair random_contraction(const tests::TestMesh& mesh, std::uint64_t seed) {
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  std::vector<std::uint32_t> first(count);
  for (std::uint32_t v = 0; v < count; ++v)
    first[v] = v;
  for (const tests::MeshTriangle& t : mesh.triangles) {
    const std::uint32_t low = std::min(t[0], t[1]);
    const std::uint32_t high = std::max(t[0], t[1]);
    if (first[high] == high && first[low] == low &&
        tests::hash_noise(low * 7919 + high, seed) > 0.5F)
      first[high] = low;
  }
  Pair pair;
  pair.fine = mesh.positions;
  std::vector<std::uint32_t> place(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (first[v] == v) {
      place[v] = static_cast<std::uint32_t>(pair.coarse.size());
      const Vec3f shift{tests::hash_noise(v, seed + 1), tests::hash_noise(v, seed + 2),
                        tests::hash_noise(v, seed + 3)};
      pair.coarse.push_back(mesh.positions[v] + shift * 0.1F);
    }
    pair.coarse_of.push_back(place[first[v]]);
  }
  for (const tests::MeshTriangle& t : mesh.triangles)
    pair.fine_triangles.push_back(triangle(t[0], t[1], t[2]));
  normalize_triangles(pair.fine_triangles, true);
  pair.complete();
  return pair;
}

TEST(DeviationTest, SamplingNeverExceedsTheBoundOfRandomMaps) {
  for (const Case& test : cases()) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE(test.name + ", seed " + std::to_string(seed));
      const Pair pair = random_contraction(test.mesh, 100 * seed);
      const Deviation result = measure(pair);
      if (result.collapsed_triangles == 0) {
        EXPECT_LE(sampled(pair, 4), result.bound);
      }
      EXPECT_TRUE(std::isfinite(result.bound));
    }
  }
}

// ---- what vanishes, what is missing ------------------------------------------------------------

TEST(DeviationTest, AVanishedComponentIsCountedNotMeasured) {
  Pair pair = pyramid(0.5F);
  const auto base = static_cast<std::uint32_t>(pair.fine.size());
  for (const Vec3f& p : {Vec3f{9, 9, 9}, Vec3f{9, 10, 9}, Vec3f{9, 9, 10}, Vec3f{10, 9, 9}})
    pair.fine.push_back(p);
  pair.fine_triangles.push_back(triangle(base, base + 1, base + 2));
  pair.fine_triangles.push_back(triangle(base, base + 1, base + 3));
  pair.coarse.push_back({9, 9, 9});
  pair.coarse_of.insert(pair.coarse_of.end(), 4, 4);
  pair.complete();
  const Deviation result = measure(pair);
  EXPECT_EQ(result.collapsed_triangles, 2U);
  EXPECT_NEAR(result.bound, 0.5, 1e-9);
  EXPECT_EQ(result.weight_sum, 5);
}

TEST(DeviationTest, AnEdgeThatIsNotDrawnIsNoCover) {
  // A triangle of two images: both are drawn only as corners of the other component.
  Pair pair = pyramid(0.25F);
  const auto base = static_cast<std::uint32_t>(pair.fine.size());
  pair.fine.insert(pair.fine.end(), {{0, 0, 3}, {0.5F, 0, 3}, {0, 0.5F, 3}});
  pair.fine_triangles.push_back(triangle(base, base + 1, base + 2));
  pair.coarse_of.insert(pair.coarse_of.end(), {0, 0, 2});
  pair.complete();
  const Deviation result = measure(pair);
  EXPECT_EQ(result.collapsed_triangles, 0U);
  EXPECT_NEAR(result.bound, 3, 1e-9);
}

TEST(DeviationTest, UnusedVerticesDoNotCount) {
  Pair pair = pyramid(0.5F);
  pair.fine.push_back({0, 0, 50});
  pair.coarse_of.push_back(0);
  pair.weights.push_back(1);
  const Deviation result = measure(pair);
  EXPECT_NEAR(result.bound, 0.5, 1e-9);
  EXPECT_EQ(result.weight_sum, 5);
}

TEST(DeviationTest, NoTrianglesIsNothingToMeasure) {
  Pair pair;
  pair.fine = {{0, 0, 0}, {1, 0, 0}};
  pair.coarse = {{0.5F, 0, 0}};
  pair.coarse_of = {0, 0};
  pair.complete();
  const Deviation result = measure(pair);
  EXPECT_EQ(result.bound, 0);
  EXPECT_EQ(result.weight_sum, 0);
  EXPECT_EQ(DeviationMeter().measure({}).bound, 0);
}

TEST(DeviationTest, TrianglesWithoutAreaAreMeasured) {
  Pair pair = pyramid(0.5F);
  const auto base = static_cast<std::uint32_t>(pair.fine.size());
  pair.fine.insert(pair.fine.end(), {{-1, -1, 0}, {-1, -1, 0}, {1, -1, 0.75F}});
  pair.coarse.insert(pair.coarse.end(), {{-1, -1, 0}, {1, -1, 0}});
  pair.coarse_of.insert(pair.coarse_of.end(), {0, 4, 5});
  pair.fine_triangles.push_back(triangle(base, base + 1, base + 2));
  pair.fine_triangles.push_back(triangle(base, base, base + 2));
  pair.complete();
  const Deviation result = measure(pair);
  EXPECT_LE(sampled(pair, 20), result.bound);
  EXPECT_NEAR(result.bound, 0.75, 1e-9);
}

TEST(DeviationTest, ACoarseTriangleOutOfNowhereIsInfinitelyFar) {
  Pair pair = pyramid(0.5F);
  pair.coarse.insert(pair.coarse.end(), {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}});
  pair.coarse_triangles.push_back(triangle(4, 5, 6));
  EXPECT_EQ(measure(pair).bound, std::numeric_limits<double>::infinity());
}

TEST(DeviationTest, IndicesOutOfRangeAreRefused) {
  const auto expect_refused = [](const Pair& pair) { EXPECT_THROW(measure(pair), Error); };
  Pair pair = pyramid(0.5F);
  pair.fine_triangles.push_back(triangle(0, 1, 5));
  expect_refused(pair);
  pair = pyramid(0.5F);
  pair.coarse_triangles.push_back(triangle(0, 1, 4));
  expect_refused(pair);
  pair = pyramid(0.5F);
  pair.coarse_of[4] = 4;
  expect_refused(pair);
  pair = pyramid(0.5F);
  pair.coarse_of.pop_back();
  expect_refused(pair);
  pair = pyramid(0.5F);
  pair.weights.pop_back();
  expect_refused(pair);
}

// ---- scale and repetition ----------------------------------------------------------------------

TEST(DeviationTest, ScalesOverTheWholeRangeOfFloat) {
  const Pair pair = contracted(tests::torus(600, 0.02F), 150, Method::edge_collapse);
  const double expected = measure(pair).bound;
  for (const float scale : {1e38F, 1e30F, 1e-30F}) {
    Pair scaled = pair;
    for (auto* positions : {&scaled.fine, &scaled.coarse}) {
      for (Vec3f& p : *positions)
        p = p * scale;
    }
    const Deviation result = measure(scaled);
    EXPECT_NEAR(result.bound / static_cast<double>(scale), expected, expected * 1e-4);
    EXPECT_TRUE(std::isfinite(result.squared_sum));
  }
}

TEST(DeviationTest, TheSmallestFloatsAreServed) {
  Pair pair = contracted(tests::torus(600, 0.02F), 150, Method::edge_collapse);
  for (auto* positions : {&pair.fine, &pair.coarse}) {
    for (Vec3f& p : *positions)
      p = p * 1e-44F;  // a handful of steps remain
  }
  const Deviation result = measure(pair);
  EXPECT_LE(sampled(pair, 4), result.bound);
  EXPECT_LT(result.bound, 2e-44);
}

TEST(DeviationTest, FarFromTheOriginTheBoundStaysCertain) {
  Pair pair = contracted(tests::torus(600, 0.02F), 150, Method::edge_collapse);
  for (auto* positions : {&pair.fine, &pair.coarse}) {
    for (Vec3f& p : *positions)
      p = p + Vec3f{1e5F, -1e5F, 1e5F};
  }
  EXPECT_LE(sampled(pair, 4), measure(pair).bound);
}

TEST(DeviationTest, WhatWasMeasuredBeforeDoesNotMatter) {
  const Pair large = contracted(tests::torus(2000, 0.02F), 300, Method::edge_collapse);
  const Pair small = contracted(tests::non_manifold(300, 0.01F), 60, Method::cluster);
  DeviationMeter meter;
  const Deviation first = meter.measure(small.input());
  meter.measure(large.input());
  const Deviation second = meter.measure(small.input());
  EXPECT_EQ(first.bound, second.bound);
  EXPECT_EQ(first.squared_sum, second.squared_sum);
}

// ---- tiles -------------------------------------------------------------------------------------

/// One of two tiles: what touches vertices of its side, own vertices first.
struct Half {
  std::vector<Vec3f> fine, coarse;
  Triangles fine_triangles, coarse_triangles;
  std::uint32_t fine_own = 0, coarse_own = 0;
  std::vector<std::uint32_t> coarse_of;
  std::vector<float> weights;

  DeviationInput input(BorderShare border) const {
    return {.fine = {fine, fine_own, {}, fine_triangles},
            .coarse = {coarse, coarse_own, {}, coarse_triangles},
            .coarse_of = coarse_of,
            .weights = weights,
            .border = border};
  }
};

/// Numbers the vertices of triangles with an own corner and, `rings` of triangles around these,
/// own ones first.
std::vector<std::uint32_t> choose(const std::vector<bool>& own, const Triangles& triangles,
                                  int rings, Triangles& chosen, std::uint32_t& own_count) {
  std::vector<bool> known = own;
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<bool> before = known;
    for (const Triangle& t : triangles) {
      if (before[raw(t[0])] || before[raw(t[1])] || before[raw(t[2])])
        known[raw(t[0])] = known[raw(t[1])] = known[raw(t[2])] = true;
    }
  }
  std::vector<bool> used(own.size());
  for (const Triangle& t : triangles) {
    if (!std::ranges::any_of(t, [&](TileVertex v) { return known[raw(v)]; }))
      continue;
    chosen.push_back(t);
    for (const TileVertex v : t)
      used[raw(v)] = true;
  }
  std::vector<std::uint32_t> place(own.size(), kNone);
  std::uint32_t next = 0;
  for (const bool wanted : {true, false}) {
    for (std::size_t v = 0; v < own.size(); ++v) {
      if (own[v] == wanted && used[v])
        place[v] = next++;
    }
    if (wanted)
      own_count = next;
  }
  for (Triangle& t : chosen)
    t = triangle(place[raw(t[0])], place[raw(t[1])], place[raw(t[2])]);
  return place;
}

/// What a tile knows of its neighbour.
struct Context {
  bool images = false;  ///< of the context vertices
  int rings = 0;        ///< triangles beyond those on the border
};
constexpr std::array kContexts{Context{false, 0}, Context{true, 0}, Context{true, 1},
                               Context{true, 2}};

Half half_of(const Pair& pair, bool right, Context context) {
  // A contraction never joins vertices of two tiles: sides are chosen by representative.
  std::vector<bool> coarse_own, fine_own;
  for (const Vec3f& p : pair.coarse)
    coarse_own.push_back((p.x > 0.1F) == right);
  for (const std::uint32_t parent : pair.coarse_of)
    fine_own.push_back(coarse_own[parent]);
  Half half;
  const auto fine_place =
      choose(fine_own, pair.fine_triangles, context.rings, half.fine_triangles, half.fine_own);
  const auto coarse_place = choose(coarse_own, pair.coarse_triangles, context.rings,
                                   half.coarse_triangles, half.coarse_own);
  half.fine.resize(pair.fine.size());
  half.coarse_of.resize(pair.fine.size(), kNone);
  half.coarse.resize(pair.coarse.size());
  std::uint32_t fine_count = 0;
  for (std::size_t v = 0; v < pair.fine.size(); ++v) {
    if (fine_place[v] == kNone)
      continue;
    ++fine_count;
    half.fine[fine_place[v]] = pair.fine[v];
    if (fine_own[v] || context.images)
      half.coarse_of[fine_place[v]] = coarse_place[pair.coarse_of[v]];
  }
  for (std::size_t v = 0; v < pair.coarse.size(); ++v) {
    if (coarse_place[v] != kNone)
      half.coarse[coarse_place[v]] = pair.coarse[v];
  }
  half.fine.resize(fine_count);
  half.coarse_of.resize(fine_count);
  half.weights.assign(half.fine_own, 1);
  return half;
}

/// The largest distance of points of triangles with own corners: of all, or of what is nearest to
/// these.
double sampled_share(const std::vector<Vec3f>& positions, const Triangles& triangles,
                     std::uint32_t own_count, const Sheet& to, BorderShare border) {
  double most = 0;
  const Sheet from(positions, triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto is_own = [&](TileVertex v) { return raw(v) < own_count; };
    if (!std::ranges::any_of(triangles[i], is_own))
      continue;
    for_each_sample(from.triangles[i], 6, [&](Vec3d p, std::size_t corner) {
      if (border == BorderShare::whole || is_own(triangles[i][corner]))
        most = std::max(most, to.distance(p));
    });
  }
  return most;
}

double sampled(const Half& half, BorderShare border) {
  const Sheet fine(half.fine, half.fine_triangles);
  const Sheet coarse(half.coarse, half.coarse_triangles);
  return std::max(sampled_share(half.fine, half.fine_triangles, half.fine_own, coarse, border),
                  sampled_share(half.coarse, half.coarse_triangles, half.coarse_own, fine, border));
}

TEST(DeviationOfTilesTest, EachBoundHoldsForItsShareOfTheBorder) {
  for (const auto& mesh : {tests::torus(1500, 0.01F), tests::nested_shells(1000, 0.02F)}) {
    const Pair pair = contracted(mesh, 300, Method::edge_collapse);
    for (const BorderShare border : {BorderShare::whole, BorderShare::own_part}) {
      for (const bool right : {false, true}) {
        for (const Context context : kContexts) {
          const Half half = half_of(pair, right, context);
          const Deviation result = DeviationMeter().measure(half.input(border));
          EXPECT_LE(sampled(half, border), result.bound);
          EXPECT_EQ(result.collapsed_triangles, 0U);
        }
      }
    }
  }
}

TEST(DeviationOfTilesTest, TilesTogetherBoundTheWhole) {
  const Pair pair = contracted(tests::torus(1500, 0.01F), 300, Method::edge_collapse);
  const double found = sampled(pair, 6);
  const Deviation whole = measure(pair);
  for (const BorderShare border : {BorderShare::whole, BorderShare::own_part}) {
    for (const Context context : kContexts) {
      double bound = 0;
      double squared_sum = 0;
      for (const bool right : {false, true}) {
        const Half half = half_of(pair, right, context);
        const Deviation result = DeviationMeter().measure(half.input(border));
        bound = std::max(bound, result.bound);
        squared_sum += result.squared_sum;
      }
      EXPECT_LE(found, bound);
      EXPECT_NEAR(squared_sum, whole.squared_sum, 0.05 * whole.squared_sum);
      if (context.rings > 1) {  // where less is known, what is near lies in the neighbour
        EXPECT_LE(bound, 1.5 * found);
      }
    }
  }
}

TEST(DeviationOfTilesTest, ContextTrianglesAreNotCertified) {
  Half half =
      half_of(contracted(tests::sphere(800, 0.01F), 200, Method::edge_collapse), true, {true, 1});
  const double before = DeviationMeter().measure(half.input(BorderShare::whole)).bound;
  const auto base = static_cast<std::uint32_t>(half.fine.size());
  half.fine.insert(half.fine.end(), {{50, 50, 50}, {51, 50, 50}, {50, 51, 50}});
  half.coarse_of.insert(half.coarse_of.end(), 3, kNone);
  half.fine_triangles.push_back(triangle(base, base + 1, base + 2));
  const Deviation result = DeviationMeter().measure(half.input(BorderShare::whole));
  EXPECT_NEAR(result.bound, before, 1e-8);
  EXPECT_EQ(result.collapsed_triangles, 0U);
}

}  // namespace
}  // namespace meshhier::cluster_simplify
