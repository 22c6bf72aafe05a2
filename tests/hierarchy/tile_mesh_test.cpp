#include "hierarchy/tile_mesh.h"

#include "hierarchy/build_tile.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <random>
#include <set>
#include <type_traits>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

// Names of vertices of other tiles have types of their own.
template <class From, class To>
constexpr bool kMixes = std::is_convertible_v<From, To> || std::is_assignable_v<To&, From>;
static_assert(!kMixes<GhostRef, FinerGhost> && !kMixes<FinerGhost, GhostRef>);
static_assert(!kMixes<ChunkVertex, FinerGhost> && !kMixes<FinerGhost, ChunkVertex>);
static_assert(!kMixes<ChunkVertex, GhostRef> && !kMixes<GhostRef, ChunkVertex>);

std::vector<TileTriangle> random_triangles(std::size_t count, std::uint32_t corners) {
  std::mt19937 random(7);
  std::vector<TileTriangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t a = static_cast<std::uint32_t>(random()) % corners;
    const std::uint32_t b = static_cast<std::uint32_t>(random()) % corners;
    triangles.push_back(tile_triangle(a, b, static_cast<std::uint32_t>(random()) % corners));
  }
  return triangles;
}

/// The definition, without any cleverness.
std::vector<TileTriangle> normalized(const std::vector<TileTriangle>& triangles, bool unique) {
  std::vector<TileTriangle> result;
  for (TileTriangle t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2])
      continue;
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    result.push_back(t);
  }
  std::sort(result.begin(), result.end());
  if (unique) {
    const std::set<TileTriangle> set(result.begin(), result.end());
    result.assign(set.begin(), set.end());
  }
  return result;
}

TEST(TileMesh, NormalizingSortsAndDropsAsDefined) {
  for (const std::uint32_t corners : {1U, 3U, 4U, 12U, 300U, 70000U}) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{5000}}) {
      for (const bool unique : {false, true}) {
        const std::vector<TileTriangle> input = random_triangles(count, corners);
        std::vector<TileTriangle> triangles = input;
        normalize_triangles(triangles, unique);
        EXPECT_EQ(triangles, normalized(input, unique)) << corners << " " << count << " " << unique;
      }
    }
  }
}

TEST(TileMesh, NormalizingDoesNotDependOnTheOrderGiven) {
  std::vector<TileTriangle> triangles = random_triangles(2000, 50);
  std::vector<TileTriangle> other(triangles.rbegin(), triangles.rend());
  for (std::size_t i = 0; i < other.size(); ++i) {
    std::rotate(other[i].begin(), other[i].begin() + static_cast<std::ptrdiff_t>(i % 3),
                other[i].end());
  }
  normalize_triangles(triangles, false);
  normalize_triangles(other, false);
  EXPECT_EQ(triangles, other);
}

TEST(TileMesh, OfDuplicatesOneIsKeptAndTheMirrorImageStays) {
  std::vector<TileTriangle> triangles{tile_triangle(7, 2, 4), tile_triangle(2, 4, 7),
                                      tile_triangle(4, 2, 7), tile_triangle(4, 7, 2),
                                      tile_triangle(7, 4, 2)};
  normalize_triangles(triangles, true);
  EXPECT_EQ(triangles, (std::vector<TileTriangle>{tile_triangle(2, 4, 7), tile_triangle(2, 7, 4)}));
}

TEST(TileMesh, DuplicatesStayUnlessTheyAreUnwanted) {
  std::vector<TileTriangle> triangles{tile_triangle(7, 2, 4), tile_triangle(2, 4, 7)};
  normalize_triangles(triangles, false);
  EXPECT_EQ(triangles, (std::vector<TileTriangle>{tile_triangle(2, 4, 7), tile_triangle(2, 4, 7)}));
}

VertexArray numbered(std::size_t count, int channels, float first) {
  VertexArray vertices;
  vertices.channels = channels;
  vertices.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float value = first + static_cast<float>(i);
    std::vector<float> attributes;
    for (int k = 0; k < channels; ++k)
      attributes.push_back(100 * value + static_cast<float>(k));
    vertices.append({value, -value, 0.5F}, attributes);
  }
  return vertices;
}

