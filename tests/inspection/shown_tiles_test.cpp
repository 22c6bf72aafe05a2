#include "inspection/shown_tiles.h"

#include "render/tile_facets.h"
#include "tests/bench/built_surface.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using Point = std::array<float, 3>;

Point point(Vec3f p) {
  return {p.x, p.y, p.z};
}

/// How often each edge of a level is run along, less how often its opposite is.
std::map<std::pair<Point, Point>, int> edge_balance(const storage::HierarchyReader& reader,
                                                    Level level) {
  std::map<std::pair<Point, Point>, int> balance;
  inspection::ShownTiles surface(reader, Cut::of_level(reader.tree(), level));
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const inspection::ShownTile shown = surface.load(i);
    for (const render::Facet& facet :
         render::facets_of(shown.tile, {}, shown.border, render::NormalKind::own)) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Point a = point(facet[c].position), b = point(facet[(c + 1) % 3].position);
        a < b ? ++balance[{a, b}] : --balance[{b, a}];
      }
    }
  }
  return balance;
}

TEST(ShownTilesTest, EachLevelOfAClosedSurfaceIsClosed) {
  const BuiltSurface built({.triangles = 8000});
  const storage::HierarchyReader& reader = built.reader();
  const Level above = coarser(reader.tree().depth());
  ASSERT_TRUE(reader.tree().is_early({above, 7})) << "there are early nodes";
  for (std::uint8_t level = 0; level <= raw(reader.tree().depth()); ++level) {
    const auto balance = edge_balance(reader, Level{level});
    EXPECT_GT(balance.size(), 300U);
    for (const auto& [edge, count] : balance)
      ASSERT_EQ(count, 0) << "level " << int{level};
  }
}

}  // namespace
}  // namespace meshhier::bench
