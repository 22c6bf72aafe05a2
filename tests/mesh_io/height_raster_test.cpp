#include "mesh_io/height_raster.h"

#include "base/error.h"
#include "mesh_io/mosaic.h"
#include "support/gzip.h"
#include "support/sample_tiff.h"
#include "tests/support/error_message.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using meshhier::tests::MemoryFiles;
using meshhier::tests::put_tiff;
using meshhier::tests::TiffForm;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kHeights = "/models/heights.tif";
constexpr std::uint32_t kColumns = 50, kRows = 37;

template <class T>
std::vector<T> slope() {
  std::vector<T> heights(kColumns * kRows);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = static_cast<T>(i % 100);
  return heights;
}

std::vector<double> all_heights(const Mosaic& mosaic) {
  std::vector<double> all;
  std::vector<double> row(mosaic.columns());
  for (std::uint32_t r = 0; r < mosaic.rows(); ++r) {
    mosaic.read(r, 0, row);
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

std::string raster_refusal(MemoryFiles& files,
                           const std::vector<std::filesystem::path>& paths = {kHeights}) {
  return meshhier::tests::error_message(ErrorCode::input,
                                        [&] { all_heights(Mosaic(files, paths)); });
}

template <class T>
void expect_heights(const TiffForm& form) {
  MemoryFiles files;
  put_tiff<T>(files, kHeights, form, kColumns, slope<T>());
  const auto expected = slope<T>();
  EXPECT_EQ(all_heights(Mosaic(files, {kHeights})),
            std::vector<double>(expected.begin(), expected.end()));
}

TEST(HeightRaster, SamplesOfAllTypesAndForms) {
  for (const std::uint32_t tile : {0, 16, 32}) {
    for (const int compression :
         {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_ZSTD}) {
      for (const auto form :
           {meshhier::tests::TiffWriter::Form::classic, meshhier::tests::TiffWriter::Form::big}) {
        TiffForm one{
            .tile = tile, .compression = static_cast<std::uint16_t>(compression), .form = form};
        expect_heights<std::uint8_t>(one);
        expect_heights<std::int8_t>(one);
        expect_heights<std::uint16_t>(one);
        expect_heights<std::int16_t>(one);
        expect_heights<std::uint32_t>(one);
        expect_heights<std::int32_t>(one);
        expect_heights<std::int64_t>(one);
        expect_heights<float>(one);
        expect_heights<double>(one);
        if (compression == COMPRESSION_NONE)
          continue;
        one.predictor = PREDICTOR_HORIZONTAL;
        expect_heights<std::int16_t>(one);
        one.predictor = PREDICTOR_FLOATINGPOINT;
        expect_heights<float>(one);
        expect_heights<double>(one);
      }
    }
  }
}

TEST(HeightRaster, PlacesAreThoseOfTheMiddlesOfCells) {
  MemoryFiles files;
  put_tiff<float>(files, kHeights, {}, kColumns, slope<float>());
  EXPECT_EQ(Mosaic(files, {kHeights}).map().at(0, 0), (MapPoint{500005, 5299995}));
  TiffForm point;
  point.keys[11] = 2;  // places are points
  put_tiff<float>(files, kHeights, point, kColumns, slope<float>());
  EXPECT_EQ(Mosaic(files, {kHeights}).map().at(1, 1), (MapPoint{500010, 5299990}));
  TiffForm turned{.matrix = {3, 4, 0, 100, 4, -3, 0, 200, 0, 0, 0, 0, 0, 0, 0, 1}};
  put_tiff<float>(files, kHeights, turned, kColumns, slope<float>());
  EXPECT_EQ(Mosaic(files, {kHeights}).map().at(1.5, 0.5), (MapPoint{110, 205}));
}

TEST(HeightRaster, NodataScaleAndUnitCount) {
  MemoryFiles files;
  TiffForm form{.nodata = "7"};
  form.metadata =
      R"(<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.5</Item><Item name="OFFSET" sample="0" role="offset">100</Item><Item name="X" sample="0" role="unittype">ft</Item></GDALMetadata>)";
  put_tiff<std::int16_t>(files, kHeights, form, kColumns, slope<std::int16_t>());
  const auto heights = all_heights(Mosaic(files, {kHeights}));
  EXPECT_TRUE(std::isnan(heights[7]));
  EXPECT_NEAR(heights[8], 0.3048 * 104, 1e-12);
}

TEST(HeightRaster, NodataMayBeInfinite) {
  MemoryFiles files;
  std::vector<float> heights = slope<float>();
  heights[5] = -std::numeric_limits<float>::infinity();
  put_tiff<float>(files, kHeights, {.nodata = "-inf"}, kColumns, heights);
  EXPECT_TRUE(std::isnan(all_heights(Mosaic(files, {kHeights}))[5]));
}

TEST(HeightRaster, ADamagedCrsBesideATextGridIsNone) {
  MemoryFiles files;
  files.put("/models/a.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n");
  files.put("/models/a.prj", "PROJCS[\"x");
  EXPECT_EQ(Mosaic(files, {"/models/a.asc"}).keys().kind, geodesy::MapKind::unknown);
}

TEST(HeightRaster, WhatIsNoGridOfHeightsIsToldOf) {
  MemoryFiles files;
  const std::vector<std::uint8_t> colours(kColumns * kRows * 3);
  put_tiff(files, kHeights, {.photometric = PHOTOMETRIC_RGB, .bands = 3}, kColumns, colours);
  EXPECT_THAT(raster_refusal(files), HasSubstr("--drape"));
  put_tiff<float>(files, kHeights, {.bands = 2}, kColumns / 2, slope<float>());
  EXPECT_THAT(raster_refusal(files), HasSubstr("gdal_translate -b 1"));
  put_tiff<float>(files, kHeights, {.subfile = 1}, kColumns, slope<float>());
  EXPECT_THAT(raster_refusal(files), HasSubstr("no image of full resolution"));
  put_tiff<float>(files, kHeights, {.scale = {0, 0, 0}}, kColumns, slope<float>());
  EXPECT_THAT(raster_refusal(files), HasSubstr("without an area"));
  put_tiff<float>(files, kHeights, {.keys = {1, 1, 0, 900, 1, 2, 3, 4}}, kColumns, slope<float>());
  EXPECT_THAT(raster_refusal(files), HasSubstr("900 keys"));
  auto broken = slope<float>();
  broken[kColumns] = std::numeric_limits<float>::infinity();
  put_tiff<float>(files, kHeights, {}, kColumns, broken);
  EXPECT_THAT(raster_refusal(files), HasSubstr("column 0, row 1"));
}

TEST(HeightRaster, TheFirstImageOfFullResolutionCounts) {
  MemoryFiles files;
  {
    const auto file = files.create(kHeights);
    meshhier::tests::TiffWriter tiff(*file, meshhier::tests::TiffWriter::Form::classic);
    const std::vector<float> small(10 * 10, 1.0F);
    meshhier::tests::put_tiff_image<float>(tiff, {.subfile = FILETYPE_REDUCEDIMAGE}, 10, small);
    meshhier::tests::know_tags_again(tiff.handle());
    meshhier::tests::put_tiff_image<float>(tiff, {}, kColumns, slope<float>());
  }
  EXPECT_EQ(Mosaic(files, {kHeights}).columns(), kColumns);
}

/// The mask has other blocks than the heights.
TEST(HeightRaster, WhatAMaskHidesHasNoHeight) {
  MemoryFiles files;
  {
    const auto file = files.create(kHeights);
    meshhier::tests::TiffWriter tiff(*file, meshhier::tests::TiffWriter::Form::classic);
    meshhier::tests::put_tiff_image<std::int16_t>(tiff, {.tile = 16}, kColumns,
                                                  slope<std::int16_t>());
    std::vector<std::uint8_t> seen(kColumns * kRows, 255);
    seen[kColumns + 3] = seen.back() = 0;
    meshhier::tests::know_tags_again(tiff.handle());
    meshhier::tests::put_tiff_image<std::uint8_t>(tiff,
                                                  {.rows_of_strip = 5,
                                                   .compression = COMPRESSION_ADOBE_DEFLATE,
                                                   .photometric = PHOTOMETRIC_MASK,
                                                   .subfile = FILETYPE_MASK},
                                                  kColumns, seen);
  }
  const Mosaic mosaic(files, {kHeights});
  EXPECT_TRUE(mosaic.may_have_voids());
  EXPECT_THAT(mosaic.warnings(), testing::IsEmpty());
  const auto heights = all_heights(mosaic);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const bool is_hidden = i == kColumns + 3 || i + 1 == heights.size();
    ASSERT_EQ(std::isnan(heights[i]), is_hidden) << i;
    if (!is_hidden) {
      ASSERT_EQ(heights[i], slope<std::int16_t>()[i]);
    }
  }
}

TEST(HeightRaster, WhatAnAlphaHidesHasNoHeight) {
  MemoryFiles files;
  const std::vector<float> samples{1, 255, 2, 0, 3, 1, 4, 255};
  put_tiff<float>(files, kHeights, {.bands = 2, .has_alpha = true}, 2, samples);
  const auto heights = all_heights(Mosaic(files, {kHeights}));
  EXPECT_THAT(heights, ElementsAre(1, testing::IsNan(), 3, 4));
}

TEST(HeightRaster, FilesBesideSayWhereItLies) {
  MemoryFiles files;
  TiffForm bare{.keys = {}, .has_place = false};
  put_tiff<float>(files, kHeights, bare, kColumns, slope<float>());
  EXPECT_THAT(raster_refusal(files), HasSubstr("does not say where its cells lie"));
  files.put("/models/heights.tifw", "2\r\n0.5\r\n0.5\r\n-2\r\n100\r\n200\r\n");
  files.put("/models/heights.prj", "PROJCS[\"Somewhere\",UNIT[\"Meter\",1.0]]");
  const Mosaic mosaic(files, {kHeights});
  EXPECT_EQ(mosaic.map().at(1, 2), (MapPoint{103, 196.5}));
  EXPECT_EQ(mosaic.keys().kind, geodesy::MapKind::lengths);
  EXPECT_THAT(mosaic.keys().crs, HasSubstr("Somewhere"));
  files.put("/models/heights.tifw", "2 0.5 0.5 -2 100");
  EXPECT_THAT(raster_refusal(files), HasSubstr("heights.tifw: expected the six numbers"));
  put_tiff<float>(files, kHeights, {}, kColumns, slope<float>());  // what the file says counts
  EXPECT_EQ(Mosaic(files, {kHeights}).map().at(0, 0), (MapPoint{500005, 5299995}));
}

TEST(HeightRaster, FlippedBytesAndCutFilesDoNoHarm) {
  MemoryFiles files;
  put_tiff<float>(files, kHeights, {.tile = 16, .compression = COMPRESSION_LZW}, kColumns,
                  slope<float>());
  const std::string whole = files.content(kHeights);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(~flipped[i]);
    files.put(kHeights, flipped);
    raster_refusal(files);
    files.put(kHeights, whole.substr(0, i));
    raster_refusal(files);
  }
}

