#include "base/triangle_tree.h"

#include "base/bounds.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

Vec3f noise_point(std::uint64_t index, float size) {
  const auto at = [&](std::uint64_t stream) {
    return static_cast<float>(tests::hash_noise(index, stream)) * size;
  };
  return {at(1), at(2), at(3)};
}

/// Small ones in [-1, 1]^3.
std::vector<SurfaceTriangle> scattered(std::size_t count) {
  std::vector<SurfaceTriangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f a = noise_point(i, 1);
    triangles.push_back({a, a + noise_point(i + 1000, 0.1F), a + noise_point(i + 2000, 0.1F)});
  }
  return triangles;
}

float squared_distance(Vec3f point, const SurfaceTriangle& triangle) {
  Bounds box;
  for (const Vec3f corner : triangle)
    box.add(corner);
  float sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float away = std::max({box.min[axis] - point[axis], point[axis] - box.max[axis], 0.0F});
    sum += away * away;
  }
  return sum;
}

TEST(TriangleTreeTest, EachTriangleIsInOneLeaf) {
  for (const std::size_t leaf_size : {1, 4}) {
    for (const std::size_t count : {0, 1, 2, 3, 4, 5, 16, 17, 700}) {
      const TriangleTree tree(scattered(count), leaf_size);
      std::multiset<std::uint32_t> found;
      for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
        EXPECT_LE(tree.triangles(leaf).size(), leaf_size);
        found.insert(tree.triangles(leaf).begin(), tree.triangles(leaf).end());
      }
      EXPECT_EQ(found.size(), count);
      EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()).size(), count);
    }
  }
}

TEST(TriangleTreeTest, LeavesOfALineAreItsPiecesInWhateverOrderItComes) {
  constexpr std::uint32_t kCount = 1024;
  const auto pieces_of = [](const std::vector<float>& places) {
    std::vector<SurfaceTriangle> triangles;
    for (const float x : places)
      triangles.push_back({Vec3f{x, 0, 0}, Vec3f{x, 0, 0}, Vec3f{x, 0, 0}});
    return TriangleTree(triangles, 4);
  };
  const auto places_by = [](auto&& place_of) {
    std::vector<float> places;
    for (std::uint32_t i = 0; i < kCount; ++i)
      places.push_back(static_cast<float>(place_of(i)) - 300.0F);
    return places;
  };
  for (const std::vector<float>& places :
       {places_by([](std::uint32_t i) { return i; }),
        places_by([](std::uint32_t i) { return kCount - 1 - i; }),
        places_by([](std::uint32_t i) { return i % 2 == 0 ? i / 2 : kCount - 1 - i / 2; }),
        places_by([](std::uint32_t i) { return i * 5 % kCount; }),
        places_by([](std::uint32_t i) { return i * 205 % kCount; })}) {
    const TriangleTree tree = pieces_of(places);
    for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
      for (const std::uint32_t triangle : tree.triangles(leaf))
        ASSERT_EQ(static_cast<std::uint32_t>(places[triangle] + 300.0F) / 4, leaf);
    }
  }
  // What lies at one place is told apart by its number.
  const TriangleTree tree = pieces_of(std::vector<float>(kCount, -0.0F));
  for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
    for (const std::uint32_t triangle : tree.triangles(leaf))
      ASSERT_EQ(triangle / 4, leaf);
  }
}

TEST(TriangleTreeTest, LooksAtAllThatIsWithinReach) {
  const std::vector<SurfaceTriangle> triangles = scattered(700);
  for (const std::size_t leaf_size : {1, 4}) {
    const TriangleTree tree(triangles, leaf_size);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Vec3f point = noise_point(i + 5000, 1.5F);
      constexpr float kReach = 0.04F;
      std::set<std::uint32_t> looked_at, taken;
      const auto add = [&](std::set<std::uint32_t>& to, std::uint32_t leaf) {
        to.insert(tree.triangles(leaf).begin(), tree.triangles(leaf).end());
      };
      tree.look_nearest(TriangleTree::Query(point), kReach,
                        [&](std::uint32_t leaf) { add(looked_at, leaf); });
      EXPECT_TRUE(tree.take_within(TriangleTree::Query(point), kReach,
                                   [&](const TriangleTree::Node& node, std::size_t child) {
                                     add(taken, node.leaf(child));
                                     return true;
                                   }));
      EXPECT_EQ(looked_at, taken);
      for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        EXPECT_TRUE(taken.contains(t) || squared_distance(point, triangles[t]) > kReach) << t;
      }
      EXPECT_LT(taken.size(), triangles.size() / 4);
    }
  }
}

TEST(TriangleTreeTest, APointInDoublePrecisionLooksAtFewHoweverFarTinyOrHuge) {
  for (const double size : {1e-20, 1.0, 1e25}) {
    std::vector<SurfaceTriangle> triangles = scattered(700);
    for (SurfaceTriangle& triangle : triangles) {
      for (Vec3f& corner : triangle)
        corner = to_float(to_double(corner) * size);
    }
    const TriangleTree tree(triangles, 1);
    for (const double away : {0.0, 3.0, 1e7}) {
      const Vec3d point = (to_double(noise_point(1, 1)) + Vec3d{away, away, away}) * size;
      double reach = std::numeric_limits<double>::infinity();
      int count = 0;
      tree.look_nearest(point, reach, [&](std::uint32_t leaf) {
        const Vec3d way = to_double(triangles[tree.triangles(leaf).front()][0]) - point;
        reach = std::min(reach, dot(way, way));
        ++count;
      });
      EXPECT_LT(count, 700 / 4) << size << ", " << away;
    }
  }
}

TEST(TriangleTreeTest, TakesNoMoreThanIsWanted) {
  const TriangleTree tree(scattered(100), 1);
  int count = 0;
  EXPECT_FALSE(
      tree.take_within(TriangleTree::Query({-2, -2, -2}, {2, 2, 2}), 0,
                       [&](const TriangleTree::Node&, std::size_t) { return ++count < 7; }));
  EXPECT_EQ(count, 7);
}

}  // namespace
}  // namespace meshhier
