#include "images/tiff_layout.h"

#include "base/error.h"
#include "images/tiff_file.h"
#include "storage/io/little_endian.h"
#include "support/memory_files.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

constexpr std::uint64_t kMostLaidOut = 1 << 22;

std::vector<std::byte> random_tile(TiffPixel kind, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> pixels(kTiffTileBytes);
  for (std::size_t i = 0; i < kTiffTileBytes; i += kTiffPixelBytes) {
    if (kind == TiffPixel::height)
      storage::store_little(static_cast<float>(random() % 1000) / 7, pixels.data() + i);
    else
      storage::store_little(static_cast<std::uint32_t>(random() % 5000), pixels.data() + i);
  }
  return pixels;
}

/// A picture of 600 x 400 and its overview of 300 x 200, and their tiles in the order of the file.
struct LaidOut {
  std::vector<TiffRaster> rasters{{600, 400, {}}, {300, 200, {}}};
  std::vector<std::vector<std::byte>> tiles;
  std::vector<std::byte> file;

  explicit LaidOut(TiffPixel kind) {
    for (std::uint32_t i = 0; i < 3; ++i)
      tiles.push_back(random_tile(kind, i));
    std::vector<std::vector<std::byte>> packed;
    for (const auto& tile : tiles)
      packed.push_back(pack_tile(kind, tile));
    rasters[1].tile_bytes = {packed[0].size()};
    rasters[0].tile_bytes = {packed[1].size(), packed[2].size()};
    const std::vector<TiffField> fields{
        tiff_doubles(static_cast<std::uint16_t>(GeoTag::pixel_scale), {{0.5, 0.5, 0}}),
        tiff_text(static_cast<std::uint16_t>(GeoTag::gdal_nodata), "-9999")};
    file = tiff_head(kind, rasters, fields);
    for (const auto& bytes : packed)
      file.insert(file.end(), bytes.begin(), bytes.end());
  }
};

TEST(TiffTile, UnpacksToWhatItWas) {
  for (const TiffPixel kind : {TiffPixel::rgba, TiffPixel::height}) {
    const std::vector<std::byte> pixels = random_tile(kind, 5);
    std::vector<std::byte> packed = pack_tile(kind, pixels), unpacked(kTiffTileBytes);
    unpack_tile(kind, packed, unpacked, "x");
    EXPECT_EQ(unpacked, pixels);
    packed.resize(packed.size() / 2);
    EXPECT_THROW(unpack_tile(kind, packed, unpacked, "x"), Error);
  }
}

TEST(TiffLayout, IsReadByLibtiff) {
  for (const TiffPixel kind : {TiffPixel::rgba, TiffPixel::height}) {
    tests::MemoryFiles files;
    const LaidOut laid(kind);
    storage::write_file(files, "/models/a.tif", laid.file);
    const auto file = files.open("/models/a.tif");
    TiffFile tiff(*file, kMostLaidOut);
    EXPECT_EQ(tiff.number<std::uint32_t>(TIFFTAG_IMAGEWIDTH), 600);
    EXPECT_EQ(tiff.number<std::uint32_t>(TIFFTAG_IMAGELENGTH), 400);
    EXPECT_EQ(tiff.doubles(GeoTag::pixel_scale), (std::vector<double>{0.5, 0.5, 0}));
    EXPECT_EQ(tiff.text(GeoTag::gdal_nodata), "-9999");
    std::vector<std::byte> pixels(kTiffTileBytes);
    for (std::uint32_t i = 0; i < 2; ++i) {
      tiff.read_block(i, pixels);
      EXPECT_EQ(pixels, laid.tiles[1 + i]);
    }
    ASSERT_EQ(TIFFSetDirectory(tiff.handle(), 1), 1);
    EXPECT_EQ(tiff.number<std::uint32_t>(TIFFTAG_IMAGEWIDTH), 300);
    EXPECT_EQ(tiff.number<std::uint32_t>(TIFFTAG_SUBFILETYPE), 1);
    tiff.read_block(0, pixels);
    EXPECT_EQ(pixels, laid.tiles[0]);
    EXPECT_EQ(TIFFLastDirectory(tiff.handle()), 1);
  }
}

TEST(TiffLayout, IsBigFromFourGigabytesOn) {
  const auto version = [](std::uint64_t tile_bytes) {
    const std::vector<TiffRaster> rasters{{512, 512, {tile_bytes}}};
    return static_cast<int>(tiff_head(TiffPixel::height, rasters, {})[2]);
  };
  EXPECT_EQ(version(4000000000), 42);
  EXPECT_EQ(version(4294967296), 43);
}

TEST(TiffLayout, HoldsTilesBehindFourGigabytes) {
  const std::vector<TiffRaster> rasters{{1024, 512, {3000000000, 3000000000}}};
  std::vector<std::byte> head = tiff_head(TiffPixel::rgba, rasters, {});
  tests::MemoryFiles files;
  storage::write_file(files, "/models/a.tif", head);
  const auto file = files.open("/models/a.tif");
  TiffFile tiff(*file, kMostLaidOut);
  EXPECT_EQ(TIFFGetStrileOffset(tiff.handle(), 1), head.size() + 3000000000);
}

}  // namespace
}  // namespace meshhier::images
