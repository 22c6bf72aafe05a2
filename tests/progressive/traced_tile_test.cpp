#include "progressive/traced_tile.h"

#include "base/error.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/error_message.h"
#include "tests/support/half_edge_hierarchy.h"
#include "tests/support/memory_files.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::progressive {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using tests::node;

/// A sphere of 198 vertices and 392 triangles in six partitions of 33 vertices each. Level 2 has
/// two early nodes, 2/1 and 2/3.
class TracedTileTest : public testing::Test {
 protected:
  TracedTileTest() {
    tests::build_half_edge(files_, {tests::sphere(300, 0.05F), {}, {}, {}},
                           tests::half_edge_config("/models", 6, 15));
    tree_ = storage::HierarchyReader(files_, "/models/mesh.hier").tree();
  }

  PublishedTile tile(NodeId node) {
    return storage::HierarchyReader(files_, "/models/mesh.hier").read_tile(node);
  }

  TracedTile traced(NodeId node, std::uint64_t first = 0) {
    return trace_partition(tree_, sector_, tile(node), first);
  }

  /// The children of 2/0, and their parent.
  struct Family {
    TracedTile left, right;
    PublishedTile parent;
  };
  Family family() {
    TracedTile left = traced(node(3, 0));
    const std::uint64_t middle = left.end_index;
    return {std::move(left), traced(node(3, 1), middle), tile(node(2, 0))};
  }
  Lifted lifted(Family family) const {
    return lift(tree_, sector_, std::move(family.left), std::move(family.right), family.parent);
  }

  std::string refused(Family family) const {
    return tests::error_message(ErrorCode::corrupt, [&] { lifted(std::move(family)); });
  }

  tests::MemoryFiles files_;
  Tree tree_{1, 1};
  Sector sector_{Tree(198, 6), NodeId{}};
};

TEST_F(TracedTileTest, APartitionCountsEachTriangleInTheFirstThatItTouches) {
  std::uint64_t next = 0;
  std::set<Triangle<std::uint32_t>> counted;
  for (std::uint32_t p = 0; p < 6; ++p) {
    const TracedTile tile = traced(node(3, p), next);
    for (const TracedTriangle& triangle : tile.triangles) {
      EXPECT_EQ(triangle.corners, sorted_corners(sector_, triangle.corners));
      if (triangle.index == kCountedElsewhere) {
        EXPECT_TRUE(counted.contains(triangle.corners));
        continue;
      }
      EXPECT_EQ(triangle.index, next++);
      EXPECT_TRUE(counted.insert(triangle.corners).second);
    }
    EXPECT_EQ(tile.end_index, next);
    EXPECT_EQ(tile.ranks.front(), tree_.ranks(node(3, p)).begin);
  }
  EXPECT_EQ(next, 392U);
}

TEST_F(TracedTileTest, ASectorCountsItsOwnTrianglesAndItsBorder) {
  const Sector sector(tree_, node(3, 4));
  const PublishedTile published = tile(node(3, 4));
  const TracedTile alone = trace_partition(tree_, sector, published, 0);
  EXPECT_EQ(alone.end_index, published.mesh.interior.size() + published.mesh.border.size());
  for (const TracedTriangle& triangle : alone.triangles) {
    EXPECT_NE(triangle.index, kCountedElsewhere);
    EXPECT_TRUE(sector.has_rank(triangle.corners[0])) << "own vertices come first";
  }
}

TEST_F(TracedTileTest, CornersAreTurnedNotMirrored) {
  EXPECT_EQ(sorted_corners(sector_, {5, 3, 9}), (Triangle<std::uint32_t>{3, 9, 5}));
  EXPECT_EQ(sorted_corners(sector_, {3, 9, 5}), (Triangle<std::uint32_t>{3, 9, 5}));
  EXPECT_EQ(sorted_corners(sector_, {9, 5, 3}), (Triangle<std::uint32_t>{3, 9, 5}));
  // The second of six partitions has ranks 33 to 65: 7 comes behind them.
  const Sector second(tree_, node(3, 1));
  EXPECT_EQ(sorted_corners(second, {7, 50, 40}), (Triangle<std::uint32_t>{40, 7, 50}));
}

