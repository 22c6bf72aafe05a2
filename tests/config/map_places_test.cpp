#include "config/map_places.h"

#include "config/placement.h"
#include "tests/support/error_message.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::config {
namespace {

using testing::HasSubstr;

const BoundsD kBox{{-50, -40, 0}, {50, 40, 20}};

Config on_map(const std::string& more) {
  return parse_config(R"({"input": "a.ply", "output": "a.hier", )" + more + "}", {"c", {}}, {});
}

MapPlaces places_of(const Config& config, const std::string& crs) {
  return {config, kBox, tileset_transform(config, kBox), crs};
}

TEST(MapPlaces, OfTheMapThatTheModelIsOn) {
  const Config config =
      on_map(R"("up": "z", "placement": {"crs": "EPSG:32633", "offset": [500000, 5300000, 0]})");
  const Vec3d same = places_of(config, "EPSG:32633").to_input(500012.5, 5299990);
  EXPECT_NEAR(same.x, 12.5, 1e-6);
  EXPECT_NEAR(same.y, -10, 1e-6);
  // The central meridian is easting 500000.
  const Vec3d degrees = places_of(config, "EPSG:4326").to_input(15, 47.8527);
  EXPECT_NEAR(degrees.x, 0, 1e-6);
  EXPECT_LT(std::abs(degrees.y), 100) << "longitude comes first";
  const Vec3d web = places_of(config, "EPSG:3857").to_input(1669792.3618991, 6085000);
  EXPECT_NEAR(web.x, 0, 1e-4);
}

TEST(MapPlaces, InTheUnitsOfTheInput) {
  const Config config = on_map(
      R"("up": "z", "units": "cm", "placement": {"crs": "EPSG:32633", "offset": [500000, 5300000, 0]})");
  EXPECT_NEAR(places_of(config, "EPSG:32633").to_input(500012.5, 5300000).x, 1250, 1e-4);
}

TEST(MapPlaces, OfWhatStandsOnTheGlobe) {
  const Config config =
      on_map(R"("up": "y", "placement": {"longitude": 13.4, "latitude": 52.5, "height": 40})");
  const MapPlaces places = places_of(config, "EPSG:4326");
  EXPECT_LT(length(places.to_input(13.4, 52.5) - Vec3d{0, 0, 0}), 1e-5)
      << "at the middle height of the box";
  // 111.3 km a degree of latitude there, 67.9 km one of longitude.
  EXPECT_NEAR(places.to_input(13.4, 52.5001).y, 11.13, 0.02);
  EXPECT_NEAR(places.to_input(13.4001, 52.5).x, 6.79, 0.02);
}

TEST(MapPlaces, WhatStandsNowhereHasNone) {
  const auto refused = [](const Config& config, const std::string& crs) -> std::string {
    return tests::usage_error([&] { places_of(config, crs); });
  };
  EXPECT_THAT(refused(on_map(R"("up": "z")"), "EPSG:4326"), HasSubstr("stands on no map"));
  const Config config = on_map(R"("up": "z", "placement": {"crs": "EPSG:32633"})");
  EXPECT_THAT(refused(config, "EPSG:0"), HasSubstr("PROJ knows no CRS"));
  EXPECT_THAT(refused(config, "+proj=utm +zone=33 +init=/etc/x"), HasSubstr("names files"));
  const MapPlaces places = places_of(config, "EPSG:4326");
  EXPECT_THROW(places.to_input(15, 1e9), Error);
}

}  // namespace
}  // namespace meshhier::config
