#include "config/placement.h"

#include "support/memory_files.h"
#include "tests/support/error_message.h"

#include <array>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using Numbers = std::array<double, 3>;

Config placed(const std::string& placement, const std::string& more = "\"up\": \"z\"") {
  return parse_config(
      R"({"input": "a.ply", "output": "a.hier", "placement": {)" + placement + "}, " + more + "}",
      {"config.json", "/models"}, {});
}

class PlacementTest : public testing::Test {
 protected:
  PlacementTest() {
    files_.put("/models/metadata.xml",
               "<M><SRS>EPSG:32633</SRS><SRSOrigin>500000,5300000,0</SRSOrigin></M>");
    files_.put("/models/offset.xyz", "500000 5300000 7\n");
    files_.put("/models/broken.xml", "<M></M>");
  }

  PlacementConfig whole(const std::string& placement) {
    return with_map(files_, placed(placement)).placement;
  }

  std::string refusal(const std::string& placement) {
    const std::string message = tests::usage_error([&] { whole(placement); });
    EXPECT_NE(message, "") << "accepted: " << placement;
    return message;
  }

  tests::MemoryFiles files_;
};

TEST_F(PlacementTest, MetadataGivesCrsAndOffset) {
  const PlacementConfig place = whole(R"("metadata": "metadata.xml")");
  EXPECT_EQ(place.metadata, "/models/metadata.xml");
  EXPECT_EQ(place.crs, "EPSG:32633");
  EXPECT_EQ(place.offset, (Numbers{500000, 5300000, 0}));
}

TEST_F(PlacementTest, WhatTheConfigSaysWins) {
  const PlacementConfig other = whole(R"("metadata": "metadata.xml", "crs": "EPSG:32632")");
  EXPECT_EQ(other.crs, "EPSG:32632");
  EXPECT_EQ(other.offset, (Numbers{500000, 5300000, 0}));
  const PlacementConfig moved = whole(R"("metadata": "metadata.xml", "offset": [1, 2, 3])");
  EXPECT_EQ(moved.crs, "EPSG:32633");
  EXPECT_EQ(moved.offset, (Numbers{1, 2, 3}));
  const PlacementConfig both = whole(R"("metadata": "offset.xyz", "crs": "EPSG:32632")");
  EXPECT_EQ(both.crs, "EPSG:32632");
  EXPECT_EQ(both.offset, (Numbers{500000, 5300000, 7}));
}

TEST_F(PlacementTest, TheResolvedConfigIsWholeWithoutTheFile) {
  const Config config = with_map(files_, placed(R"("metadata": "metadata.xml")"));
  EXPECT_EQ(resolved_json(config)["placement"].dump(),
            R"({"crs":"EPSG:32633","offset":[500000.0,5300000.0,0.0]})");
}

TEST_F(PlacementTest, RefusesFilesThatDoNotSayEnough) {
  EXPECT_THAT(
      refusal(R"("metadata": "offset.xyz")"),
      AllOf(StartsWith("placement.metadata: /models/offset.xyz"), HasSubstr("give it by \"crs\"")));
  EXPECT_THAT(refusal(R"("metadata": "broken.xml")"),
              AllOf(StartsWith("placement.metadata: /models/broken.xml"), HasSubstr("neither")));
  EXPECT_THROW(whole(R"("metadata": "missing.xml")"), Error);
}

TEST_F(PlacementTest, RefusesAWrongCrsBeforeAnythingIsRead) {
  EXPECT_THAT(refusal(R"("crs": "EPSG:99999")"), StartsWith("placement.crs: PROJ knows no CRS"));
  EXPECT_THAT(refusal(R"("crs": "")"), StartsWith("placement.crs: PROJ knows no CRS"));
}

// ---- the transform