TEST_F(TracedTileTest, WhatIsLiftedAndWhatIsLostIsAll) {
  const Family before = family();
  const Lifted up = lifted(family());
  std::set<std::uint32_t> ranks(up.tile.ranks.begin(), up.tile.ranks.end());
  EXPECT_EQ(ranks.size(), before.parent.mesh.own_count);
  for (const std::uint32_t rank : up.losses.ranks)
    EXPECT_TRUE(ranks.insert(rank).second);
  EXPECT_EQ(ranks.size(), 66U);
  EXPECT_EQ(*ranks.rbegin(), 65U);
  EXPECT_TRUE(std::ranges::is_sorted(up.losses.ranks));
  EXPECT_TRUE(std::ranges::is_sorted(up.losses.triangles));

  std::set<std::uint64_t> triangles(up.losses.triangles.begin(), up.losses.triangles.end());
  for (const TracedTriangle& triangle : up.tile.triangles) {
    if (triangle.index != kCountedElsewhere) {
      EXPECT_TRUE(triangles.insert(triangle.index).second);
    }
  }
  EXPECT_EQ(triangles.size(), before.right.end_index);
  EXPECT_EQ(up.tile.end_index, before.right.end_index);
}

TEST_F(TracedTileTest, ALiftedTileHasItsParentsVerticesAndTriangles) {
  const Family before = family();
  const Lifted up = lifted(family());
  EXPECT_EQ(up.tile.node, before.parent.node);
  EXPECT_EQ(up.tile.parent_map, before.parent.parent_map);
  for (std::size_t v = 0; v < before.parent.mesh.own_count; ++v) {
    const Vec3f p = before.parent.mesh.vertices.positions[v];
    EXPECT_THAT(up.tile.values[v], testing::ElementsAre(p.x, p.y, p.z));
  }
  // Ghosts that no triangle has for a corner may be more.
  for (const GhostRef& ghost : before.parent.mesh.ghosts)
    EXPECT_TRUE(std::ranges::binary_search(up.tile.ghosts, ghost));
}

TEST_F(TracedTileTest, AnEarlyNodeKeepsItsPartitionsVertices) {
  const TracedTile partition = traced(node(3, 2));
  const Lifted up = lift_early(tree_, sector_, traced(node(3, 2)));
  EXPECT_EQ(up.tile.node, node(2, 1));
  EXPECT_EQ(up.tile.ranks, partition.ranks);
  EXPECT_EQ(up.tile.values.values, partition.values.values);
  EXPECT_EQ(up.tile.parent_map, partition.parent_map);
  EXPECT_THAT(up.losses.ranks, IsEmpty());
}

TEST_F(TracedTileTest, StandInsAreOfCornersThatTheTileHasNot) {
  const TracedTile partition = traced(node(3, 0));
  EXPECT_THAT(find_stand_ins(sector_, partition).own, IsEmpty());
  EXPECT_THAT(find_stand_ins(sector_, partition).foreign, IsEmpty()) << "all are of the sector";
  const Lifted up = lifted(family());
  const StandIns found = find_stand_ins(sector_, up.tile);
  EXPECT_FALSE(found.own.empty());
  EXPECT_TRUE(std::ranges::is_sorted(found.own));
  for (const StandIns::Own& own : found.own)
    EXPECT_TRUE(std::ranges::binary_search(up.losses.ranks, own.rank));
  const Sector alone(tree_, node(3, 0));
  const TracedTile only = trace_partition(tree_, alone, tile(node(3, 0)), 0);
  EXPECT_FALSE(find_stand_ins(alone, only).foreign.empty());
}

TEST_F(TracedTileTest, WhatIsLeftAtTheRootIsInOrder) {
  const Losses all = all_of(lifted(family()).tile);
  EXPECT_TRUE(std::ranges::is_sorted(all.ranks));
  EXPECT_TRUE(std::ranges::is_sorted(all.triangles));
  EXPECT_EQ(all.values.values.size(), 3 * all.ranks.size());
  EXPECT_EQ(all.corners.size(), all.triangles.size());
}

// ---- tiles that are no children and parent ---------------------------------------------------

TEST_F(TracedTileTest, AVertexThatWasMovedIsNoneOfItsChildren) {
  EXPECT_EQ(refused(family()), "");
  Family moved = family();
  moved.parent.mesh.vertices.positions[3].y += 0.001F;
  EXPECT_THAT(refused(std::move(moved)),
              HasSubstr("tile 2/0: vertex 3 is at the place of none that it stands for"));
  Family zero = family();  // equal, but not bit for bit
  const std::uint16_t to = zero.left.parent_map[0];
  for (float* x : {&zero.left.values.values[0], &zero.parent.mesh.vertices.positions[to].x})
    *x = 0.0F;
  zero.parent.mesh.vertices.positions[to].x = -0.0F;
  EXPECT_NE(refused(std::move(zero)), "");
}

