#include "import/terrain_drape.h"

#include "base/error.h"
#include "geodesy/map_change.h"
#include "import/terrain_map.h"
#include "support/sample_tiff.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

using mesh_io::MapPoint;
using mesh_io::Mosaic;
using meshhier::tests::MemoryFiles;
using meshhier::tests::put_tiff;
using meshhier::tests::TiffForm;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kHeightsPath = "/models/heights.tif";
constexpr const char* kPicturePath = "/models/picture.tif";
constexpr std::uint32_t kGridColumns = 300, kGridRows = 200, kPictureColumns = 90,
                        kPictureRows = 60;

std::vector<std::uint16_t> keys_in_metres(std::uint16_t crs) {
  return {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, crs};
}
std::vector<std::uint16_t> keys_in_degrees(std::uint16_t crs) {
  return {1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, crs};
}

/// 3 by 2 km near 15 E 48 N.
const TiffForm kInZone33{.tie = {0, 0, 0, 500000, 5318000, 0}, .keys = keys_in_metres(32633)};
const TiffForm kInDegrees{
    .scale = {1e-4, 1e-4, 0}, .tie = {0, 0, 0, 15.0, 48.01, 0}, .keys = keys_in_degrees(4326)};
/// About the same place for a person of the zone to the west.
const TiffForm kInZone32{
    .scale = {40, 40, 0}, .tie = {0, 0, 0, 947000, 5335700, 0}, .keys = keys_in_metres(32632)};

struct Draped {
  std::unique_ptr<Mosaic> heights;
  TerrainDrape drape;
};

void put_heights(MemoryFiles& files, const TiffForm& form) {
  put_tiff<float>(files, kHeightsPath, form, kGridColumns,
                  std::vector<float>(kGridColumns * kGridRows, 7));
}

void put_picture(MemoryFiles& files, TiffForm form) {
  form.photometric = PHOTOMETRIC_RGB;
  form.bands = 3;
  put_tiff<std::uint8_t>(files, kPicturePath, form, kPictureColumns,
                         std::vector<std::uint8_t>(3 * kPictureColumns * kPictureRows, 99));
}

Draped drape_of(const TiffForm& heights, const TiffForm& picture, const std::string& crs = "") {
  MemoryFiles files;
  put_heights(files, heights);
  put_picture(files, picture);
  Draped draped{std::make_unique<Mosaic>(files, std::vector<std::filesystem::path>{kHeightsPath}),
                {}};
  draped.drape = open_drape(files, kPicturePath, *draped.heights, crs);
  return draped;
}

