#include "bench/shading_comparison.h"

#include "base/error.h"
#include "tests/bench/built_surface.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

namespace meshhier::bench {
namespace {

using testing::SizeIs;

/// Smooth, and with normals.
const storage::HierarchyReader& smooth() {
  static const BuiltSurface built({.triangles = 8000, .height = 0, .normals = true});
  return built.reader();
}
const storage::HierarchyReader& without_normals() {
  static const BuiltSurface built({.triangles = 8000, .offset = {5000000.25, 0, 7}},
                                  config::Normals::none);
  return built.reader();
}

ShadingOptions small_pictures() {
  return {.size = 64, .views = 3};
}

TEST(ShadingComparisonTest, TheOriginalDiffersFromItsFacetsOnly) {
  const ShadingComparison result = compare_shading(smooth(), small_pictures());
  EXPECT_EQ(result.normals, "given");
  ASSERT_THAT(result.rows, SizeIs(5));
  const ShadingRow& last = result.rows.back();
  EXPECT_EQ(last.own.degrees, 0);
  EXPECT_EQ(last.own.luminance, 0);
  EXPECT_GT(last.facets.degrees, 0.5);
  EXPECT_GT(last.facets.luminance, 0.2);
  EXPECT_EQ(last.triangles, smooth().manifest().source.triangles);
}

TEST(ShadingComparisonTest, ASmoothSurfaceIsSmoothAtEachLevel) {
  const ShadingComparison result = compare_shading(smooth(), small_pictures());
  for (std::size_t i = 0; i + 1 < result.rows.size(); ++i) {
    const ShadingRow& row = result.rows[i];
    EXPECT_EQ(raw(row.level), i);
    EXPECT_LT(row.own.degrees, row.facets.degrees / 2) << i;
    EXPECT_LT(row.own.luminance, row.facets.luminance / 2) << i;
    EXPECT_GT(row.facets.degrees, result.rows[i + 1].facets.degrees) << i;
    EXPECT_LT(row.triangles, result.rows[i + 1].triangles) << i;
  }
}

TEST(ShadingComparisonTest, WithoutNormalsFacetsAreCompared) {
  // It has an origin, too: far from there, nothing would be seen.
  const ShadingComparison result = compare_shading(without_normals(), small_pictures());
  EXPECT_EQ(result.normals, "none");
  for (const ShadingRow& row : result.rows) {
    EXPECT_EQ(row.own.degrees, row.facets.degrees);
    EXPECT_EQ(row.own.luminance, row.facets.luminance);
  }
  EXPECT_EQ(result.rows.back().own.degrees, 0);
  EXPECT_GT(result.rows.front().own.degrees, 1);
}

TEST(ShadingComparisonTest, OneLevelIsThatOfAll) {
  ShadingOptions options = small_pictures();
  const ShadingComparison all = compare_shading(smooth(), options);
  options.level = Level{2};
  const ShadingComparison one = compare_shading(smooth(), options);
  ASSERT_THAT(one.rows, SizeIs(1));
  EXPECT_EQ(one.rows[0].own.degrees, all.rows[2].own.degrees);
  EXPECT_EQ(one.rows[0].facets.luminance, all.rows[2].facets.luminance);
  options.level = Level{9};
  EXPECT_THROW(compare_shading(smooth(), options), Error);
}

TEST(ShadingComparisonTest, PicturesAndFiguresAreEqualForAnyNumberOfThreads) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<std::pair<std::string, std::vector<std::byte>>> pictures;
    const ShadingComparison result = compare_shading(
        smooth(), small_pictures(),
        [&](const NamedPicture& picture) { pictures.emplace_back(picture.name, picture.png); });
    return std::pair(json_text("smooth", result), pictures);
  };
  const auto alone = run(1);
  EXPECT_EQ(alone, run(4));
  ASSERT_THAT(alone.second, SizeIs(3 * 11));
  EXPECT_EQ(alone.second[0].first, "view1_original.png");
  EXPECT_EQ(alone.second[1].first, "view1_level0_own.png");
  EXPECT_EQ(alone.second[32].first, "view3_level4_facets.png");
  for (const auto& [name, png] : alone.second)
    EXPECT_EQ(png.at(1), std::byte{'P'}) << name;
}

TEST(ShadingComparisonTest, IsTold) {
  const ShadingComparison result{
      "given", {.size = 64, .views = 3}, {{Level{1}, 20, {1.234, 2.345}, {3.456, 4.567}}}};
  EXPECT_EQ(markdown("a.hier", result),
            "### a.hier: 3 views of 64 x 64 pixels, normals: given\n\n"
            "| level | triangles | degrees, own normals | facets | luminance, own normals | facets "
            "|\n|---:|---:|---:|---:|---:|---:|\n| 1 | 20 | 1.23 | 3.46 | 2.35 | 4.57 |\n");
  const auto json = nlohmann::json::parse(json_text("a.hier", result));
  EXPECT_EQ(json["normals"], "given");
  EXPECT_EQ(json["levels"][0]["triangles"], 20);
  EXPECT_EQ(json["levels"][0]["own"]["degrees"], 1.234);
  EXPECT_EQ(json["levels"][0]["facets"]["luminance"], 4.567);
}

}  // namespace
}  // namespace meshhier::bench
