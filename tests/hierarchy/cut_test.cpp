#include "hierarchy/cut.h"

#include "base/error.h"
#include "tests/support/error_message.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::node;
using tests::usage_error;

TEST(Cut, OfALevelShowsThePartitionsOfEarlyNodes) {
  const Tree tree(60, 6);  // 2, 1, 2, 1 partitions below the four nodes of level 2
  const Cut cut = Cut::of_level(tree, static_cast<Level>(2));
  EXPECT_THAT(std::vector(cut.nodes().begin(), cut.nodes().end()),
              ElementsAre(node(2, 0), node(3, 2), node(2, 2), node(3, 5)));
}

TEST(Cut, FindsTheNodeThatShowsAPartition) {
  const Tree tree(60, 6);
  const Cut cut(tree, {node(1, 1), node(3, 0), node(3, 1), node(2, 1)});
  EXPECT_THAT(std::vector(cut.nodes().begin(), cut.nodes().end()),
              ElementsAre(node(3, 0), node(3, 1), node(3, 2), node(1, 1)));
  const std::array<std::size_t, 6> expected{0, 1, 2, 3, 3, 3};
  for (std::uint32_t p = 0; p < 6; ++p) {
    EXPECT_EQ(cut.position_of(static_cast<PartitionId>(p)), expected[p]) << p;
  }
}

TEST(Cut, NamesTheGap) {
  const Tree tree(60, 6);
  EXPECT_THAT(usage_error([&] { Cut(tree, {node(1, 0)}); }),
              HasSubstr("no node covers partitions 3 to 5"));
  EXPECT_THAT(usage_error([&] { Cut(tree, {node(1, 1)}); }),
              HasSubstr("no node covers partitions 0 to 2"));
  EXPECT_THAT(usage_error([&] {
                Cut(tree, {node(2, 0), node(1, 1)});
              }),
              HasSubstr("no node covers partition 2"));
  EXPECT_THAT(usage_error([&] { Cut(tree, {}); }), HasSubstr("partitions 0 to 5"));
}

TEST(Cut, NamesTheOverlap) {
  const Tree tree(60, 6);
  EXPECT_THAT(usage_error([&] {
                Cut(tree, {node(1, 0), node(1, 1), node(3, 4)});
              }),
              HasSubstr("nodes 1/1 and 3/4 both cover partition 4"));
  EXPECT_THAT(usage_error([&] {
                Cut(tree, {node(0, 0), node(0, 0)});
              }),
              HasSubstr("both cover partition 0"));
}

TEST(Cut, RefusesNodesThatAreNotInTheTree) {
  const Tree tree(60, 6);
  EXPECT_THAT(usage_error([&] { Cut(tree, {node(4, 0)}); }), HasSubstr("the levels are 0 to 3"));
  EXPECT_THAT(usage_error([&] { Cut(tree, {node(3, 6)}); }),
              HasSubstr("the nodes of level 3 are 0 to 5"));
  EXPECT_THAT(usage_error([&] { Cut(tree, {node(200, 7)}); }), HasSubstr("200/7"));
}

}  // namespace
}  // namespace meshhier