TEST(HeightRaster, FilesOfSrtmAreKnownByNameAndSize) {
  MemoryFiles files;
  std::string bytes(2 * 1201 * 1201, '\0');
  bytes[0] = 1;  // 256 + 44
  bytes[1] = 44;
  bytes[2] = '\x80';
  bytes.back() = 9;
  files.put("/models/S01W001.hgt", bytes);
  const Mosaic mosaic(files, {"/models/S01W001.hgt"});
  const auto heights = all_heights(mosaic);
  EXPECT_EQ(heights.front(), 300);
  EXPECT_TRUE(std::isnan(heights[1]));
  EXPECT_EQ(heights.back(), 9);
  EXPECT_EQ(mosaic.map().at(0, 0), (MapPoint{-1, 0}));
  EXPECT_NEAR(mosaic.map().at(1200, 1200).y, -1, 1e-12);
  EXPECT_EQ(mosaic.keys().crs, "EPSG:4326+5773");
}

TEST(HeightRaster, FilesOfSrtmMayBePacked) {
  MemoryFiles files;
  std::string bytes(2 * 1201 * 1201, '\0');
  for (std::size_t i = 1; i < bytes.size(); i += 2)
    bytes[i] = static_cast<char>(i * 7919 % 251);
  files.put("/models/N01E001.hgt", bytes);
  const std::string packed = meshhier::tests::gzip(bytes);
  files.put("/models/N01E001.HGT.gz", packed);
  const Mosaic plain(files, {"/models/N01E001.hgt"}), mosaic(files, {"/models/N01E001.HGT.gz"});
  EXPECT_EQ(all_heights(mosaic).size(), 1201U * 1201);
  std::vector<double> expected(1201), found(1201);
  for (const std::uint32_t row : {1200U, 3U, 700U, 701U, 1100U, 0U}) {  // there and back
    mosaic.release();
    plain.read(row, 0, expected);
    mosaic.read(row, 0, found);
    EXPECT_EQ(found[5], expected[5]);
    EXPECT_EQ(std::isnan(found[5]), std::isnan(expected[5]));
  }
  const auto refusal = [&](const std::string& content) {
    files.put("/models/N01E001.HGT.gz", content);
    return raster_refusal(files, {"/models/N01E001.HGT.gz"});
  };
  std::string broken = packed;
  broken[packed.size() / 2] = static_cast<char>(~broken[packed.size() / 2]);
  EXPECT_NE(refusal(broken), "");
  broken = packed;
  broken[packed.size() - 6] = static_cast<char>(~broken[packed.size() - 6]);  // the checksum
  EXPECT_THAT(refusal(broken), HasSubstr("damaged"));
  broken = packed.substr(0, packed.size() / 2) + packed.substr(packed.size() - 4);
  EXPECT_NE(refusal(broken), "");
}

