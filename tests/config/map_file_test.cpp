#include "config/map_file.h"

#include "tests/support/error_message.h"

#include <array>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::config {
namespace {

using testing::HasSubstr;
using Numbers = std::array<double, 3>;

std::string map_refusal(const std::string& text) {
  const std::string message = tests::usage_error([&] { parse_map_file(text); });
  EXPECT_NE(message, "") << "accepted: " << text;
  return message;
}

void expect_map(const std::string& text, const std::optional<std::string>& crs,
                const std::optional<Numbers>& offset) {
  const MapFile file = parse_map_file(text);
  EXPECT_EQ(file.crs, crs) << text;
  EXPECT_EQ(file.offset, offset) << text;
}

TEST(MapFile, ReadsMetadataXml) {
  expect_map(
      "\xef\xbb\xbf<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n"
      "<ModelMetadata version=\"1\">\r\n"
      "\t<!--Spatial Reference System-->\r\n"
      "\t<SRS> EPSG:32633 </SRS>\r\n"
      "\t<!--Origin in Spatial Reference System-->\r\n"
      "\t<SRSOrigin>500000.5,5300000,-12</SRSOrigin>\r\n"
      "</ModelMetadata>\r\n",
      "EPSG:32633", Numbers{500000.5, 5300000, -12});
  expect_map("<M><SRSOrigin>1 2 3</SRSOrigin></M>", std::nullopt, Numbers{1, 2, 3});
  expect_map("<M><SRS>PROJCS[&quot;a &lt;&amp;&gt; b&apos;&quot;]</SRS></M>",
             "PROJCS[\"a <&> b'\"]", std::nullopt);
}

TEST(MapFile, ReadsAPlaceInMetadataXml) {
  const MapFile file =
      parse_map_file("<M><SRS>ENU:48.5,-11.25</SRS><SRSOrigin>1,2,3</SRSOrigin></M>");
  EXPECT_EQ(file.crs, std::nullopt);
  EXPECT_EQ(file.place, (MapPlace{48.5, -11.25}));
  EXPECT_EQ(file.offset, (Numbers{1, 2, 3}));
  for (const char* place : {"ENU:", "ENU:48.5", "ENU:91,0", "ENU:0,-180.5", "ENU:nan,0", "ENU:a,b"})
    EXPECT_THAT(map_refusal("<SRS>" + std::string(place) + "</SRS>"),
                HasSubstr("expected a latitude and a longitude"));
}

TEST(MapFile, ReadsTheCoordinatesOfOpenDroneMap) {
  expect_map("WGS84 UTM 32N\n512345 5401234\n1.5 2.5 3.5\n4 5 6\n", "EPSG:32632",
             Numbers{512345, 5401234, 0});
  expect_map("WGS84 UTM 7S\r\n512345.5 5401234.25 100\r\n", "EPSG:32707",
             Numbers{512345.5, 5401234.25, 100});
  expect_map("+proj=utm +zone=32 +datum=WGS84\n1 2\n", "+proj=utm +zone=32 +datum=WGS84",
             Numbers{1, 2, 0});
  expect_map("EPSG:25832\n", "EPSG:25832", std::nullopt);
}

TEST(MapFile, ReadsOffsetsAndWkt) {
  expect_map("691000.000 5340000.000 500.000\n", std::nullopt, Numbers{691000, 5340000, 500});
  expect_map("\n 691000;5340000;+5e2", std::nullopt, Numbers{691000, 5340000, 500});
  expect_map("691000\n5340000\n500\n", std::nullopt, Numbers{691000, 5340000, 500});
  expect_map("PROJCS[\"x\",\n GEOGCS[\"y\"]]\n", "PROJCS[\"x\",\n GEOGCS[\"y\"]]", std::nullopt);
  expect_map("COMPD_CS [\"x\"]", "COMPD_CS [\"x\"]", std::nullopt);
}

TEST(MapFile, RefusesWhatIsNoneOfThem) {
  EXPECT_THAT(map_refusal(""), HasSubstr("an empty file"));
  EXPECT_THAT(map_refusal(" \r\n\t"), HasSubstr("an empty file"));
  EXPECT_THAT(map_refusal("<html></html>"), HasSubstr("found neither"));
  EXPECT_THAT(map_refusal("<SRS>EPSG:32633"), HasSubstr("<SRS> has no end"));
  EXPECT_THAT(map_refusal("<SRSOrigin>1,2,x</SRSOrigin>"),
              HasSubstr("in <SRSOrigin>, found '1,2,x'"));
  EXPECT_THAT(map_refusal("<SRSOrigin>1,2,3,4</SRSOrigin>"), HasSubstr("two or three numbers"));
  EXPECT_THAT(map_refusal("<SRSOrigin>1,2,nan</SRSOrigin>"), HasSubstr("two or three numbers"));
  EXPECT_THAT(map_refusal("<SRSOrigin>1,1e999</SRSOrigin>"), HasSubstr("two or three numbers"));
  EXPECT_THAT(map_refusal("WGS84 UTM 61N\n1 2\n"), HasSubstr("a zone of UTM from 1 to 60"));
  EXPECT_THAT(map_refusal("WGS84 UTM 32N\nhello\n"), HasSubstr("in the second line"));
  EXPECT_THAT(map_refusal(std::string("EPSG:1\n\0\x1b", 9)), HasSubstr("found '"));
}

// Entities that a file declares itself are text like any other: nothing grows.
TEST(MapFile, ExpandsNoEntitiesOfTheFileItself) {
  expect_map("<!DOCTYPE a [<!ENTITY b \"cccc\">]><SRS>&b;&b;&amp;b;</SRS>", "&b;&b;&b;",
             std::nullopt);
}

}  // namespace
}  // namespace meshhier::config
