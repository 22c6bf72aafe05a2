#include "partition/top_tree.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::partition {
namespace {

using tests::hash_noise;

constexpr std::uint32_t kCount = 300000;  // four chunks, three splits
constexpr std::uint64_t kPlenty = std::uint64_t{1} << 32;

/// How the vertices reach the selector; nothing of it may show in the result.
struct Way {
  std::size_t block = 65536;
  bool backwards = false;
  std::uint64_t selection_memory = 1 << 20;
  std::uint64_t pool_bytes = kPlenty;
};

struct SettledSplit {
  TopTree tree;
  int sweeps = 0;
};

std::vector<IdPoint> sample_of(const std::vector<Vec3f>& positions) {
  const SampleIds ids(positions.size());
  std::vector<IdPoint> sample;
  for (std::uint64_t i = 0; i < ids.count(); ++i)
    sample.push_back({positions[ids[i]], static_cast<std::uint32_t>(ids[i])});
  return sample;
}

SweepBlock swept(const TopPlan& plan, std::span<const Vec3f> positions, std::uint32_t first) {
  SweepBlock block;
  Sweep(plan).count(positions, first, block);
  return block;
}

class TopTreeTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("top_") + info.name() + std::to_string(::getpid()));
  }

  SettledSplit settle(const std::vector<Vec3f>& positions, const Tree& tree, TopPlan plan,
                      const Way& way = {}) {
    storage::MemoryPool pool(way.pool_bytes);
    storage::ScratchFile scratch(*files_, path_, pool);
    std::vector<std::size_t> starts;
    for (std::size_t at = 0; at < positions.size(); at += way.block)
      starts.push_back(at);
    if (way.backwards)
      std::reverse(starts.begin(), starts.end());
    for (int sweeps = 1; sweeps < 1000; ++sweeps) {
      TopSelector selector(plan, tree, scratch, way.selection_memory);
      for (const std::size_t at : starts) {
        const auto block =
            std::span(positions).subspan(at, std::min(way.block, positions.size() - at));
        selector.add(swept(plan, block, static_cast<std::uint32_t>(at)));
      }
      std::vector<SplitPlane> planes = selector.settle(plan);
      if (!planes.empty())
        return {TopTree(plan.chunks, std::move(planes)), sweeps};
    }
    ADD_FAILURE() << "the medians never settle";
    return {TopTree(Level{}, {}), 0};
  }

  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::filesystem::path path_;
};

std::vector<std::uint32_t> chunks_of(const TopTree& top, const std::vector<Vec3f>& positions) {
  std::vector<std::uint32_t> chunks(positions.size());
  for (std::size_t i = 0; i < chunks.size(); ++i)
    chunks[i] = top.chunk_of(positions[i], static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> found(positions.size());
  const Bounds half{{-1.5F, -1, -0.5F}, {1.5F, 1, 0.5F}};  // where the box ends does not matter
  for (const Bounds& box : {bounds_of(positions), half}) {
    ChunkSearch(top, box).find(positions, 0, found);
    EXPECT_EQ(found, chunks);
  }
  return chunks;
}

/// The definition: every node sorted along its direction, ties by id, and cut at its left size.
void split_by_sorting(const std::vector<Vec3f>& positions, const Tree& tree, const TopPlan& plan,
                      NodeId node, std::span<std::uint32_t> ids, std::vector<std::uint32_t>& out) {
  if (node.level == plan.chunks) {
    for (const std::uint32_t id : ids)
      out[id] = node.index;
    return;
  }
  const Vec3d direction =
      plan.splits[(std::size_t{1} << raw(node.level)) - 1 + node.index].direction;
  std::sort(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
    return key_along(direction, positions[a], a) < key_along(direction, positions[b], b);
  });
  const Tree::Children children = tree.children(node);
  const std::size_t left = tree.ranks(children.nodes[0]).size();
  split_by_sorting(positions, tree, plan, children.nodes[0], ids.first(left), out);
  split_by_sorting(positions, tree, plan, children.nodes[1], ids.subspan(left), out);
}

std::vector<std::uint32_t> chunks_by_sorting(const std::vector<Vec3f>& positions, const Tree& tree,
                                             const TopPlan& plan) {
  std::vector<std::uint32_t> ids(positions.size());
  std::iota(ids.begin(), ids.end(), 0U);
  std::vector<std::uint32_t> chunks(positions.size());
  split_by_sorting(positions, tree, plan, {}, ids, chunks);
  return chunks;
}

std::vector<Vec3f> cloud(std::size_t count, Vec3f half = {3, 2, 1}) {
  std::vector<Vec3f> positions(count);
  for (std::size_t i = 0; i < count; ++i) {
    positions[i] = {half.x * hash_noise(i, 1), half.y * hash_noise(i, 2),
                    half.z * hash_noise(i, 3)};
  }
  return positions;
}

