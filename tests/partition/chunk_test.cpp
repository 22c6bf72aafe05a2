#include "partition/chunk.h"

#include "partition/split_plane.h"
#include "partition/top_tree.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

using Ids = std::vector<std::uint32_t>;

/// The whole mesh as the chunk of the root.
ChunkMesh root_chunk(const tests::TestMesh& mesh) {
  ChunkMesh chunk;
  chunk.vertices.positions = mesh.positions;
  chunk.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  return chunk;
}

Tree tree_of(const ChunkMesh& chunk, std::uint32_t partitions) {
  return {chunk.vertices.size(), partitions};
}

void expect_exact_sizes(const std::vector<PartitionId>& found, const Tree& tree, NodeId chunk) {
  const PartitionRange range = tree.partitions(chunk);
  ASSERT_EQ(found.size(), tree.ranks(chunk).size());
  std::vector<std::uint64_t> sizes(range.size());
  for (const PartitionId partition : found) {
    ASSERT_GE(raw(partition), range.begin);
    ASSERT_LT(raw(partition), range.end);
    ++sizes[raw(partition) - range.begin];
  }
  for (std::uint32_t i = 0; i < range.size(); ++i)
    EXPECT_EQ(sizes[i], tree.ranks({tree.depth(), range.begin + i}).size()) << i;
}

/// True if the plane of one of the candidates has all of `left` strictly below all of `right`.
bool separates_one(const std::vector<Vec3d>& candidates, const ChunkMesh& chunk, const Ids& left,
                   const Ids& right) {
  return std::any_of(candidates.begin(), candidates.end(), [&](Vec3d direction) {
    const auto key = [&](std::uint32_t v) {
      return key_along(direction, chunk.vertices.positions[v], v);
    };
    SplitKey highest = SplitKey::lowest();
    for (const std::uint32_t v : left)
      highest = std::max(highest, key(v));
    return std::all_of(right.begin(), right.end(),
                       [&](std::uint32_t v) { return key(v) > highest; });
  });
}

/// Every split below `node` is at the exact median along one of its candidate directions, ties by
/// number.
void expect_exact_medians(const ChunkMesh& chunk, const std::vector<PartitionId>& found,
                          const Tree& tree, Axis axis, NodeId node, const Ids& ids) {
  const Tree::Children children = tree.children(node);
  if (children.count < 2)
    return;
  Ids left, right;
  for (const std::uint32_t v : ids) {
    const bool is_right = raw(found[v]) >= tree.partitions(children.nodes[1]).begin;
    (is_right ? right : left).push_back(v);
  }
  ASSERT_EQ(left.size(), tree.ranks(children.nodes[0]).size());
  std::vector<Vec3f> points;
  for (const std::uint32_t v : ids)
    points.push_back(chunk.vertices.positions[v]);
  EXPECT_TRUE(separates_one(candidate_directions(points, axis), chunk, left, right))
      << "level " << int{raw(node.level)} << " index " << node.index;
  expect_exact_medians(chunk, found, tree, axis, children.nodes[0], left);
  expect_exact_medians(chunk, found, tree, axis, children.nodes[1], right);
}

void expect_exact_medians(const ChunkMesh& chunk, const std::vector<PartitionId>& found,
                          const Tree& tree, Axis axis) {
  Ids ids(chunk.vertices.size());
  std::iota(ids.begin(), ids.end(), 0U);
  expect_exact_medians(chunk, found, tree, axis, chunk.node, ids);
}

