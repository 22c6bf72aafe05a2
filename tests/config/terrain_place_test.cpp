// Where a hierarchy of heights stands, by what the rasters say and what the config does.
#include "base/error.h"
#include "config/input_frame.h"
#include "support/gzip.h"
#include "support/sample_tiff.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::config {
namespace {

using testing::HasSubstr;

class TerrainPlaceTest : public testing::Test {
 protected:
  TerrainPlaceTest() {
    put("map", {});
    put("degrees", {.scale = {0.25, 0.25, 0},
                    .tie = {0, 0, 0, 14, 48, 0},
                    .keys = {1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326}});
  }

  void put(const std::string& name, const tests::TiffForm& form) {
    tests::put_tiff<float>(files_, "/models/" + name + ".tif", form, 2,
                           std::vector<float>{1, 2, 3, 4});
  }

  Config placed(const std::string& input, const std::string& more = "") {
    return with_input_frame(
        files_, parse_config(R"({"input": ")" + input + R"(", "output": "a.hier")" + more + "}",
                             {"config.json", "/models"}, {}));
  }

  tests::MemoryFiles files_;
};

TEST_F(TerrainPlaceTest, LengthsStandOnTheirMap) {
  const Config config = placed("map.tif");
  EXPECT_EQ(config.placement.crs, "EPSG:32633");
  EXPECT_EQ(config.units, Unit::m);
  EXPECT_EQ(config.up, UpAxis::z);
}

TEST_F(TerrainPlaceTest, DegreesStandAtTheirMiddle) {
  const Config config = placed("degrees.tif");
  EXPECT_EQ(config.placement.longitude, 14.25);
  EXPECT_EQ(config.placement.latitude, 47.75);
  EXPECT_EQ(config.placement.crs, std::nullopt);
}

TEST_F(TerrainPlaceTest, DegreesStandOnTheMapThatIsAskedFor) {
  const Config config = placed("degrees.tif", R"(, "placement": {"crs": "EPSG:32633"})");
  EXPECT_EQ(config.placement.crs, "EPSG:32633");
  EXPECT_EQ(config.placement.longitude, std::nullopt);
  EXPECT_EQ(config.units, Unit::m);
  EXPECT_EQ(config.up, UpAxis::z);
  try {
    placed("degrees.tif", R"(, "placement": {"metadata": "offset.xyz"})");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("degrees.tif lies in degrees"));
  }
}

TEST_F(TerrainPlaceTest, PackedHeightsSayWhereTheyLie) {
  files_.put("/models/N48E014.hgt.gz", tests::gzip(std::string(2 * 1201 * 1201, '\1')));
  const Config config = placed("N48E014.hgt.gz");
  EXPECT_EQ(config.placement.longitude, 14.5);
  EXPECT_EQ(config.placement.latitude, 48.5);
  EXPECT_EQ(config.up, UpAxis::z);
}

}  // namespace
}  // namespace meshhier::config