TEST_F(TracedTileTest, AMeanOfVerticesIsNoneOfThem) {
  tests::Sample sample = tests::make_sample(tests::sphere(300), {6, 15, false, false, {}});
  const Sector all(sample.tree, NodeId{});
  TracedTile left = trace_partition(sample.tree, all, sample.tile(node(3, 0)), 0);
  TracedTile right = trace_partition(sample.tree, all, sample.tile(node(3, 1)), left.end_index);
  try {
    lift(sample.tree, all, std::move(left), std::move(right), sample.tile(node(2, 0)));
    ADD_FAILURE() << "lifted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_THAT(error.what(), HasSubstr("half_edge leaves it there"));
  }
}

TEST_F(TracedTileTest, AParentMapThatDoesNotFitIsRefused) {
  const auto with = [&](const auto& change) {
    Family changed = family();
    change(changed);
    return refused(std::move(changed));
  };
  const std::string does_not_fit = "its parent map does not fit the parent tile";
  EXPECT_EQ(with([](Family& f) { f.left.parent_map[5] = 65535; }), "tile 3/0: " + does_not_fit);
  EXPECT_EQ(with([](Family& f) {
              f.right.parent_map[0] = static_cast<std::uint16_t>(f.parent.mesh.own_count);
            }),
            "tile 3/1: " + does_not_fit);
  EXPECT_EQ(with([](Family& f) { f.left.parent_map.pop_back(); }), "tile 3/0: " + does_not_fit);
  EXPECT_EQ(with([](Family& f) { f.right.parent_map.push_back(0); }), "tile 3/1: " + does_not_fit);
  EXPECT_EQ(with([](Family& f) { f.left.parent_map.clear(); }), "tile 3/0: " + does_not_fit);
  EXPECT_THAT(with([](Family& f) { f.parent.mesh.own_count = 3; }), HasSubstr(does_not_fit));
}

TEST_F(TracedTileTest, AVertexThatNoChildLeadsToIsRefused) {
  Family changed = family();
  for (TracedTile* child : {&changed.left, &changed.right}) {
    for (std::uint16_t& to : child->parent_map)
      to = to == 4 ? 5 : to;
  }
  EXPECT_THAT(refused(std::move(changed)),
              HasSubstr("vertex 4 is at the place of none that it stands for"));
}

TEST_F(TracedTileTest, OtherTrianglesThanTheChildrensAreRefused) {
  for (const bool of_border : {false, true}) {
    Family fewer = family();
    std::vector<TileTriangle>& list =
        of_border ? fewer.parent.mesh.border : fewer.parent.mesh.interior;
    ASSERT_FALSE(list.empty());
    list.pop_back();
    EXPECT_THAT(refused(std::move(fewer)),
                testing::AllOf(StartsWith("tile 2/0: has "), HasSubstr("of its children's")));
    Family more = family();
    more.parent.mesh.border.push_back(more.parent.mesh.border.back());
    EXPECT_THAT(refused(std::move(more)), HasSubstr("of its children's"));
  }
}

TEST_F(TracedTileTest, AGhostThatIsNoVertexOfItsNeighbourIsRefused) {
  PublishedTile partition = tile(node(3, 0));
  ASSERT_FALSE(partition.mesh.ghosts.empty());
  partition.mesh.ghosts.back().index = 33;
  EXPECT_THROW(trace_partition(tree_, sector_, partition, 0), Error);

  Family changed = family();  // its first ghost is its sibling's
  ASSERT_EQ(changed.left.ghosts.front().tile, 1U);
  changed.left.chains[0][0] = 40;
  EXPECT_EQ(refused(std::move(changed)), "tile 3/1: a neighbour's ghost is none of its vertices");
}

TEST_F(TracedTileTest, AGhostWhoseChainEndsTooSoonIsRefused) {
  Family changed = family();
  ASSERT_GT(changed.left.ghosts.back().tile, 1U);
  GhostChains chains;
  for (std::size_t ghost = 0; ghost < changed.left.ghosts.size(); ++ghost)
    chains.add(changed.left.chains[ghost].first(1));
  changed.left.chains = chains;
  EXPECT_THAT(refused(std::move(changed)), HasSubstr("has no vertex one level up"));
}

}  // namespace
}  // namespace meshhier::progressive