TEST(ChunkMaps, FindEveryRanksChunk) {
  for (const std::uint64_t n : {1ULL, 7ULL, 1000ULL, 437645ULL, 4294967295ULL}) {
    for (const std::uint32_t partitions : {1U, 2U, 5U, 7U, 96U, 1000U}) {
      if (partitions > n)
        continue;
      const Tree tree(n, partitions);
      for (int level = 0; level < std::max<int>(1, raw(tree.depth())); ++level) {
        const ChunkMap map(tree, static_cast<Level>(level));
        ASSERT_EQ(map.count(), tree.node_count(static_cast<Level>(level)));
        for (std::uint32_t i = 0; i < map.count(); ++i) {
          const RankRange ranks = tree.ranks(NodeId{static_cast<Level>(level), i});
          ASSERT_EQ(map.first_rank(i), ranks.begin);
          ASSERT_EQ(map.size(i), ranks.size());
          for (const std::uint64_t rank :
               {ranks.begin, (ranks.begin + ranks.end) / 2, ranks.end - 1}) {
            ASSERT_EQ(map.chunk_of(static_cast<std::uint32_t>(rank)), i) << n << " " << partitions;
          }
        }
      }
    }
  }
}

TEST(SplitChunk, PartitionsHaveTheirExactSizes) {
  const ChunkMesh chunk = root_chunk(tests::shuffled(tests::torus(6000, 0.02F), 1));
  for (const std::uint32_t partitions : {1U, 2U, 3U, 5U, 13U, 64U, 100U, 1000U}) {
    const Tree tree = tree_of(chunk, partitions);
    for (const Axis axis : {Axis::longest, Axis::compactness})
      expect_exact_sizes(split_chunk(chunk, tree, axis), tree, chunk.node);
  }
}

TEST(SplitChunk, AsManyPartitionsAsVerticesHaveOneEach) {
  const ChunkMesh chunk = root_chunk(tests::sphere(500));
  const Tree tree = tree_of(chunk, static_cast<std::uint32_t>(chunk.vertices.size()));
  for (const Axis axis : {Axis::longest, Axis::compactness})
    expect_exact_sizes(split_chunk(chunk, tree, axis), tree, chunk.node);
}

TEST(SplitChunk, EverySplitIsAtTheExactMedianOfOneOfTheDirections) {
  for (const tests::TestMesh& mesh :
       {tests::shuffled(tests::sphere(4000, 0.02F), 2), tests::open_grid(70, 40),
        tests::non_manifold(3000), tests::points(2000), tests::soup(700)}) {
    const ChunkMesh chunk = root_chunk(mesh);
    const Tree tree = tree_of(chunk, 37);
    expect_exact_medians(chunk, split_chunk(chunk, tree, Axis::longest), tree, Axis::longest);
    if (mesh.triangles.empty()) {  // no surface to follow
      expect_exact_medians(chunk, split_chunk(chunk, tree, Axis::compactness), tree,
                           Axis::compactness);
    }
  }
}

// The longest axis has a single candidate, so the medians above are its medians; this is the same
// for one split, in plain sight.
TEST(SplitChunk, TheLongestAxisRuleCutsTheLongestAxis) {
  tests::TestMesh mesh = tests::points(1000);
  for (Vec3f& p : mesh.positions)
    p = {p.x, 5 * p.y, 2 * p.z};
  const ChunkMesh chunk = root_chunk(mesh);
  const auto found = split_chunk(chunk, tree_of(chunk, 2), Axis::longest);
  std::vector<float> heights;
  for (const Vec3f& p : mesh.positions)
    heights.push_back(p.y);
  std::nth_element(heights.begin(), heights.begin() + 500, heights.end());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(raw(found[i]), mesh.positions[i].y >= heights[500] ? 1U : 0U);
}

/// Triangles that touch more than one partition.
std::ptrdiff_t cut_triangles(const tests::TestMesh& mesh, std::uint32_t partitions, Axis axis) {
  const ChunkMesh chunk = root_chunk(mesh);
  const auto found = split_chunk(chunk, tree_of(chunk, partitions), axis);
  return std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    return found[t[0]] != found[t[1]] || found[t[1]] != found[t[2]];
  });
}

