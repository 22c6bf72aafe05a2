#include "geodesy/map_projection.h"

#include "base/error.h"
#include "tests/support/error_message.h"

#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::geodesy {
namespace {

using testing::HasSubstr;

constexpr const char* kUtm = "WGS 84 / UTM zone 33N";

MapProjection settled(const std::string& crs, Vec3d at) {
  MapProjection projection(crs);
  projection.settle_at(at);
  return projection;
}

/// The message of the usage error that a CRS must end with.
std::string refusal(const std::string& crs) {
  const std::string message = tests::usage_error([&] { const MapProjection projection(crs); });
  EXPECT_NE(message, "") << "accepted: " << crs;
  return message;
}

void expect_near(Vec3d found, Vec3d expected, double tolerance) {
  EXPECT_LT(length(found - expected), tolerance)
      << found.x << ' ' << found.y << ' ' << found.z << ", expected " << expected.x << ' '
      << expected.y << ' ' << expected.z;
}

struct Known {
  std::string crs;
  Vec3d map, geocentric;
};

// By cs2cs of PROJ 9.1.1.
TEST(MapProjection, IsThatOfPROJ) {
  const std::vector<Known> all = {
      {"EPSG:32633", {500000, 5300000, 300}, {4141912.5553, 1109822.1243, 4706171.9180}},
      {"EPSG:25832", {500000, 5300000, 300}, {4235230.7261, 670794.6482, 4706171.9181}},
      {"EPSG:2056", {2600000, 1200000, 300}, {4325159.0468, 564705.8321, 4638273.5208}},
      {"EPSG:27700", {530000, 180000, 300}, {3978477.7918, -8912.5905, 4968873.6421}},
      {"EPSG:31468", {4500000, 5400000, 300}, {4122537.8442, 876163.0699, 4771586.8098}},
      {"EPSG:32633+5773", {500000, 5300000, 300}, {4141942.8084, 1109830.2306, 4706206.5241}},
      {"EPSG:4978", {4141912, 1109822, 4706171}, {4141912, 1109822, 4706171}}};
  for (const Known& known : all) {
    SCOPED_TRACE(known.crs);
    MapProjection projection(known.crs);
    expect_near(projection.to_geocentric(known.map), known.geocentric, 0.001);
    projection.settle_at(known.map);
    expect_near(projection.to_geocentric(known.map), known.geocentric, 0.001);
  }
}

TEST(MapProjection, TellsWhatHeightsAreAbove) {
  EXPECT_EQ(MapProjection("EPSG:32633").heights(), kEllipsoid);
  EXPECT_EQ(MapProjection("+proj=utm +zone=33 +datum=WGS84").heights(), kEllipsoid);
  EXPECT_EQ(MapProjection("EPSG:32633+5773").heights(), "EGM96 height");
  EXPECT_EQ(MapProjection("EPSG:4978").heights(), "");
}

TEST(MapProjection, TakesPROJStringsAndWkt) {
  const Vec3d map{500000, 5300000, 300};
  const Vec3d place = MapProjection("EPSG:32633").to_geocentric(map);
  const std::string wkt =
      R"(PROJCS["WGS 84 / UTM zone 33N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",15],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])";
  for (const std::string& crs :
       {std::string("+proj=utm +zone=33 +datum=WGS84"),
        std::string("+proj=utm +zone=33 +datum=WGS84 +type=crs"), std::string(kUtm), wkt}) {
    expect_near(MapProjection(crs).to_geocentric(map), place, 1e-4);
  }
}

TEST(MapProjection, EastingIsFirstWhateverTheRegisterSays) {
  // EPSG:3045 has northing first, EPSG:25833 is the same map with easting first.
  const Vec3d map{500000, 5300000, 300};
  const MapProjection swapped = settled("EPSG:3045", map);
  expect_near(swapped.to_geocentric(map), settled("EPSG:25833", map).to_geocentric(map), 1e-4);
}

TEST(MapProjection, HeightsWithoutAVerticalCrsAreInTheUnitOfTheMap) {
  const MapProjection feet = settled("EPSG:2271", {2000000, 500000, 1000});
  const Geodetic place = feet.to_geodetic(feet.to_geocentric({2000000, 500000, 1000}));
  EXPECT_NEAR(place.height, 1000 * 1200.0 / 3937, 1e-3);
  EXPECT_NEAR(feet.unit_metres(), 1200.0 / 3937, 1e-12);
}

TEST(MapProjection, TellsHowGoodItIs) {
  const Vec3d map{500000, 5300000, 300};
  EXPECT_EQ(settled("EPSG:32633", map).accuracy(), 0);
  EXPECT_EQ(settled("EPSG:25832", map).accuracy(), 1);
  EXPECT_EQ(settled("EPSG:32633", map).name(), kUtm);
  EXPECT_FALSE(settled("EPSG:32633", map).takes_datum_as_wgs84());
  EXPECT_TRUE(settled("+proj=tmerc +lat_0=48 +lon_0=11 +ellps=WGS84", {}).takes_datum_as_wgs84());
}

TEST(MapProjection, KnowsWhereItIsMeantFor) {
  const MapProjection utm("EPSG:32633");
  EXPECT_TRUE(utm.is_meant_for({15, 48, 0}));
  EXPECT_FALSE(utm.is_meant_for({9, 48, 0}));
  EXPECT_FALSE(utm.is_meant_for({15, -1, 0}));
  // New Zealand's reaches over the 180th meridian.
  const MapProjection over("EPSG:2193");
  EXPECT_TRUE(over.is_meant_for({170, -45, 0}));
  EXPECT_FALSE(over.is_meant_for({15, 48, 0}));
  EXPECT_TRUE(MapProjection("+proj=utm +zone=33 +datum=WGS84").is_meant_for({100, 80, 0}));
}

TEST(MapProjection, RefusesWhatIsNoMap) {
  for (const char* degrees :
       {"EPSG:4326", "EPSG:4979", "EPSG:4326+5773", "+proj=longlat +datum=WGS84"})
    EXPECT_THAT(refusal(degrees), HasSubstr("a model in degrees is no shape")) << degrees;
  for (const char* unknown :
       {"EPSG:99999", "garbage", "", "EPSG:", "+proj=nothing", "PROJCS[\"x\"]"})
    EXPECT_THAT(refusal(unknown), HasSubstr("PROJ knows no CRS")) << unknown;
  const std::string local = R"(LOCAL_CS["Local",LOCAL_DATUM["Local",0],UNIT["metre",1]])";
  for (const std::string& placeless :
       {local, std::string("EPSG:5773"), std::string("IAU_2015:30110")})
    EXPECT_THAT(refusal(placeless), HasSubstr("without places on the globe")) << placeless;
  EXPECT_THAT(refusal("ENU:48,11"), HasSubstr("give its \"longitude\" and \"latitude\""));
  EXPECT_THAT(refusal("{\"type\": \"ProjectedCRS\"}"), HasSubstr("expected an EPSG code"));
  EXPECT_THAT(refusal(std::string("EPSG:32633\0x", 12)), HasSubstr("expected an EPSG code"));
  EXPECT_THAT(refusal(std::string(100'000, 'x')), HasSubstr("at most 65536 bytes"));
}

// PROJ would leave out the change of datum, too: a hundred metres in Switzerland.
TEST(MapProjection, RefusesHeightsWithoutTheirGrid) {
  EXPECT_THAT(refusal("EPSG:2056+5728"), HasSubstr("no grid for the heights"));
}

TEST(MapProjection, OpensNoFileThatATextNames) {
  for (const char* text :
       {"+proj=utm +zone=33 +datum=WGS84 +geoidgrids=/tmp/grid.gtx", "+init=/tmp/file:x",
        "+proj=utm +zone=33 +NADGRIDS=@../grid.gsb", "+init=epsg:32633",
        R"(PROJCS["x",EXTENSION["PROJ4","+proj=utm +nadgrids=/tmp/x"]])",
        R"(BOUNDCRS[ABRIDGEDTRANSFORMATION["x",PARAMETERFILE["y","z"]]])"}) {
    EXPECT_THAT(refusal(text), HasSubstr("names files")) << text;
  }
  EXPECT_NO_THROW(MapProjection("+proj=utm +zone=33 +datum=WGS84 +geoidgrids=egm96_15.gtx"));
  EXPECT_NO_THROW(MapProjection("+proj=utm +zone=33 +datum=WGS84 +units=us-ft"));
}

TEST(MapProjection, RefusesPointsThatAreNowhere) {
  const MapProjection projection("EPSG:32633");
  try {
    projection.to_geocentric({5e9, 5300000, 0});
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("is an \"offset\" missing"));
  }
}

TEST(MapProjection, SaysWhatToInstallWithoutPROJsDatabase) {
  ::setenv("PROJ_DATA", "/nonexistent", 1);
  try {
    const MapProjection projection("EPSG:32633");
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr("install the package proj-data"));
  }
  ::unsetenv("PROJ_DATA");
}

}  // namespace
}  // namespace meshhier::geodesy