TEST(HeightRaster, TextGridsAreReadWithTheirCrs) {
  MemoryFiles files;
  files.put("/models/a.asc",
            "NCOLS 3\r\nnrows 2\nxllcorner 100\nyllcenter 20\ncellsize 10\nNODATA_value -1\n"
            "1 2 3\n4 -1\n 6.5\n");
  files.put("/models/a.prj", R"(PROJCS["x",GEOGCS["y"],UNIT["Foot",0.3048]])");
  const Mosaic mosaic(files, {"/models/a.asc"});
  const auto heights = all_heights(mosaic);
  EXPECT_EQ(heights[2], 3);
  EXPECT_TRUE(std::isnan(heights[4]));
  EXPECT_EQ(heights[5], 6.5);
  EXPECT_EQ(mosaic.map().at(0, 0), (MapPoint{105, 30}));
  EXPECT_EQ(mosaic.keys().kind, geodesy::MapKind::lengths);
  EXPECT_EQ(mosaic.keys().unit, 0.3048);
}

TEST(HeightRaster, BrokenTextGridsAreToldOf) {
  MemoryFiles files;
  const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  const auto refusal = [&](const std::string& text) {
    files.put("/models/a.asc", text);
    return raster_refusal(files, {"/models/a.asc"});
  };
  EXPECT_THAT(refusal(head + "1 2 3"), HasSubstr("ends in row 1 of 2"));
  EXPECT_THAT(refusal(head + "1 2 3\n4 5 6"),
              HasSubstr("expected the end behind 2 rows of 2, found '5'"));
  EXPECT_THAT(refusal(head + "1 2 x 4"), HasSubstr("byte 55: expected a height, found 'x'"));
  EXPECT_THAT(refusal("ncols 2\nnrows 0\n1"), HasSubstr("\"nrows\""));
  EXPECT_THAT(refusal("ncols 2\nnrows 2\ncellsize 0\n1"), HasSubstr("\"cellsize\""));
  EXPECT_THAT(refusal("ncols 2\nnrows 2\ncellsize 1\n1"), HasSubstr("\"xllcorner\""));
  EXPECT_THAT(refusal("ncols 99999999999\nnrows 2\ncellsize 1\n1"), HasSubstr("\"ncols\""));
  EXPECT_THAT(refusal("ncols 4000000000\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1"),
              HasSubstr("4000000000 columns"));
  EXPECT_THAT(
      refusal("ncols 4000000000\nnrows 4000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1"),
      HasSubstr("2^32 or more"));
}