TEST(SplitChunk, CompactnessCutsTheNeckThatTheLongestAxisMisses) {
  // Two strips side by side along x, joined at y <= 1; they are longer along y than both are wide,
  // so the longest axis cuts through both.
  tests::TestMesh mesh = tests::open_grid(21, 50);
  std::erase_if(mesh.triangles, [&](const tests::MeshTriangle& t) {
    const auto in_gap = [&](std::uint32_t v) {
      const Vec3f p = mesh.positions[v];
      return p.x >= 10 && p.x <= 11;
    };
    const auto above = [&](std::uint32_t v) { return mesh.positions[v].y > 1; };
    return std::all_of(t.begin(), t.end(), in_gap) && std::any_of(t.begin(), t.end(), above);
  });
  for (Vec3f& p : mesh.positions)  // not flat along any axis
    p.z = 0.2F * p.x + 0.3F * p.y;
  EXPECT_GT(cut_triangles(mesh, 2, Axis::longest), 30);
  EXPECT_LE(cut_triangles(mesh, 2, Axis::compactness), 2);
}

TEST(SplitChunk, CompactnessCutsNoMoreThanTheLongestAxisDoes) {
  for (const tests::TestMesh& mesh :
       {tests::shuffled(tests::sphere(20000, 0.01F), 4), tests::shuffled(tests::torus(20000), 4),
        tests::shuffled(tests::genus_n(3, 20000, 0.01F), 4)}) {
    EXPECT_LT(cut_triangles(mesh, 32, Axis::compactness), cut_triangles(mesh, 32, Axis::longest));
  }
}

// A flat mesh can be "split" along its normal, where all vertices are equal and nothing is cut: by
// number, that is, anywhere.
TEST(SplitChunk, AFlatMeshIsCutAcrossItsPlane) {
  const tests::TestMesh mesh = tests::shuffled(tests::open_grid(80, 80), 4);
  const auto longest = cut_triangles(mesh, 16, Axis::longest);
  EXPECT_LE(cut_triangles(mesh, 16, Axis::compactness), longest + longest / 10);
}

TEST(SplitChunk, EqualPointsAreSplitByNumber) {
  ChunkMesh chunk;
  chunk.vertices.positions.assign(1000, Vec3f{0.1F, -0.2F, 0.3F});
  for (std::uint32_t i = 0; i + 2 < 1000; ++i)
    chunk.triangles.push_back({i, i + 1, i + 2});
  const Tree tree = tree_of(chunk, 7);
  for (const Axis axis : {Axis::longest, Axis::compactness}) {
    const auto found = split_chunk(chunk, tree, axis);
    expect_exact_sizes(found, tree, chunk.node);
    EXPECT_TRUE(axis == Axis::compactness || std::is_sorted(found.begin(), found.end()));
  }
}

TEST(SplitChunk, ExtremeCoordinatesAreSplitExactly) {
  for (const float scale : {1e-44F, 1e-38F, 1e30F, 3e38F}) {
    tests::TestMesh mesh = tests::soup(500);
    for (Vec3f& p : mesh.positions)
      p = p * scale;
    const ChunkMesh chunk = root_chunk(mesh);
    const Tree tree = tree_of(chunk, 11);
    expect_exact_medians(chunk, split_chunk(chunk, tree, Axis::longest), tree, Axis::longest);
    expect_exact_sizes(split_chunk(chunk, tree, Axis::compactness), tree, chunk.node);
  }
}

TEST(SplitChunk, DoesNotDependOnTheOrderOfTriangles) {
  for (const std::size_t triangles : {std::size_t{3000}, std::size_t{131072}}) {
    ChunkMesh chunk = root_chunk(tests::sphere(triangles, 0.003F));
    const Tree tree = tree_of(chunk, 24);
    const auto expected = split_chunk(chunk, tree, Axis::compactness);
    for (const unsigned seed : {1U, 2U}) {
      std::shuffle(chunk.triangles.begin(), chunk.triangles.end(), std::mt19937(seed));
      EXPECT_EQ(split_chunk(chunk, tree, Axis::compactness), expected) << triangles;
    }
  }
}

