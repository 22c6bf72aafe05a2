#include "images/wrapped_run.h"

#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::Each;
using testing::ElementsAre;

constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

TEST(WrappedRunTest, PicturesRepeat) {
  EXPECT_THAT(wrapped_run(-4, 9, 3, Wrap::repeat), ElementsAre(2, 0, 1, 2, 0, 1, 2, 0, 1));
}

TEST(WrappedRunTest, PicturesAreMirrored) {
  EXPECT_THAT(wrapped_run(-4, 11, 3, Wrap::mirrored), ElementsAre(2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0));
}

TEST(WrappedRunTest, TheEdgeGoesOn) {
  EXPECT_THAT(wrapped_run(-2, 7, 3, Wrap::clamp), ElementsAre(0, 0, 0, 1, 2, 2, 2));
}

TEST(WrappedRunTest, NoColumnIsTooFarAway) {
  EXPECT_THAT(wrapped_run(kLeast, 4, 3, Wrap::clamp), Each(0));
  EXPECT_THAT(wrapped_run(kMost, 4, 3, Wrap::clamp), Each(2));
  // 2^63 = 3 k + 2 = 6 k + 2.
  EXPECT_THAT(wrapped_run(kLeast, 4, 3, Wrap::repeat), ElementsAre(1, 2, 0, 1));
  EXPECT_THAT(wrapped_run(kMost, 4, 3, Wrap::repeat), ElementsAre(1, 2, 0, 1));
  EXPECT_THAT(wrapped_run(kLeast, 4, 3, Wrap::mirrored), ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(wrapped_run(kMost, 4, 3, Wrap::mirrored), ElementsAre(1, 2, 2, 1));
  EXPECT_THAT(wrapped_run(kMost, 2, 65535, Wrap::mirrored), Each(testing::Lt(65535)));
}

TEST(WrappedRunTest, OneTexelIsEverywhere) {
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored, Wrap::clamp})
    EXPECT_THAT(wrapped_run(-3, 7, 1, wrap), Each(0));
}

TEST(BlockRunsTest, NeighboursOfOneBlockStayTogether) {
  const std::vector<BlockRun> runs = block_runs({62, 63, 64, 65, 0, 0});
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[1].begin, 2U);
  EXPECT_EQ(runs[1].end, 4U);
  EXPECT_EQ(runs[1].block, 1U);
  EXPECT_EQ(runs[2].block, 0U);
  EXPECT_TRUE(block_runs({}).empty());
}

}  // namespace
}  // namespace meshhier::images