Vec3d apply(const Transform& m, Vec3d p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

/// The place of easting 500000, northing 5300000, height 300 in EPSG:32633, by cs2cs.
constexpr Vec3d kPlace{4141912.5553, 1109822.1243, 4706171.9180};
const std::string kCrs = R"("crs": "EPSG:32633", "offset": [500000, 5300000, 200])";

BoundsD box_to(Vec3d from, Vec3d to) {
  BoundsD box;
  box.add(from);
  box.add(to);
  return box;
}

TEST(PlacementTransform, IsExactInTheMiddleOfTheBox) {
  const BoundsD box = box_to({-2000, -1000, 90}, {2000, 1000, 110});
  const Transform m = tileset_transform(placed(kCrs), box).value();
  EXPECT_LT(length(apply(m, {0, 0, 100}) - kPlace), 1e-3);
}

TEST(PlacementTransform, IsExactAtTheAnchorThatIsAskedFor) {
  const BoundsD box = box_to({-20000, 0, 0}, {0, 0, 200});
  const Transform middle = tileset_transform(placed(kCrs), box).value();
  const Transform anchored =
      tileset_transform(placed(kCrs + R"(, "anchor": [0, 0, 100])"), box).value();
  EXPECT_GT(length(apply(middle, {0, 0, 100}) - kPlace), 1);
  EXPECT_LT(length(apply(anchored, {0, 0, 100}) - kPlace), 1e-3);
}

// A y-up mesh is turned first, as viewers turn it: (x, y, z) is at (x, -z, y).
TEST(PlacementTransform, TurnsWhatIsYUp) {
  const BoundsD box = box_to({-200, 90, -100}, {200, 110, 300});
  const Config y_up = placed(kCrs + R"(, "anchor": [0, 100, 0])", R"("up": "y")");
  const Transform m = tileset_transform(y_up, box).value();
  EXPECT_LT(length(apply(m, {0, 0, 100}) - kPlace), 1e-3);
  const Config z_up = placed(kCrs + R"(, "anchor": [0, 0, 100])");
  EXPECT_EQ(tileset_transform(z_up, box).value(), m);
}

TEST(PlacementTransform, FitsTheMapUntilItIsMoved) {
  const BoundsD box = box_to({-2000, -1000, 90}, {2000, 1000, 110});
  const Config config = placed(kCrs);
  Transform m = tileset_transform(config, box).value();
  EXPECT_TRUE(fits_map(config, box, m));
  m[13] += 20;
  EXPECT_FALSE(fits_map(config, box, m));
  m[13] = 1e308;
  m[1] = -1e308;
  EXPECT_FALSE(fits_map(config, box, m));
}

TEST(PlacementTransform, IsToldToPeople) {
  const BoundsD box = box_to({-1000, -1000, 90}, {1000, 1000, 110});
  const auto text = [&](const std::string& placement) {
    const Config config = placed(placement);
    return placement_text(config, box, tileset_transform(config, box).value());
  };
  EXPECT_EQ(text(kCrs),
            "placed by WGS 84 / UTM zone 33N at longitude 15.000000, latitude 47.853342, height "
            "300.0 m above the ellipsoid, as the input's heights are taken: at most 16 cm off at "
            "the corners of its box\n");
  EXPECT_THAT(text(R"("crs": "EPSG:27700", "offset": [530000, 180000, 0])"),
              AllOf(HasSubstr("; the change of datum is good to 2.0 m\n"), Not(HasSubstr("warn"))));
  EXPECT_THAT(text(R"("crs": "EPSG:25832")"),
              HasSubstr("warning: the model lies outside the area that ETRS89 / UTM zone 32N is "
                        "meant for"));
  EXPECT_EQ(text(R"("longitude": 5, "latitude": 6)"),
            "placed at longitude 5.000000, latitude 6.000000, height 0.0 m above the ellipsoid: "
            "2000 m from west to east, 2000 m from south to north, 20 m high (taken to be in "
            "metres: \"units\" says others)\n");
  EXPECT_THAT(text(R"("transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])"), IsEmpty());
}

TEST(PlacementTransform, WarnsOfPlacesThatAreNone) {
  const auto text = [](const std::string& placement, const BoundsD& box) {
    const Config config = placed(placement);
    return placement_text(config, box, tileset_transform(config, box).value());
  };
  const BoundsD map = box_to({5'300'000, 500'000, 200}, {5'301'000, 501'000, 400});
  EXPECT_THAT(text(R"("crs": "EPSG:4978")", map),
              AllOf(HasSubstr(" m above the ellipsoid: at most"),
                    HasSubstr("km below the ground: the CRS has coordinates from the middle of "
                              "the Earth, and those of a map are none; look at \"crs\"")));
  const BoundsD geocentric = box_to(kPlace - Vec3d{9, 9, 9}, kPlace + Vec3d{9, 9, 9});
  EXPECT_THAT(text(R"("crs": "EPSG:4978")", geocentric), Not(HasSubstr("warning")));
  const BoundsD local = box_to({-1000, -1000, 90}, {1000, 1000, 110});
  EXPECT_THAT(text(R"("crs": "EPSG:32633", "offset": [500000, 5300000, 90000])", local),
              HasSubstr("warning: that is 90 km above the ground: look at \"crs\""));
  EXPECT_THAT(text(R"("longitude": 5, "latitude": 6, "height": -400000)", local),
              HasSubstr("warning: that is 400 km below the ground"));
  const std::string globe = R"("longitude": 5, "latitude": 6)";
  EXPECT_THAT(text(globe, local), Not(HasSubstr("warning")));
  EXPECT_THAT(text(globe, map), HasSubstr("warning: the middle of the model is 5324 km from that "
                                          "place: \"anchor\" names the point"));
  EXPECT_THAT(text(globe + R"(, "anchor": [5300500, 500500, 0])", map), Not(HasSubstr("warning")));
}

/// The same placement of a model in metres, and of it in other units: the same point of the model.
TEST(PlacementUnits, MoveNoPointOfTheModel) {
  struct Case {
    const char* units;
    double metres;
  };
  for (const auto& [units, metres] :
       {Case{"mm", 0.001}, Case{"cm", 0.01}, Case{"km", 1000}, Case{"in", 0.0254},
        Case{"ft", 0.3048}, Case{"us_ft", 1200.0 / 3937}}) {
    const Vec3d point{120, -50, 30};
    const Vec3d same = point * (1 / metres);
    const auto box = [&](double scale) {
      return box_to(Vec3d{-200, -100, 0} * scale, Vec3d{200, 100, 60} * scale);
    };
    const auto key = [](const char* unit) {
      return fmt::format(R"("up": "z", "units": "{}")", unit);
    };
    const auto anchor = [&](double scale) {
      return fmt::format(R"(, "anchor": [{}, {}, {}])", 10 * scale, 20 * scale, 5 * scale);
    };
    for (const std::string place :
         {R"("longitude": 9, "latitude": 48, "height": 400)", kCrs.c_str(),
          R"("crs": "EPSG:2263", "offset": [980000, 190000, 0])"}) {
      const Config in_metres = placed(place + anchor(1), key("m"));
      const Config in_units = placed(place + anchor(1 / metres), key(units));
      const Transform wanted = tileset_transform(in_metres, box(1)).value();
      const Transform found = tileset_transform(in_units, box(1 / metres)).value();
      EXPECT_LT(length(config::apply(found, same) - config::apply(wanted, point)), 1e-5)
          << units << ' ' << place;
      EXPECT_TRUE(!in_units.placement.crs || fits_map(in_units, box(1 / metres), found));
    }
  }
}

TEST(PlacementUnits, ScaleATransformThatIsGiven) {
  const std::string matrix = R"("transform": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1])";
  const BoundsD box = box_to({0, 0, 0}, {1, 1, 1});
  const Transform m = tileset_transform(placed(matrix, R"("units": "mm")"), box).value();
  EXPECT_EQ(m, (Transform{0, 0.002, 0, 0, -0.002, 0, 0, 0, 0, 0, 0.002, 0, 7, 8, 9, 1}));
  EXPECT_FALSE(tileset_transform(placed("", R"("units": "mm")"), box)) << "it has no place";
}

TEST(PlacementUnits, OfTheMapAreTakenIfNoneAreGiven) {
  const BoundsD box = box_to({980000, 190000, 0}, {981000, 191000, 100});
  const std::string place = R"("crs": "EPSG:2263")";  // US feet
  EXPECT_LT(
      length(config::apply(tileset_transform(placed(place), box).value(), box.max) -
             config::apply(
                 tileset_transform(placed(place, R"("up": "z", "units": "us_ft")"), box).value(),
                 box.max)),
      1e-5);
}

TEST(PlacementUnits, AreNamed) {
  for (const UnitRow& row : kUnits)
    EXPECT_EQ(placed("", fmt::format(R"("units": "{}")", row.name)).units, row.value);
  EXPECT_EQ(placed("").units, std::nullopt);
  EXPECT_THROW(placed("", R"("units": "feet")"), Error);
}

// ---- keys that exclude or need each other

std::string key_refusal(const std::string& placement) {
  const std::string message = tests::usage_error([&] { placed(placement); });
  EXPECT_NE(message, "") << "accepted: " << placement;
  return message;
}

TEST(PlacementKeys, ThereIsOneWayToPlaceAModel) {
  const std::string transform = R"("transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])";
  const std::string degrees = R"("longitude": 1, "latitude": 2)";
  for (const std::string& map :
       {std::string(R"("crs": "EPSG:32633")"), std::string(R"("metadata": "metadata.xml")")}) {
    EXPECT_THAT(key_refusal(map + ", " + transform), HasSubstr("found more than one")) << map;
    EXPECT_THAT(key_refusal(map + ", " + degrees), HasSubstr("found more than one")) << map;
    EXPECT_THAT(key_refusal(map + R"(, "height": 3)"), HasSubstr("found more than one")) << map;
  }
  EXPECT_THAT(key_refusal(R"("offset": [1, 2, 3])"), HasSubstr("needs \"crs\" or \"metadata\""));
  EXPECT_THAT(key_refusal(degrees + R"(, "offset": [1, 2, 3])"), HasSubstr("needs \"crs\""));
  EXPECT_THAT(key_refusal(R"("anchor": [1, 2, 3])"), HasSubstr("\"anchor\" needs"));
  EXPECT_THAT(key_refusal(transform + R"(, "anchor": [1, 2, 3])"), HasSubstr("\"anchor\" needs"));
  EXPECT_THAT(key_refusal(R"("crs": "EPSG:32633", "offset": [1, 2])"),
              HasSubstr("expected a list of 3 numbers"));
  EXPECT_THAT(key_refusal(R"("metadata": "/models/a.hier/metadata.xml")"),
              HasSubstr("is or holds the input"));
}

}  // namespace
}  // namespace meshhier::config