TEST(SplitChunk, DoesNotDependOnTheCornerATriangleStartsWith) {
  for (const std::size_t triangles : {std::size_t{3000}, std::size_t{131072}}) {
    ChunkMesh chunk = root_chunk(tests::sphere(triangles, 0.003F));
    const Tree tree = tree_of(chunk, 24);
    const auto expected = split_chunk(chunk, tree, Axis::compactness);
    for (const std::size_t stride : {1U, 2U, 3U}) {
      for (std::size_t i = 0; i < chunk.triangles.size(); i += stride) {
        RankTriangle& t = chunk.triangles[i];
        std::rotate(t.begin(), t.begin() + 1, t.end());
      }
      EXPECT_EQ(split_chunk(chunk, tree, Axis::compactness), expected) << triangles;
    }
  }
}

TEST(SplitChunk, AChunkInTheMiddleIsSplitAsIfItWereAlone) {
  const tests::TestMesh mesh = tests::sphere(3000, 0.02F);
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  const Tree tree(8 * std::uint64_t{n}, 8 * 6);
  ChunkMesh chunk = root_chunk(mesh);
  const auto alone = split_chunk(chunk, Tree(n, 6), Axis::compactness);
  chunk.node = {Level{3}, 5};
  const auto first = static_cast<std::uint32_t>(tree.ranks(chunk.node).begin);
  for (RankTriangle& t : chunk.triangles) {
    for (std::uint32_t& rank : t)
      rank += first;
  }
  // Triangles that reach into the chunks before and behind; they are nobody's to judge here.
  for (std::uint32_t i = 0; i < 500; ++i)
    chunk.triangles.push_back({first + i, first - 1 - i, first + n + i});
  const auto found = split_chunk(chunk, tree, Axis::compactness);
  expect_exact_sizes(found, tree, chunk.node);
  const std::uint32_t first_partition = tree.partitions(chunk.node).begin;
  for (std::size_t i = 0; i < found.size(); ++i)
    ASSERT_EQ(raw(found[i]), raw(alone[i]) + first_partition);
}

TEST(SplitChunk, AChunkThatIsAPartitionStaysWhole) {
  ChunkMesh chunk = root_chunk(tests::sphere(500));
  const std::uint64_t n = chunk.vertices.size();
  const Tree tree(4 * n, 4);
  chunk.node = {tree.depth(), 2};
  chunk.triangles.clear();
  for (const PartitionId partition : split_chunk(chunk, tree, Axis::compactness))
    EXPECT_EQ(partition, PartitionId{2});
}

// Lines are weighed as whole parts of their mean: next to some, others are nothing.
TEST(SplitChunk, TrianglesFarLargerThanOthersAreNoMatter) {
  ChunkMesh chunk;
  for (std::uint32_t i = 0; i < 40000; ++i) {
    const Vec3f p{tests::hash_noise(i, 1), tests::hash_noise(i, 2), tests::hash_noise(i, 3)};
    chunk.vertices.append(p * (i % 2 == 0 ? 1e-30F : 1.0F), {});
  }
  for (std::uint32_t i = 1; i + 4 < 40000; i += 2)
    chunk.triangles.push_back({i, i + 2, i + 4});
  const Tree tree = tree_of(chunk, 5);
  expect_exact_sizes(split_chunk(chunk, tree, Axis::compactness), tree, chunk.node);
}

/// The lines between partitions, and all around the model: the sum of their perimeters squared over
/// that of their areas times 4 pi, which is the mean of compactness for parts of equal area.
double mean_compactness(const tests::TestMesh& mesh, std::uint32_t partitions, Axis axis) {
  const ChunkMesh chunk = root_chunk(mesh);
  const auto found = split_chunk(chunk, tree_of(chunk, partitions), axis);
  std::vector<double> perimeter(partitions), area(partitions);
  for (const tests::MeshTriangle& t : mesh.triangles) {
    std::array<Vec3d, 3> p;
    for (int k = 0; k < 3; ++k)
      p[k] = to_double(mesh.positions[t[k]]);
    const Vec3d centroid = (p[0] + p[1] + p[2]) * (1.0 / 3);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      area[raw(found[t[k]])] += length(cross(p[1] - p[0], p[2] - p[0])) / 6;
      if (found[t[k]] != found[t[next]]) {
        const double line = length((p[k] + p[next]) * 0.5 - centroid);
        perimeter[raw(found[t[k]])] += line;
        perimeter[raw(found[t[next]])] += line;
      }
    }
  }
  double sum = 0;
  for (std::uint32_t i = 0; i < partitions; ++i)
    sum += perimeter[i] * perimeter[i] / (4 * 3.14159265358979 * area[i]);
  return sum / partitions;
}

