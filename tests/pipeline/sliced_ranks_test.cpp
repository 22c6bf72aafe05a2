#include "pipeline/sliced_ranks.h"

#include "base/error.h"
#include "hierarchy/tree.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

class SlicedRanksTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kVertices = 300'000;  // four chunks of 75,000
  static constexpr std::uint64_t kBlocks = 10;
  static constexpr std::uint32_t kBlockVertices = kVertices / kBlocks;

  static std::uint32_t chunk_of(std::uint32_t id) { return id * 7 % 4; }

  /// Returns the JSON that a slice of so many stores.
  nlohmann::json slice(const Share& share) {
    SlicedRanks ranks(map_, kVertices, kBlocks, scratch_);
    std::vector<std::uint32_t> counts(map_.count());
    for (std::uint64_t block = share.begin(kBlocks); block < share.end(kBlocks); ++block) {
      std::vector<std::uint32_t> of_block;
      for (std::uint32_t i = 0; i < kBlockVertices; ++i) {
        const std::uint32_t chunk =
            chunk_of(static_cast<std::uint32_t>(block) * kBlockVertices + i);
        of_block.push_back(map_.first_rank(chunk) + counts[chunk]++);
      }
      ranks.put(block, of_block);
    }
    return ranks.store(share, counts);
  }

  Tree tree_{kVertices, 40};
  partition::ChunkMap map_{tree_, Level{2}};
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
};

TEST_F(SlicedRanksTest, AnyCutGivesTheRanksOfOneSlice) {
  std::vector<std::uint32_t> expected(kVertices), next(map_.count());
  for (std::uint32_t id = 0; id < kVertices; ++id)
    expected[id] = map_.first_rank(chunk_of(id)) + next[chunk_of(id)]++;
  for (const std::uint32_t slices : {1U, 3U, 7U, 10U, 13U}) {
    SlicedRanks ranks(map_, kVertices, kBlocks, scratch_);
    for (std::uint32_t i = 0; i < slices; ++i) {
      EXPECT_EQ(ranks.is_whole(), false);
      ASSERT_TRUE(ranks.restore({i, slices}, slice({i, slices}))) << i << " of " << slices;
    }
    ASSERT_TRUE(ranks.is_whole());
    std::vector<std::uint32_t> found(kVertices);
    ranks.read(0, found);
    EXPECT_EQ(found, expected) << slices;
    for (const std::uint32_t first : {29'999U, 30'000U, 123'456U}) {
      std::vector<std::uint32_t> some(70'000);
      ranks.read(first, some);
      EXPECT_TRUE(std::equal(some.begin(), some.end(), expected.begin() + first)) << first;
    }
  }
}

TEST_F(SlicedRanksTest, SlicesThatDoNotFitAreRefused) {
  const nlohmann::json first = slice({0, 2}), second = slice({1, 2});
  const auto is_taken = [&](const Share& share, const nlohmann::json& stored) {
    SlicedRanks ranks(map_, kVertices, kBlocks, scratch_);
    return ranks.restore({0, 2}, first) && ranks.restore(share, stored);
  };
  ASSERT_TRUE(is_taken({1, 2}, second));
  EXPECT_FALSE(is_taken({0, 2}, first)) << "twice";
  EXPECT_FALSE(is_taken({1, 3}, second)) << "another number of blocks";
  nlohmann::json other = second;
  other["counts"][0] = 37'501;
  EXPECT_FALSE(is_taken({1, 2}, other)) << "more than the chunk has";
  other = second;
  other["counts"].erase(3);
  EXPECT_FALSE(is_taken({1, 2}, other)) << "another number of chunks";
  other = second;
  other["blocks"].erase(4);
  EXPECT_FALSE(is_taken({1, 2}, other)) << "a block less";
  other = second;
  other.erase("blocks");
  EXPECT_THROW(is_taken({1, 2}, other), nlohmann::json::exception);
}

TEST_F(SlicedRanksTest, RanksThatAreNoneAreRefused) {
  std::vector<std::uint32_t> counts(map_.count(), 75'000);
  for (const std::uint32_t wrong : {kVertices, UINT32_MAX}) {
    SlicedRanks made(map_, kVertices, 1, scratch_), read(map_, kVertices, 1, scratch_);
    made.put(0, std::vector<std::uint32_t>(kVertices, wrong));
    ASSERT_TRUE(read.restore({0, 1}, made.store({0, 1}, counts)));
    std::vector<std::uint32_t> ranks(1);
    EXPECT_THROW(read.read(5, ranks), Error);
    EXPECT_THROW(read.read(kVertices, ranks), Error);
  }
}

TEST_F(SlicedRanksTest, CopiesHaveNoneOfTheirOwn) {
  constexpr std::uint32_t kCopies = 2;
  constexpr std::uint64_t kAll = kVertices + kCopies;
  std::vector<std::uint32_t> all(kAll), counts;
  for (std::uint32_t chunk = 0; chunk < map_.count(); ++chunk)
    counts.push_back(map_.size(chunk));
  for (std::uint32_t id = 0; id < kVertices; ++id)
    all[id] = id;
  all[kVertices] = all[kVertices + 1] = SlicedRanks::kCopy;
  SlicedRanks made(map_, kAll, 1, scratch_), read(map_, kAll, 1, scratch_);
  made.put(0, all);
  ASSERT_TRUE(read.restore({0, 1}, made.store({0, 1}, counts)));
  ASSERT_TRUE(read.is_whole());
  std::vector<std::uint32_t> ranks(kAll);
  read.read(0, ranks);
  EXPECT_EQ(ranks, all);
  EXPECT_EQ(read.ids_of({0, 1}).end, kAll);
}

}  // namespace
}  // namespace meshhier::pipeline
