#include "geodesy/raster_map.h"

#include "base/error.h"
#include "tests/support/error_message.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::geodesy {
namespace {

using ::testing::HasSubstr;

/// Keys of a file; numbers and texts lie behind them.
struct SampleKeys {
  std::vector<std::uint16_t> entries;  ///< four each
  std::vector<double> doubles{};
  std::string text{};

  RasterMap parse() const {
    std::vector<std::uint16_t> all{1, 1, 0, static_cast<std::uint16_t>(entries.size() / 4)};
    all.insert(all.end(), entries.begin(), entries.end());
    return raster_map_of({all, doubles, text});
  }
  std::string refusal() const {
    return tests::error_message(ErrorCode::input, [&] { parse(); });
  }
};

TEST(RasterMap, OfAMapAndItsHeights) {
  const RasterMap keys = SampleKeys{{1024, 0, 1, 1,    1025, 0, 1, 2,   3072, 0, 1, 32633,  //
                                     3076, 0, 1, 9001, 4096, 0, 1, 5773}}
                             .parse();
  EXPECT_EQ(keys.kind, MapKind::lengths);
  EXPECT_EQ(keys.crs, "EPSG:32633+5773");
  EXPECT_TRUE(keys.is_point);
  EXPECT_EQ(keys.unit, 1);
}

TEST(RasterMap, OfDegreesAndOfNothing) {
  const RasterMap keys = SampleKeys{{1024, 0, 1, 2, 2048, 0, 1, 4258, 2054, 0, 1, 9105}}.parse();
  EXPECT_EQ(keys.kind, MapKind::degrees);
  EXPECT_EQ(keys.crs, "EPSG:4258");
  EXPECT_EQ(keys.unit, 0.9);
  EXPECT_EQ(raster_map_of({}).kind, MapKind::unknown);
  EXPECT_EQ(SampleKeys{}.parse().kind, MapKind::unknown);
}

TEST(RasterMap, FeetAndOldVerticalCodes) {
  const RasterMap keys = SampleKeys{
      {3072, 0, 1, 2263, 3076, 0, 1, 9003, 4096, 0, 1, 5103,  //
       4099, 0, 1, 9002}}.parse();
  EXPECT_EQ(keys.crs, "EPSG:2263+5703");
  EXPECT_DOUBLE_EQ(keys.unit, 1200.0 / 3937);
  EXPECT_EQ(keys.height_unit, 0.3048);
  EXPECT_EQ((SampleKeys{{3072, 0, 1, 32633, 4096, 0, 1, 5030}}.parse().crs), "EPSG:32633");
}

/// GDAL writes no unit beside it.
TEST(RasterMap, AVerticalCrsTellsItsUnit) {
  const auto keys_with = [](std::uint16_t vertical) {
    return SampleKeys{{3072, 0, 1, 26910, 4096, 0, 1, vertical}}.parse();
  };
  EXPECT_EQ(keys_with(6360).crs, "EPSG:26910+5703");
  EXPECT_EQ(keys_with(6360).height_unit, 1200.0 / 3937);
  EXPECT_EQ(keys_with(8228).height_unit, 0.3048);
  EXPECT_EQ(keys_with(5702).crs, "EPSG:26910+7968");
  EXPECT_EQ(keys_with(6130).crs, "EPSG:26910");
  EXPECT_EQ(keys_with(6130).height_unit, 0.3048);
  EXPECT_EQ(keys_with(5703).height_unit, 1);
  EXPECT_EQ(keys_with(5103).height_unit, std::nullopt);
}

TEST(RasterMap, UserDefinedOnesHaveWktOrNone) {
  const std::string text = "ESRI PE String = PROJCS[\"x\"]|";
  const RasterMap keys =
      SampleKeys{{3072, 0, 1, 32767, 3073, 34737, static_cast<std::uint16_t>(text.size()), 0,  //
                  3076, 0, 1, 32767, 3077, 34736, 1, 0},
                 {0.25},
                 text}
          .parse();
  EXPECT_EQ(keys.crs, "PROJCS[\"x\"]");
  EXPECT_EQ(keys.unit, 0.25);
  const RasterMap none = SampleKeys{{3072, 0, 1, 32767}}.parse();
  EXPECT_EQ(none.crs, "");
  EXPECT_TRUE(none.is_user_defined);
}

/// So ESRI's programs write a projection that they have no code for.
TEST(RasterMap, WktAloneTellsAProjection) {
  const std::string text = "ESRI PE String = PROJCS[\"x\"]|";
  const RasterMap keys =
      SampleKeys{{1024, 0, 1, 32767, 2048, 0, 1, 32767,  //
                  3073, 34737, static_cast<std::uint16_t>(text.size()), 0, 3076, 0, 1, 9001},
                 {},
                 text}
          .parse();
  EXPECT_EQ(keys.kind, MapKind::lengths);
  EXPECT_EQ(keys.crs, "PROJCS[\"x\"]");
  EXPECT_EQ(keys.unit, 1);
}

TEST(RasterMap, ACodeStandsWithoutItsHeights) {
  EXPECT_EQ(horizontal_code("EPSG:32633+5773"), "EPSG:32633");
  EXPECT_EQ(horizontal_code("EPSG:32633"), "EPSG:32633");
  EXPECT_EQ(horizontal_code("PROJCS[\"a+b\"]"), "PROJCS[\"a+b\"]");
}

TEST(RasterMap, LiesAreToldOf) {
  EXPECT_THAT(SampleKeys({{3072, 0, 1, 32767, 3076, 0, 1, 32767, 3077, 34736, 1, 5}}).refusal(),
              HasSubstr("key 3077 names a number that is not there"));
  EXPECT_THAT(SampleKeys({{3072, 0, 1, 32767, 3073, 34737, 60000, 9}}).refusal(),
              HasSubstr("names a text that is not there"));
  EXPECT_THAT(SampleKeys({{3072, 0, 1, 2263, 3076, 0, 1, 77}}).refusal(), HasSubstr("EPSG:77"));
  EXPECT_THAT(SampleKeys({{1024, 0, 1, 3}}).refusal(), HasSubstr("geocentric"));
  const std::vector<std::uint16_t> cut{1, 1, 0, 3, 1024, 0, 1, 1};
  EXPECT_THROW(raster_map_of({cut, {}, {}}), Error);
  const std::vector<std::uint16_t> other{2, 1, 0, 0};
  EXPECT_THROW(raster_map_of({other, {}, {}}), Error);
}

}  // namespace
}  // namespace meshhier::geodesy