TEST(TileMesh, VerticesKeepTheirAttributes) {
  for (const int channels : {0, 1, 9}) {
    const VertexArray vertices = numbered(5, channels, 10);
    ASSERT_EQ(vertices.size(), 5U);
    ASSERT_EQ(vertices.attributes.size(), 5U * static_cast<std::size_t>(channels));
    EXPECT_EQ(vertices.positions[3], (Vec3f{13, -13, 0.5F}));
    ASSERT_EQ(vertices.attributes_of(3).size(), static_cast<std::size_t>(channels));
    for (int k = 0; k < channels; ++k) {
      EXPECT_EQ(vertices.attributes_of(3)[static_cast<std::size_t>(k)],
                1300 + static_cast<float>(k));
    }
  }
}

TEST(TileMesh, ARangeOfVerticesIsAppended) {
  for (const int channels : {0, 4}) {
    VertexArray vertices = numbered(3, channels, 0);
    vertices.append(numbered(10, channels, 50), 4, 7);
    vertices.append(numbered(10, channels, 80), 6, 6);
    ASSERT_EQ(vertices.size(), 6U);
    ASSERT_EQ(vertices.attributes.size(), 6U * static_cast<std::size_t>(channels));
    EXPECT_EQ(vertices.positions[2].x, 2.0F);
    for (std::size_t i = 0; i < 3; ++i) {
      const float value = 54 + static_cast<float>(i);
      EXPECT_EQ(vertices.positions[3 + i].x, value);
      for (int k = 0; k < channels; ++k) {
        EXPECT_EQ(vertices.attributes_of(3 + i)[static_cast<std::size_t>(k)],
                  100 * value + static_cast<float>(k));
      }
    }
  }
}

TEST(TileMesh, NamedVerticesAreAppendedInTheirOrder) {
  for (const int channels : {0, 1, 4}) {
    VertexArray vertices = numbered(2, channels, 0);
    const VertexArray more = numbered(6, channels, 100);
    const std::vector<std::uint32_t> named = {5, 0, 3, 3};
    vertices.append(more, named);
    ASSERT_EQ(vertices.size(), 6U);
    ASSERT_EQ(vertices.attributes.size(), 6U * static_cast<std::size_t>(channels));
    for (std::size_t i = 0; i < named.size(); ++i) {
      EXPECT_EQ(vertices.positions[2 + i], more.positions[named[i]]);
      EXPECT_TRUE(std::ranges::equal(vertices.attributes_of(2 + i), more.attributes_of(named[i])));
    }
  }
}

TEST(TileMesh, ManyTrianglesOfOneFirstCornerAreSortedLikeFew) {
  for (const std::uint32_t count : {2U, 16U, 17U, 300U}) {
    std::vector<TileTriangle> triangles;
    for (std::uint32_t i = count; i-- > 0;)
      triangles.push_back({TileVertex{0}, TileVertex{1 + i * 7 % count}, TileVertex{1000 + i}});
    std::vector<TileTriangle> sorted = triangles;
    std::sort(sorted.begin(), sorted.end());
    normalize_triangles(triangles, true);
    EXPECT_EQ(triangles, sorted) << count;
  }
}

TEST(TileMesh, KnowsItsOwnVerticesFromItsGhosts) {
  TileMesh tile;
  tile.vertices = numbered(5, 0, 0);
  tile.own_count = 3;
  tile.ghosts = {{4, 1}, {9, 0}};
  EXPECT_TRUE(tile.is_own(TileVertex{0}));
  EXPECT_TRUE(tile.is_own(TileVertex{2}));
  EXPECT_FALSE(tile.is_own(TileVertex{3}));
  EXPECT_EQ(tile.ghost(TileVertex{3}), (GhostRef{4, 1}));
  EXPECT_EQ(tile.ghost(TileVertex{4}), (GhostRef{9, 0}));
}

TEST(TileMesh, GhostsAreOrderedByTileThenIndex) {
  EXPECT_LT((GhostRef{1, 9}), (GhostRef{2, 0}));
  EXPECT_LT((GhostRef{1, 3}), (GhostRef{1, 4}));
}

}  // namespace
}  // namespace meshhier::tests