TEST(Mosaic, RastersOnOneGridAreOne) {
  MemoryFiles files;
  const std::vector<float> left{1, 2, 3, 4}, right{2, 5, 40, 6};  // two columns; one is in both
  put_tiff<float>(files, "/models/a.tif", {}, 2, left);
  TiffForm beside;
  beside.tie[3] += 10;
  put_tiff<float>(files, "/models/b.tif", beside, 2, right);
  const Mosaic mosaic(files, {"/models/a.tif", "/models/b.tif"});
  EXPECT_THAT(all_heights(mosaic), ElementsAre(1, 2, 5, 3, 4, 6));
  SharedCells shared;
  std::vector<double> row(3);
  for (const std::uint32_t r : {0U, 1U})
    mosaic.read(r, 0, row, &shared);
  EXPECT_EQ(shared.equal, 1U);
  EXPECT_EQ(shared.different, 1U);
  EXPECT_EQ(shared.most, 36);
  // The order of files decides where they differ, not where the grid begins.
  EXPECT_THAT(all_heights(Mosaic(files, {"/models/b.tif", "/models/a.tif"})),
              ElementsAre(1, 2, 5, 3, 40, 6));
}

TEST(Mosaic, OtherGridsAreToldOf) {
  MemoryFiles files;
  const std::vector<float> heights{1, 2, 3, 4};
  put_tiff<float>(files, "/models/a.tif", {}, 2, heights);
  const auto refusal = [&](const TiffForm& form) {
    put_tiff<float>(files, "/models/b.tif", form, 2, heights);
    return raster_refusal(files, {"/models/a.tif", "/models/b.tif"});
  };
  TiffForm other;
  other.tie[3] += 13;
  EXPECT_THAT(refusal(other), HasSubstr("0.3 of a cell beside the grid"));
  EXPECT_THAT(refusal({.scale = {20, 20, 0}}), HasSubstr("cells are 20 x 20"));
  TiffForm map;
  map.keys.back() = 32632;
  EXPECT_THAT(refusal(map), HasSubstr("EPSG:32632, the other in EPSG:32633"));
  TiffForm far;
  far.tie[3] += 1e12;
  EXPECT_NE(refusal(far), "");
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
