#include "drawing/paper.h"

#include "drawing/levels.h"
#include "drawing/stroke_font.h"
#include "drawing/strokes.h"
#include "tests/support/error_message.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::drawing {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr BoundsD kRoom{{-2, 1, 0}, {8, 6, 3}};
constexpr SheetUnit kMetres{1, "m"};

template <class Make>
std::string fault_of(const Make& make) {
  return tests::usage_error(make);
}

TEST(PaperTest, LengthsAreRound) {
  EXPECT_EQ(round_length(1), 1);
  EXPECT_EQ(round_length(0.99), 0.5);
  EXPECT_EQ(round_length(4.9), 2);
  EXPECT_EQ(round_length(5), 5);
  EXPECT_EQ(round_length(99), 50);
  EXPECT_EQ(round_length(0.0003), 0.0002);
  EXPECT_EQ(round_length(1e7), 1e7);
}

TEST(PaperTest, CoordinatesHaveTheDigitsOfTheirStep) {
  EXPECT_EQ(coordinate_text(5300020, 20), "5300020");
  EXPECT_EQ(coordinate_text(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(coordinate_text(-0.0, 0.5), "0.0");
  EXPECT_EQ(coordinate_text(-1e-17, 0.5), "0.0");
  EXPECT_EQ(coordinate_text(7.5, 2.5), "7.5");
}

TEST(PaperTest, AScaleSaysWhereThingsLie) {
  const Paper paper = paper_for(kRoom, kMetres, {.scale = 50});
  EXPECT_DOUBLE_EQ(paper.inner_width, 200);
  EXPECT_DOUBLE_EQ(paper.inner_height, 100);
  const PlanPoint corner = paper.on_paper(-2, 6), other = paper.on_paper(8, 1);
  EXPECT_DOUBLE_EQ(corner.x, paper.margin);
  EXPECT_DOUBLE_EQ(corner.y, paper.margin);
  EXPECT_DOUBLE_EQ(other.x - corner.x, 200);
  EXPECT_DOUBLE_EQ(other.y - corner.y, 100);
}

TEST(PaperTest, WithoutAScaleItFitsOnA4) {
  const Paper paper = paper_for(kRoom, kMetres, {});
  EXPECT_EQ(paper.scale, 50);
  EXPECT_LE(paper.width, 297);
  EXPECT_LE(paper.height, 210);
}

TEST(PaperTest, TheGridHasRoundCoordinates) {
  const Paper paper = paper_for(kRoom, kMetres, {.scale = 100, .has_grid = true, .grid = 5});
  std::vector<std::string> texts;
  for (const PaperText& text : paper.marks.texts)
    texts.push_back(text.text);
  EXPECT_THAT(texts, ElementsAre("0", "5", "5", "0", "4 m", "1:100"));
  ASSERT_EQ(paper.marks.grid.size(), 3U);
  EXPECT_DOUBLE_EQ(paper.marks.grid[0].from.x, paper.on_paper(0, 0).x);
  EXPECT_DOUBLE_EQ(paper.marks.grid[2].from.y, paper.on_paper(0, 5).y);
}

TEST(PaperTest, WhatCannotBeIsRefusedWithWhatCan) {
  EXPECT_THAT(fault_of([] { paper_for(kRoom, {}, {}); }), HasSubstr("--units"));
  EXPECT_THAT(fault_of([] { paper_for(kRoom, kMetres, {.scale = 1e9}); }),
              HasSubstr("give one from 100:1"));
  EXPECT_THAT(fault_of([] { paper_for(kRoom, kMetres, {.scale = 1e-9}); }),
              HasSubstr("to 1:10000"));
  EXPECT_THAT(
      fault_of([] { paper_for(kRoom, kMetres, {.scale = 50, .has_grid = true, .grid = 1e-9}); }),
      HasSubstr("more than 2000 lines"));
  EXPECT_THAT(fault_of([] {
                paper_for({{1, 1, 1}, {1, 1, 1}}, kMetres, {});
              }),
              HasSubstr("a point"));
}

TEST(LevelsTest, OnALevelCountsAsAbove) {
  const CutLevels levels({2, 1, 3, 2});
  ASSERT_EQ(levels.size(), 3U);
  const auto count = [&](double low, double high) {
    const LevelRange range = levels.between(low, high);
    return range.end - range.begin;
  };
  EXPECT_EQ(count(1, 2), 1U);
  EXPECT_EQ(count(2, 2), 0U);
  EXPECT_EQ(count(0.5, 3), 3U);
  EXPECT_EQ(count(1, 1.5), 0U);
}

TEST(LevelsTest, EachFifthContourIsAnIndex) {
  const CutLevels levels = CutLevels::contours(10, -61, 105);
  EXPECT_EQ(levels[0].height, -60);
  EXPECT_EQ(levels[levels.size() - 1].height, 100);
  for (const CutLevel& level : levels.all())
    EXPECT_EQ(level.is_index, static_cast<int>(level.height) % 50 == 0) << level.height;
  EXPECT_THAT(fault_of([] { CutLevels::contours(1e-9, 0, 100); }),
              HasSubstr("give 0.0011 or more"));
  EXPECT_TRUE(CutLevels::contours(1000, 1, 2).empty());
}

TEST(StrokesTest, WindowsAreSeamless) {
  const render::PlanWindow whole{0, 0, 40, 30}, left{0, 0, 17, 30}, right{17, 0, 23, 30};
  const auto pixels_of = [](const render::PlanWindow& window) {
    StrokeMask mask(window);
    mask.draw({2.3, 28}, {36, 1.5}, 3.5);
    mask.draw({10, 5}, {30, 5}, 0.4);
    std::vector<std::uint8_t> pixels(std::size_t{4} * window.width * window.height, 255);
    mask.lay_on(pixels, {0, 0, 0});
    return pixels;
  };
  const auto all = pixels_of(whole), west = pixels_of(left), east = pixels_of(right);
  std::uint64_t ink = 0;
  for (std::size_t y = 0; y < 30; ++y) {
    for (std::size_t x = 0; x < 40; ++x) {
      const std::uint8_t part = x < 17 ? west[4 * (y * 17 + x)] : east[4 * (y * 23 + x - 17)];
      ASSERT_EQ(all[4 * (y * 40 + x)], part) << x << ' ' << y;
      ink += 255U - part;
    }
  }
  // The line's length times its width, its round ends, and the thin one's two fifths.
  EXPECT_NEAR(static_cast<double>(ink) / 255, 42.85 * 3.5 + 9.6 + 20 * 0.4, 4);
}

TEST(StrokesTest, LettersOfNumbersAndUnitsAreThere) {
  for (const char letter : std::string("0123456789.:+-mckinftus_e")) {
    int strokes = 0;
    for_each_stroke(std::string(1, letter), [&](PlanPoint, PlanPoint) { ++strokes; });
    EXPECT_GT(strokes, 0) << letter;
  }
}

}  // namespace
}  // namespace meshhier::drawing
