#include "geodesy/geo_keys.h"

#include "base/error.h"
#include "geodesy/map_code.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::geodesy {
namespace {

/// Returns a key's entry but for the key: place, count, value; empty if it is not there.
std::vector<std::uint16_t> entry(const GeoKeys& keys, std::uint16_t key) {
  for (std::size_t i = 4; i + 4 <= keys.directory.size(); i += 4) {
    if (keys.directory[i] == key)
      return {keys.directory.begin() + static_cast<std::ptrdiff_t>(i) + 1,
              keys.directory.begin() + static_cast<std::ptrdiff_t>(i) + 4};
  }
  return {};
}

constexpr const char* kOwnMap =
    "+proj=tmerc +lat_0=48.3 +lon_0=11.7 +k=1 +x_0=1000 +y_0=2000 +ellps=GRS80 +units=m +type=crs";

TEST(MapCode, IsEpsgsWhereItHasOne) {
  EXPECT_EQ(map_code("EPSG:25832").horizontal, 25832);
  EXPECT_EQ(map_code("EPSG:25832").vertical, 0);
  const MapCode both = map_code("EPSG:25832+7837");
  EXPECT_EQ(both.horizontal, 25832);
  EXPECT_EQ(both.vertical, 7837);
  // The same map by its definition.
  EXPECT_EQ(map_code("+proj=utm +zone=33 +datum=WGS84 +units=m +type=crs").horizontal, 32633);
  const MapCode own = map_code(kOwnMap);
  EXPECT_EQ(own.horizontal, 0);
  EXPECT_EQ(own.method.method, 9807);
  EXPECT_EQ(own.method.parameters.size(), 5);
  EXPECT_THROW(map_code("EPSG:0"), Error);
}

TEST(GeoKeys, NameAMap) {
  const GeoKeys picture = keys_of_map(map_code("EPSG:25832+7837"), false);
  EXPECT_EQ(picture.directory[3] * 4 + 4, picture.directory.size());
  EXPECT_EQ(entry(picture, 3072), (std::vector<std::uint16_t>{0, 1, 25832}));
  EXPECT_EQ(entry(picture, 1025).back(), 1) << "pixel is area";
  EXPECT_TRUE(entry(picture, 4096).empty());
  EXPECT_EQ(entry(keys_of_map(map_code("EPSG:25832+7837"), true), 4096).back(), 7837);
}

TEST(GeoKeys, HaveTheMethodOfAMapWithoutCode) {
  const GeoKeys keys = keys_of_map(map_code(kOwnMap), true);
  EXPECT_EQ(entry(keys, 3072).back(), 32767);
  EXPECT_EQ(entry(keys, 3075).back(), 1) << "transverse Mercator";
  EXPECT_EQ(entry(keys, 2048).back(), 32767) << "no datum is known";
  EXPECT_EQ(keys.doubles.at(entry(keys, 2057).back()), 6378137);
  EXPECT_EQ(keys.doubles.at(entry(keys, 3080).back()), 11.7);
  EXPECT_EQ(keys.doubles.at(entry(keys, 3082).back()), 1000);
  const GeoKeys feet =
      keys_of_map(map_code("+proj=lcc +lat_0=48 +lon_0=11 +lat_1=47 +lat_2=49 +x_0=304.8 +y_0=0 "
                           "+datum=WGS84 +units=ft +type=crs"),
                  false);
  EXPECT_EQ(entry(feet, 2048).back(), 4326);
  EXPECT_EQ(entry(feet, 3075).back(), 8) << "Lambert, two parallels";
  EXPECT_EQ(feet.doubles.at(entry(feet, 3077).back()), 0.3048);
  EXPECT_NEAR(feet.doubles.at(entry(feet, 3086).back()), 1000, 1e-9) << "in feet";
  EXPECT_TRUE(keys_of_map(map_code("+proj=eqearth +lon_0=11 +datum=WGS84 +type=crs"), true)
                  .directory.empty());
}

TEST(GeoKeys, NameAPlane) {
  const GeoKeys keys = keys_of_plane({13.4, 52.5, 1.00001});
  EXPECT_EQ(entry(keys, 3075).back(), 1) << "transverse Mercator";
  const auto longitude = entry(keys, 3080), scale = entry(keys, 3092);
  EXPECT_EQ(entry(keys, 2048).back(), 4326);
  EXPECT_EQ(keys.doubles.at(longitude.back()), 13.4);
  EXPECT_EQ(keys.doubles.at(scale.back()), 1.00001);
}

}  // namespace
}  // namespace meshhier::geodesy