std::string drape_refusal(const TiffForm& heights, const TiffForm& picture) {
  try {
    drape_of(heights, picture);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Returns the pixel of the picture, without its frame, that a cell's middle lies in.
MapPoint pixel_at(const TerrainDrape& drape, double column, double row) {
  const MapPoint at = drape.texcoords->at(column, row);
  return {at.x * (kPictureColumns + 2) - 1, at.y * (kPictureRows + 2) - 1};
}

/// Compares each place with PROJ's answer for it alone.
void expect_as_proj(const TiffForm& heights, const TiffForm& picture, const std::string& from,
                    const std::string& to) {
  const Draped draped = drape_of(heights, picture);
  const geodesy::MapChange change(from, to);
  double largest = 0;
  for (std::uint32_t row = 0; row < kGridRows; row += 7) {
    for (std::uint32_t column = 0; column < kGridColumns; column += 11) {
      const MapPoint at = draped.heights->map().at(column, row);
      const Vec3d there = change({at.x, at.y, 0});
      const MapPoint exact{(there.x - picture.tie[3]) / picture.scale[0],
                           (picture.tie[4] - there.y) / picture.scale[1]};
      const MapPoint found = pixel_at(draped.drape, column, row);
      largest = std::max({largest, std::abs(found.x - exact.x), std::abs(found.y - exact.y)});
    }
  }
  EXPECT_LE(largest, 0x1p-9) << from << " " << to;
  EXPECT_THAT(draped.drape.warnings, IsEmpty());
}

TEST(TerrainDrape, InOneMapPixelsLieWhereCellsDo) {
  TiffForm picture = kInZone33;
  picture.scale = {30, 30, 0};
  const Draped draped = drape_of(kInZone33, picture);
  const MapPoint first = pixel_at(draped.drape, 0, 0);
  EXPECT_NEAR(first.x, 5.0 / 30, 1e-12);
  EXPECT_NEAR(first.y, 5.0 / 30, 1e-12);
  EXPECT_NEAR(pixel_at(draped.drape, 299, 199).x, 2995.0 / 30, 1e-9);
  EXPECT_FALSE(draped.drape.texcoords->is_changed());
  EXPECT_THAT(draped.drape.warnings, IsEmpty());
}

TEST(TerrainDrape, APictureMayLieInAnotherZone) {
  expect_as_proj(kInZone33, kInZone32, "EPSG:32633", "EPSG:32632");
}

TEST(TerrainDrape, APictureInDegreesLiesOnMetres) {
  expect_as_proj(kInZone33, kInDegrees, "EPSG:32633", "EPSG:4326");
}

TEST(TerrainDrape, APictureInMetresLiesOnDegrees) {
  expect_as_proj(kInDegrees, kInZone33, "EPSG:4326", "EPSG:32633");
}

TEST(TerrainDrape, LongitudesMayBeToldAWholeTurnAway) {
  TiffForm picture = kInDegrees;
  picture.tie[3] -= 360;
  for (const TiffForm& heights : {kInDegrees, kInZone33}) {
    const Draped draped = drape_of(heights, picture);
    const Draped same = drape_of(heights, kInDegrees);
    EXPECT_NEAR(pixel_at(draped.drape, 100, 100).x, pixel_at(same.drape, 100, 100).x, 1e-6);
    EXPECT_THAT(draped.drape.warnings, IsEmpty());
  }
}

TEST(TerrainDrape, WhatLacksACrsIsNamed) {
  TiffForm bare = kInZone33;
  bare.keys = {1, 1, 0, 1, 1024, 0, 1, 1};  // lengths of nobody knows which map
  EXPECT_THAT(drape_refusal(kInDegrees, bare),
              HasSubstr("/models/picture.tif: does not say in which CRS it lies, while "
                        "/models/heights.tif lies in EPSG:4326"));
  EXPECT_THAT(drape_refusal(bare, kInDegrees),
              HasSubstr("/models/heights.tif: does not say in which CRS it lies, while "
                        "/models/picture.tif lies in EPSG:4326"));
  const Draped told = drape_of(bare, kInDegrees, "EPSG:32633");
  const Draped same = drape_of(kInZone33, kInDegrees);
  EXPECT_EQ(told.drape.texcoords->at(3, 4), same.drape.texcoords->at(3, 4));
}

/// Coordinates of no map are taken for those of the other one, unless they cannot be.
TEST(TerrainDrape, WhatCannotLieInTheOthersMapNeedsACrs) {
  TiffForm bare = kInZone33;
  bare.keys.clear();
  EXPECT_THAT(drape_of(bare, kInZone33).drape.warnings, IsEmpty());
  EXPECT_THAT(drape_refusal(bare, kInDegrees),
              HasSubstr("/models/heights.tif: does not say in which CRS it lies"));
  EXPECT_THAT(drape_refusal(kInDegrees, bare),
              HasSubstr("/models/picture.tif: does not say in which CRS it lies"));
}

TEST(TerrainDrape, APictureElsewhereIsToldOf) {
  TiffForm picture = kInDegrees;
  picture.tie[3] += 3;
  EXPECT_THAT(drape_of(kInZone33, picture).drape.warnings,
              testing::ElementsAre(HasSubstr("lies beside the heights")));
}

TEST(TerrainDrape, AWorldFileSaysWhereItLies) {
  MemoryFiles files;
  put_heights(files, kInZone33);
  TiffForm bare;
  bare.has_place = false;
  bare.keys.clear();
  put_picture(files, bare);
  files.put("/models/picture.tfw", "30\n0\n0\n-30\n500015\n5317985\n");
  const Mosaic heights(files, {kHeightsPath});
  const TerrainDrape drape = open_drape(files, kPicturePath, heights, "");
  EXPECT_NEAR(pixel_at(drape, 0, 0).x, 5.0 / 30, 1e-12);
  EXPECT_THAT(drape.beside, testing::ElementsAre("/models/picture.tfw"));
  EXPECT_THAT(drape.warnings, testing::ElementsAre(HasSubstr("taken to lie in that of")));
}

TEST(TerrainMap, DegreesAreBroughtToTheMapThatIsAskedFor) {
  MemoryFiles files;
  put_heights(files, kInDegrees);
  const Mosaic heights(files, {kHeightsPath});
  const TerrainMap map = bring_to_map(heights, "EPSG:32633");
  EXPECT_THAT(map.warnings, IsEmpty());
  const geodesy::MapChange change("EPSG:4326", "EPSG:32633");
  for (const auto& [column, row] : {std::pair(0, 0), std::pair(299, 199), std::pair(123, 45)}) {
    const MapPoint at = heights.map().at(column, row);
    const Vec3d exact = change({at.x, at.y, 0});
    EXPECT_NEAR(map.places->at(column, row).x, exact.x, 1e-3);
    EXPECT_NEAR(map.places->at(column, row).y, exact.y, 1e-3);
  }
}

TEST(TerrainMap, PlacesAreInMetresWhateverTheMapsUnit) {
  MemoryFiles files;
  TiffForm form = kInDegrees;
  form.tie[3] = -121;
  form.tie[4] = 37.5;
  put_heights(files, form);
  const Mosaic heights(files, {kHeightsPath});
  const MapPoint feet = bring_to_map(heights, "EPSG:2227").places->at(7, 8);  // US survey feet
  const MapPoint metres = bring_to_map(heights, "EPSG:26943").places->at(7, 8);
  EXPECT_NEAR(feet.x, metres.x, 1e-3);
  EXPECT_NEAR(feet.y, metres.y, 1e-3);
}

}  // namespace
}  // namespace meshhier::importing
