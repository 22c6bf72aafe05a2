// Charts: each cell in one of them, apart in their pictures, turned and scattered.
#include "bench/chart_atlas.h"

#include "bench/base_surface.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using testing::Each;
using testing::HasSubstr;

PatchGrid torus_grid(std::uint32_t cells) {
  return {BaseSurface(BaseShape::torus).patches(), cells};
}

std::vector<PlacedChart> charts_of(const ChartAtlas& atlas) {
  std::vector<PlacedChart> charts;
  for (std::uint32_t image = 0; image < atlas.options().images; ++image) {
    for (std::uint32_t row = 0; row < atlas.slots_a_row(); ++row) {
      for (std::uint32_t column = 0; column < atlas.slots_a_row(); ++column) {
        if (const auto chart = atlas.chart(image, column, row))
          charts.push_back(*chart);
      }
    }
  }
  return charts;
}

TEST(ChartAtlasTest, EachCellIsInOneChart) {
  for (const std::uint32_t cells : {1U, 2U, 7U, 20U}) {
    const PatchGrid grid = torus_grid(cells);
    const ChartAtlas atlas(grid, {.images = 3, .side = 1024, .charts = 300});
    std::vector<int> seen(std::size_t{grid.patch_count()} * cells * cells);
    for (const PlacedChart& chart : charts_of(atlas)) {
      for (std::uint32_t row = chart.cells.row_begin; row < chart.cells.row_end; ++row) {
        for (std::uint32_t c = chart.cells.column_begin; c < chart.cells.column_end; ++c)
          ++seen[(std::size_t{chart.cells.patch} * cells + row) * cells + c];
      }
    }
    EXPECT_THAT(seen, Each(1)) << cells;
  }
}

TEST(ChartAtlasTest, ChartsAreApartWithTheirGutters) {
  const ChartAtlas atlas(torus_grid(20), {.images = 3, .side = 512, .charts = 150, .gutter = 3});
  std::vector<std::vector<int>> covered(3, std::vector<int>(512 * 512));
  for (const PlacedChart& chart : charts_of(atlas)) {
    for (std::uint32_t y = chart.y - 3; y < chart.y + chart.side + 3; ++y) {
      for (std::uint32_t x = chart.x - 3; x < chart.x + chart.side + 3; ++x)
        ++covered[chart.image].at(y * 512 + x);
    }
  }
  for (const auto& image : covered)
    EXPECT_LE(*std::max_element(image.begin(), image.end()), 1);
}

TEST(ChartAtlasTest, PlacesComeBackAndAreNotMirrored) {
  const ChartAtlas atlas(torus_grid(20), {.images = 2, .side = 512, .charts = 100});
  std::set<std::uint32_t> turns;
  for (const PlacedChart& chart : charts_of(atlas)) {
    turns.insert(chart.turns);
    const TexelPlace origin = chart.texel_of({0, 0});
    const TexelPlace right = chart.texel_of({1, 0}), up = chart.texel_of({0, 1});
    // Texels go down: seen upright, columns turn to rows counter-clockwise.
    const double turn =
        (right.x - origin.x) * (up.y - origin.y) - (right.y - origin.y) * (up.x - origin.x);
    EXPECT_LT(turn, 0);
    const ChartPlace back = chart.place_of(chart.texel_of({0.25, 0.75}));
    EXPECT_NEAR(back.column, 0.25, 1e-9);
    EXPECT_NEAR(back.row, 0.75, 1e-9);
    const ChartPlace a = chart.place_of({chart.x + 0.5, chart.y + 0.5});
    const ChartPlace b = chart.place_of({chart.x + 7.5, chart.y + 0.5});
    EXPECT_EQ(a.row == b.row, chart.rows_stay_rows());
    EXPECT_EQ(a.column == b.column, !chart.rows_stay_rows());
  }
  EXPECT_EQ(turns.size(), 4U);
}

TEST(ChartAtlasTest, NeighboursAreScattered) {
  const ChartAtlas atlas(torus_grid(20), {.images = 4, .side = 1024, .charts = 256});
  const std::vector<PlacedChart> charts = charts_of(atlas);
  std::size_t neighbours = 0;
  for (std::size_t i = 1; i < charts.size(); ++i)
    neighbours += charts[i].cells.patch == charts[i - 1].cells.patch ? 1 : 0;
  EXPECT_LT(neighbours, charts.size() / 20);
}

TEST(ChartAtlasTest, NamesWhatIsOutOfRange) {
  const PatchGrid grid = torus_grid(20);
  const auto refusal = [&](const AtlasOptions& options) {
    return tests::usage_error([&] { const ChartAtlas atlas(grid, options); });
  };
  EXPECT_THAT(refusal({.images = 0}), HasSubstr("images must be from 1 to 10000, found 0"));
  EXPECT_THAT(refusal({.side = 63}), HasSubstr("side must be"));
  EXPECT_THAT(refusal({.charts = 0}), HasSubstr("charts must be"));
  EXPECT_THAT(refusal({.gutter = 65}), HasSubstr("gutter must be"));
  EXPECT_THAT(refusal({.side = 64, .charts = 1000}), HasSubstr("ask for fewer charts"));
}

}  // namespace
}  // namespace meshhier::bench