TEST(SplitChunk, CompactnessIsBetterByTheStatedFactors) {
  struct Expectation {
    tests::TestMesh mesh;
    double most;  // at most so much of that of the longest axis
  };
  const std::vector<Expectation> expectations{
      {tests::shuffled(tests::sphere(40000, 0.002F), 1), 0.85},
      {tests::shuffled(tests::torus(40000, 0.002F), 1), 0.85},
      {tests::shuffled(tests::nested_shells(40000, 0.002F), 1), 0.7},
      {tests::shuffled(tests::genus_n(6, 40000, 0.002F), 1), 0.85}};
  for (const Expectation& expected : expectations) {
    EXPECT_LT(mean_compactness(expected.mesh, 32, Axis::compactness),
              expected.most * mean_compactness(expected.mesh, 32, Axis::longest));
  }
}

// Squares of a plane grid: straight lines are best, and only planes find them all.
TEST(SplitChunk, AFlatGridLosesLittleToStraightLines) {
  const tests::TestMesh mesh = tests::open_grid(128, 128);
  EXPECT_LT(mean_compactness(mesh, 16, Axis::compactness),
            1.3 * mean_compactness(mesh, 16, Axis::longest));
}

TEST(SplitChunk, DoesNotDependOnTheOrderOfMoreTrianglesThanAreLookedAt) {
  ChunkMesh chunk = root_chunk(tests::sphere(3000, 0.01F));
  const std::vector<RankTriangle> once = chunk.triangles;
  for (int i = 0; i < 3; ++i)
    chunk.triangles.insert(chunk.triangles.end(), once.begin(), once.end());
  for (std::uint32_t v = 0; v + 40 < chunk.vertices.size(); ++v)
    chunk.triangles.push_back({v, v + 17, v + 40});
  const Tree tree = tree_of(chunk, 24);
  const auto expected = split_chunk(chunk, tree, Axis::compactness);
  expect_exact_sizes(expected, tree, chunk.node);
  std::shuffle(chunk.triangles.begin(), chunk.triangles.end(), std::mt19937(7));
  EXPECT_EQ(split_chunk(chunk, tree, Axis::compactness), expected);
}

TEST(SplitChunk, OneTriangleAmongManyVerticesIsEnough) {
  ChunkMesh chunk = root_chunk(tests::points(50000));
  chunk.triangles.push_back({3, 30000, 4});
  for (const std::uint32_t partitions : {2U, 37U, 5000U}) {
    const Tree tree = tree_of(chunk, partitions);
    expect_exact_sizes(split_chunk(chunk, tree, Axis::compactness), tree, chunk.node);
  }
}

// Two equal corners join nothing: there is no surface.
TEST(SplitChunk, DegenerateTrianglesAreSplitAsPointsAre) {
  ChunkMesh chunk = root_chunk(tests::points(3000));
  const Tree tree = tree_of(chunk, 37);
  const auto expected = split_chunk(chunk, tree, Axis::compactness);
  for (std::uint32_t v = 0; v + 1 < 3000; v += 3)
    chunk.triangles.push_back({v, v, v});
  EXPECT_EQ(split_chunk(chunk, tree, Axis::compactness), expected);
}

TEST(SplitChunk, SLOW_ThousandsOfPartitionsHaveTheirExactSizes) {
  const ChunkMesh chunk = root_chunk(tests::shuffled(tests::sphere(60000, 0.002F), 1));
  for (const std::uint32_t partitions : {65U, 129U, 3000U, 7500U}) {
    const Tree tree = tree_of(chunk, partitions);
    expect_exact_sizes(split_chunk(chunk, tree, Axis::compactness), tree, chunk.node);
  }
}

}  // namespace
}  // namespace meshhier::partition