Tree tree_of(std::size_t vertex_count) {
  return {vertex_count, static_cast<std::uint32_t>(vertex_count / 8192 + 1)};
}

TEST(SampleIdsTest, FirstFromFindsTheNextOne) {
  for (const std::uint64_t count : {std::uint64_t{10}, kSampleVertices, kSampleVertices + 1,
                                    std::uint64_t{600'000}, (std::uint64_t{1} << 32) - 1}) {
    const SampleIds ids(count);
    for (const std::uint64_t id : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{5},
                                   std::uint64_t{77'777}, count / 3, count - 2, count - 1}) {
      const std::uint64_t i = ids.first_from(id);
      EXPECT_TRUE(i == ids.count() || ids[i] >= id) << id << " of " << count;
      EXPECT_TRUE(i == 0 || ids[i - 1] < id) << id << " of " << count;
    }
    EXPECT_EQ(ids.first_from(count), ids.count());
  }
}

TEST_F(TopTreeTest, ChunksAreTheFirstLevelOfNodesThatAreSmallEnough) {
  for (const std::uint64_t n :
       {1ULL, 131072ULL, 131073ULL, 262144ULL, 262145ULL, 437645ULL, 28184526ULL, 4294967295ULL}) {
    for (const std::uint64_t size : {500ULL, 5000ULL, 8192ULL, 32768ULL}) {
      const Tree tree(n, static_cast<std::uint32_t>((n + size - 1) / size));
      const Level level = chunk_level(tree);
      const auto largest = [&](Level l) {
        std::uint64_t most = 0;
        for (std::uint32_t i = 0; i < tree.node_count(l); ++i)
          most = std::max(most, tree.ranks(NodeId{l, i}).size());
        return most;
      };
      EXPECT_LE(largest(level), kChunkVertices) << n << " " << size;
      if (raw(level) > 0) {
        EXPECT_GT(largest(coarser(level)), kChunkVertices) << n << " " << size;
      }
    }
  }
}

TEST_F(TopTreeTest, SmallMeshesAreSampledWhole) {
  for (const std::uint64_t n : {std::uint64_t{1}, std::uint64_t{1000}, kSampleVertices}) {
    const SampleIds ids(n);
    ASSERT_EQ(ids.count(), n);
    for (std::uint64_t i = 0; i < n; i += 1 + n / 1000)
      ASSERT_EQ(ids[i], i);
  }
}

TEST_F(TopTreeTest, LargeMeshesAreSampledOnceInEachStride) {
  for (const std::uint64_t n :
       {kSampleVertices + 1, std::uint64_t{28184526}, std::uint64_t{4294967295}}) {
    const SampleIds ids(n);
    ASSERT_EQ(ids.count(), kSampleVertices);
    std::uint64_t at_start = 0;
    for (std::uint64_t i = 0; i < kSampleVertices; ++i) {
      ASSERT_GE(ids[i], i * n / kSampleVertices);
      ASSERT_LT(ids[i], (i + 1) * n / kSampleVertices);
      at_start += ids[i] == i * n / kSampleVertices ? 1 : 0;
    }
    if (n > 10 * kSampleVertices) {  // hashed places, not a comb
      EXPECT_LT(at_start, kSampleVertices / 10);
    }
  }
}

TEST_F(TopTreeTest, AMeshOfOneChunkHasNoSplits) {
  const std::vector<Vec3f> positions = cloud(1000);
  const Tree tree = tree_of(1000);
  const TopPlan plan = plan_top(sample_of(positions), tree, Axis::compactness);
  EXPECT_TRUE(plan.splits.empty());
  EXPECT_EQ(TopTree(plan.chunks, {}).chunk_of(positions[5], 5), 0U);
}

TEST_F(TopTreeTest, SLOW_EveryVertexGoesWhereSortingPutsIt) {
  for (const Axis axis : {Axis::longest, Axis::compactness}) {
    for (const std::uint32_t n : {131073U, kCount, 600001U}) {
      const std::vector<Vec3f> positions = cloud(n);
      const Tree tree = tree_of(n);
      const TopPlan plan = plan_top(sample_of(positions), tree, axis);
      const SettledSplit split = settle(positions, tree, plan);
      EXPECT_EQ(chunks_of(split.tree, positions), chunks_by_sorting(positions, tree, plan)) << n;
      EXPECT_EQ(split.tree.chunks(), chunk_level(tree));
      EXPECT_EQ(split.sweeps, 1) << n;
    }
  }
}

/// Exactly equal parts, whatever the points.
void expect_exact_sizes(const SettledSplit& split, const std::vector<Vec3f>& positions,
                        const Tree& tree) {
  std::vector<std::uint64_t> sizes(tree.node_count(split.tree.chunks()));
  for (const std::uint32_t chunk : chunks_of(split.tree, positions))
    ++sizes[chunk];
  for (std::uint32_t i = 0; i < sizes.size(); ++i)
    EXPECT_EQ(sizes[i], tree.ranks({split.tree.chunks(), i}).size()) << i;
}

TEST_F(TopTreeTest, SLOW_PartsAreExactForEveryKindOfPoints) {
  std::vector<Vec3f> sorted = cloud(kCount);
  std::sort(sorted.begin(), sorted.end(), [](Vec3f a, Vec3f b) { return a.x < b.x; });
  std::vector<Vec3f> lattice = cloud(kCount);
  for (Vec3f& p : lattice)
    p = {std::round(p.x), std::round(p.y), std::round(p.z)};
  std::vector<Vec3f> lopsided(kCount, Vec3f{1, 1, 1});
  for (std::size_t i = 0; i < kCount; i += 10)
    lopsided[i] = {hash_noise(i, 1), hash_noise(i, 2), hash_noise(i, 3)};
  const std::vector<std::vector<Vec3f>> kinds{
      cloud(kCount),
      std::vector<Vec3f>(kCount, Vec3f{0.1F, -0.2F, 0.3F}),  // all equal
      sorted,
      std::vector<Vec3f>(sorted.rbegin(), sorted.rend()),
      lattice,
      lopsided,
      cloud(kCount, {1e-42F, 1e-43F, 0}),  // denormal
      cloud(kCount, {3e38F, 3e38F, 3e38F}),
      cloud(kCount, {0, 0, 1})};
  const Tree tree = tree_of(kCount);
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    SCOPED_TRACE(kind);
    for (const Axis axis : {Axis::longest, Axis::compactness}) {
      const TopPlan plan = plan_top(sample_of(kinds[kind]), tree, axis);
      const SettledSplit split = settle(kinds[kind], tree, plan);
      expect_exact_sizes(split, kinds[kind], tree);
    }
  }
}

TEST_F(TopTreeTest, EqualPointsAreSplitById) {
  const std::vector<Vec3f> positions(kCount, Vec3f{0.1F, -0.2F, 0.3F});
  const Tree tree = tree_of(kCount);
  const SettledSplit split =
      settle(positions, tree, plan_top(sample_of(positions), tree, Axis::compactness));
  const auto chunks = chunks_of(split.tree, positions);
  EXPECT_TRUE(std::is_sorted(chunks.begin(), chunks.end()));
}

TEST_F(TopTreeTest, TheWayTheVerticesComeDoesNotShow) {
  const std::vector<Vec3f> positions = cloud(kCount);
  const Tree tree = tree_of(kCount);
  const TopPlan plan = plan_top(sample_of(positions), tree, Axis::compactness);
  const auto expected = chunks_by_sorting(positions, tree, plan);
  for (const Way& way : {Way{1000, false}, Way{kCount, false}, Way{4097, true},
                         Way{65536, false, 1 << 20, 0}, Way{65536, true, kPlenty, 100000}}) {
    EXPECT_EQ(chunks_of(settle(positions, tree, plan, way).tree, positions), expected);
  }
}

TEST_F(TopTreeTest, ASampleThatMisleadsCostsSweepsButNothingElse) {
  const std::vector<Vec3f> positions = cloud(kCount);
  const Tree tree = tree_of(kCount);
  std::vector<IdPoint> corner;  // all from one eighth of the box
  for (std::uint32_t i = 0; i < kCount; ++i) {
    if (positions[i].x > 1.5F && positions[i].y > 0)
      corner.push_back({positions[i], i});
  }
  const TopPlan plan = plan_top(corner, tree, Axis::compactness);
  const SettledSplit split = settle(positions, tree, plan);
  EXPECT_GT(split.sweeps, 1);
  EXPECT_LE(split.sweeps, 2 * raw(plan.chunks) + 1);  // a level misses twice at most
  EXPECT_EQ(chunks_of(split.tree, positions), chunks_by_sorting(positions, tree, plan));
}

TEST_F(TopTreeTest, AMissedWindowIsPlannedAgainThenOpenedWide) {
  const std::vector<Vec3f> positions = cloud(kCount);
  const Tree tree = tree_of(kCount);
  TopPlan plan = plan_top(sample_of(positions), tree, Axis::longest);
  const TopPlan before = plan;
  const auto miss_the_root = [&] {
    plan.splits[0].high = plan.splits[0].low = SplitKey::lowest();
    storage::MemoryPool pool(kPlenty);
    storage::ScratchFile scratch(*files_, path_, pool);
    TopSelector selector(plan, tree, scratch, 1 << 20);
    selector.add(swept(plan, positions, 0));
    EXPECT_TRUE(selector.settle(plan).empty());
    for (std::size_t i = 0; i < plan.splits.size(); ++i) {
      EXPECT_FALSE(plan.splits[i].settled);
      EXPECT_EQ(plan.splits[i].direction, before.splits[i].direction);
    }
  };
  miss_the_root();
  EXPECT_EQ(plan.splits[0].low, before.splits[0].low);
  EXPECT_EQ(plan.splits[0].high, before.splits[0].high);
  miss_the_root();
  EXPECT_EQ(plan.splits[0].low, SplitKey::lowest());
  EXPECT_EQ(plan.splits[0].high, SplitKey::highest());
  EXPECT_EQ(chunks_of(settle(positions, tree, plan).tree, positions),
            chunks_by_sorting(positions, tree, plan));
}

TEST_F(TopTreeTest, AWindowHoldsTheMedianOrIsMissedToTheVertex) {
  constexpr std::uint32_t kTwoChunks = 150000;
  const std::vector<Vec3f> positions = cloud(kTwoChunks);
  const Tree tree = tree_of(kTwoChunks);
  TopPlan plan = plan_top(sample_of(positions), tree, Axis::longest);
  ASSERT_EQ(plan.splits.size(), 1U);
  std::vector<SplitKey> keys;
  for (std::uint32_t i = 0; i < kTwoChunks; ++i)
    keys.push_back(key_along(plan.splits[0].direction, positions[i], i));
  std::sort(keys.begin(), keys.end());
  const std::size_t median = tree.ranks(NodeId{Level{1}, 0}).size();
  const auto sweeps_with = [&](std::size_t low, std::size_t high) {
    plan.splits[0].low = keys[low];
    plan.splits[0].high = keys[high];
    return settle(positions, tree, plan).sweeps;
  };
  EXPECT_EQ(sweeps_with(median, median), 1);
  EXPECT_EQ(sweeps_with(median - 100, median), 1);
  EXPECT_EQ(sweeps_with(median, median + 100), 1);
  EXPECT_EQ(sweeps_with(median - 100, median - 1), 2);
  EXPECT_EQ(sweeps_with(median + 1, median + 100), 2);
}

TEST_F(TopTreeTest, SLOW_WithoutASampleEverythingIsDecidedAfterwards) {
  const std::vector<Vec3f> positions = cloud(kCount);
  const Tree tree = tree_of(kCount);
  for (const std::size_t size : {0U, 1U, 2U, 3U}) {
    std::vector<IdPoint> sample = sample_of(positions);
    sample.resize(size);
    const TopPlan plan = plan_top(sample, tree, Axis::compactness);
    const SettledSplit split = settle(positions, tree, plan);
    EXPECT_EQ(chunks_of(split.tree, positions), chunks_by_sorting(positions, tree, plan)) << size;
  }
}

TEST_F(TopTreeTest, FewVerticesOfALargeMeshAreKeptAside) {
  const std::vector<Vec3f> positions = cloud(kCount);
  const Tree tree = tree_of(kCount);
  const TopPlan plan = plan_top(sample_of(positions), tree, Axis::compactness);
  EXPECT_LT(swept(plan, positions, 0).undecided.size(), kCount / 20);
}

// Splits of a long thin model all run across it. Where the sample's plane above differs from the
// exact one, all planes below differ in the same direction, and by as many vertices: more and more
// of the ever smaller nodes.
TEST_F(TopTreeTest, SLOW_ALongModelInRandomOrderSettlesInAFewSweeps) {
  constexpr std::size_t kLong = 8400000;  // 128 chunks
  const std::vector<Vec3f> positions = cloud(kLong, {1000, 1, 1});
  const Tree tree = tree_of(kLong);
  ASSERT_EQ(raw(chunk_level(tree)), 7);
  const TopPlan plan = plan_top(sample_of(positions), tree, Axis::longest);
  const SettledSplit split = settle(positions, tree, plan);
  EXPECT_LE(split.sweeps, 4);
  expect_exact_sizes(split, positions, tree);
}

TEST_F(TopTreeTest, ThePlanIsAPureFunctionOfTheSample) {
  const std::vector<Vec3f> positions = cloud(kCount);
  const Tree tree = tree_of(kCount);
  const TopPlan a = plan_top(sample_of(positions), tree, Axis::compactness);
  const TopPlan b = plan_top(sample_of(positions), tree, Axis::compactness);
  ASSERT_EQ(a.splits.size(), b.splits.size());
  for (std::size_t i = 0; i < a.splits.size(); ++i) {
    EXPECT_EQ(a.splits[i].direction, b.splits[i].direction);
    EXPECT_EQ(a.splits[i].low, b.splits[i].low);
    EXPECT_EQ(a.splits[i].high, b.splits[i].high);
    EXPECT_LE(a.splits[i].low, a.splits[i].high);
  }
}

}  // namespace
}  // namespace meshhier::partition
