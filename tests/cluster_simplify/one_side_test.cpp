#include "cluster_simplify/one_side.h"

#include "tests/cluster_simplify/collapsing.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <array>
#include <cstdint>
#include <set>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::mirrored;

TEST(OneSideTest, MostEdgesOfATwoSidedMeshHaveTwiceAsManyTriangles) {
  EXPECT_TRUE(is_two_sided(CollapseMesh(tests::tile_of(mirrored(tests::sphere(500))).mesh)));
  EXPECT_TRUE(is_two_sided(CollapseMesh(tests::tile_of(mirrored(tests::open_grid(9, 9))).mesh)));
  for (const tests::TestMesh& mesh :
       {tests::sphere(500), tests::open_grid(9, 9), tests::non_manifold(500), tests::soup(90),
        tests::duplicates(500), tests::points(9)})
    EXPECT_FALSE(is_two_sided(CollapseMesh(tests::tile_of(mesh).mesh)));
}

TEST(OneSideTest, HasOneOfEachTwoTrianglesAroundAnEdge) {
  for (const tests::TestMesh& one :
       {tests::sphere(300), tests::open_grid(8, 8, 0.1F), tests::moebius(200)}) {
    const BuildTile tile = tests::tile_of(mirrored(one));
    CollapseMesh mesh(tile.mesh);
    EdgeStar star;
    OneSide side;
    std::size_t discs = 0;
    for (const std::uint32_t e : tests::live_edges(mesh)) {
      star.gather(mesh, mesh.edge(e).a, mesh.edge(e).b);
      ASSERT_TRUE(side.find(star));
      discs += side.star().is_disc() ? 1 : 0;
      std::set<std::uint32_t> all, found;
      for (const Fans fans : {star.around_from(), star.around_to()}) {
        for (const CollapseMesh::Fan& fan : fans)
          all.insert(fan.triangle);
      }
      for (const auto& [triangle, reverse] : side.pairs()) {
        const auto& a = mesh.faces()[triangle].corners;
        const auto& b = mesh.faces()[reverse].corners;
        ASSERT_EQ(std::set<std::uint32_t>(a.begin(), a.end()),
                  std::set<std::uint32_t>(b.begin(), b.end()));
        found.insert({triangle, reverse});
      }
      ASSERT_EQ(found, all);
      ASSERT_EQ(2 * side.star().around_from().size(), star.around_from().size());
      ASSERT_EQ(2 * side.star().around_to().size(), star.around_to().size());
    }
    EXPECT_GT(discs, 0U);
  }
}

TEST(OneSideTest, ThereIsNoneWhereSheetsMeetOrTrianglesStandAlone) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(300), tests::soup(60), tests::duplicates(300)}) {
    const BuildTile tile = tests::tile_of(mesh);
    CollapseMesh collapsing(tile.mesh);
    EdgeStar star;
    OneSide side;
    for (const std::uint32_t e : tests::live_edges(collapsing)) {
      star.gather(collapsing, collapsing.edge(e).a, collapsing.edge(e).b);
      ASSERT_FALSE(side.find(star));
    }
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
