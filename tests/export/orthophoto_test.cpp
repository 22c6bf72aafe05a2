#include "export/orthophoto.h"

#include "base/error.h"
#include "export/map_frame.h"
#include "export/pixel_grid.h"
#include "export/plan_windows.h"
#include "export/raster_pyramid.h"
#include "images/tiff_file.h"
#include "pipeline/build.h"
#include "tests/support/error_message.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// A raster as libtiff reads it.
struct ReadRaster {
  std::uint32_t width = 0, height = 0;
  double left = 0, top = 0, size = 0;
  std::vector<std::byte> pixels;  ///< 4 bytes each
  std::vector<std::uint16_t> keys;

  float height_at(std::uint32_t x, std::uint32_t y) const {
    float found = 0;
    std::memcpy(&found, &pixels[4 * (std::size_t{y} * width + x)], sizeof(found));
    return found;
  }
};

ReadRaster read_raster(storage::FileSystem& files, const fs::path& path,
                       std::uint16_t directory = 0) {
  constexpr std::uint64_t kMostBytes = 1 << 24;
  const auto file = files.open(path);
  images::TiffFile tiff(*file, kMostBytes);
  ReadRaster raster;
  raster.keys = tiff.shorts(images::GeoTag::key_directory);
  raster.size = tiff.doubles(images::GeoTag::pixel_scale).at(0);
  raster.left = tiff.doubles(images::GeoTag::tie_points).at(3);
  raster.top = tiff.doubles(images::GeoTag::tie_points).at(4);
  EXPECT_EQ(TIFFSetDirectory(tiff.handle(), directory), 1);
  raster.width = *tiff.number<std::uint32_t>(TIFFTAG_IMAGEWIDTH);
  raster.height = *tiff.number<std::uint32_t>(TIFFTAG_IMAGELENGTH);
  raster.pixels.resize(std::size_t{4} * raster.width * raster.height);
  const std::uint32_t side = images::kTiffTileSide, across = images::tiff_tiles(raster.width);
  std::vector<std::byte> tile(images::kTiffTileBytes);
  for (std::uint32_t i = 0; i < across * images::tiff_tiles(raster.height); ++i) {
    tiff.read_block(i, tile);
    const std::uint32_t x = i % across * side, y = i / across * side;
    const std::uint32_t width = std::min(side, raster.width - x);
    for (std::uint32_t row = 0; row < std::min(side, raster.height - y); ++row) {
      std::memcpy(&raster.pixels[4 * (std::size_t{y + row} * raster.width + x)],
                  &tile[std::size_t{4} * side * row], std::size_t{4} * width);
    }
  }
  return raster;
}

class OrthophotoTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kWidth = 600, kHeight = 70;

  fs::path path(const char* name) const { return directory_.path() / name; }

  static float height_of(std::uint32_t x, std::uint32_t y) {
    return 100 + 3 * std::sin(static_cast<float>(x) / 7) * std::cos(static_cast<float>(y) / 5);
  }
  /// A field of heights with vertices at multiples of 2, z-up.
  void build_terrain(const std::string& placement = "", Vec3d offset = {}) {
    std::ofstream ply(path("a.ply"));
    ply.precision(17);
    ply << "ply\nformat ascii 1.0\nelement vertex " << kWidth * kHeight
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
        << 2 * (kWidth - 1) * (kHeight - 1) << "\nproperty list uchar int vertex_indices\n"
        << "end_header\n";
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      for (std::uint32_t x = 0; x < kWidth; ++x)
        ply << offset.x + 2 * x << ' ' << offset.y + 2 * y << ' ' << height_of(x, y) << '\n';
    }
    for (std::uint32_t y = 0; y + 1 < kHeight; ++y) {
      for (std::uint32_t x = 0; x + 1 < kWidth; ++x) {
        const std::uint32_t a = y * kWidth + x;
        ply << "3 " << a << ' ' << a + 1 << ' ' << a + kWidth << "\n3 " << a + 1 << ' '
            << a + kWidth + 1 << ' ' << a + kWidth << '\n';
      }
    }
    ply.close();
    const std::string text = R"({"input": "a.ply", "output": "a.hier", "up": "z", "preview": false,
                               "partition": {"vertices": 2000})" +
                             placement + "}";
    execution::NoProgress progress;
    pipeline::build_hierarchy(config::parse_config(text, {"c", directory_.path()}, {}),
                              {.force = true}, {*files_, progress, execution::CancelToken()});
  }
  std::string draw(RasterOptions options) {
    options.replace = true;
    execution::NoProgress progress;
    return export_rasters(*files_, path("a.hier"), options, progress, execution::CancelToken());
  }
  std::string refusal(RasterOptions options, ErrorCode code) {
    return tests::error_message(code, [&] { draw(std::move(options)); });
  }
  RasterOptions heights(double pixel, PlanPoint corner = {}) const {
    RasterOptions options;
    options.heights = path("d.tif");
    options.pixel = pixel;
    options.corner = corner;
    return options;
  }
  void expect_grid_of_input(const ReadRaster& raster) const {
    ASSERT_EQ(raster.width, kWidth);
    ASSERT_EQ(raster.height, kHeight);
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      for (std::uint32_t x = 0; x < kWidth; ++x)
        ASSERT_EQ(raster.height_at(x, kHeight - 1 - y), height_of(x, y)) << x << ' ' << y;
    }
  }
  static std::string bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(OrthophotoTest, AGridOfHeightsComesOutBitForBit) {
  build_terrain();
  const std::string line = draw(heights(2, {1, 1}));
  EXPECT_THAT(line, HasSubstr("600 x 70 pixels of 2, 100.0 %"));
  const ReadRaster raster = read_raster(*files_, path("d.tif"));
  expect_grid_of_input(raster);
  EXPECT_EQ(raster.left, -1);
  EXPECT_EQ(raster.top, 2 * kHeight - 1);
  EXPECT_TRUE(raster.keys.empty());
}

TEST_F(OrthophotoTest, OnAMapToo) {
  build_terrain(R"(, "placement": {"crs": "EPSG:25832"})", {600000, 5300000, 0});
  EXPECT_THAT(draw(heights(2, {1, 1})), HasSubstr("on EPSG:25832"));
  const ReadRaster raster = read_raster(*files_, path("d.tif"));
  expect_grid_of_input(raster);
  EXPECT_EQ(raster.left, 599999);
  EXPECT_THAT(raster.keys, testing::Contains(25832));
}

TEST_F(OrthophotoTest, OnTheGlobeItIsSeenAlongTheVertical) {
  build_terrain(R"(, "placement": {"longitude": 11.5, "latitude": 48.1, "height": 500})");
  EXPECT_THAT(draw(heights(2)), HasSubstr("level at longitude 11.5"));
  const ReadRaster raster = read_raster(*files_, path("d.tif"));
  // The middle of the field is the origin, and the input's axes are nearly those of the plane.
  EXPECT_NEAR(raster.left, 1 - double{kWidth}, 3);
  EXPECT_NEAR(raster.height_at(raster.width / 2, raster.height / 2), 600, 4);
}

TEST_F(OrthophotoTest, BytesDoNotDependOnThreadsAndBudget) {
  build_terrain();
  RasterOptions options = heights(0.7);
  options.picture = path("o.tif");
  draw(options);
  const std::string first = bytes_of(path("o.tif")) + bytes_of(path("d.tif"));
  options.memory_budget = std::uint64_t{24} << 20;
  for (const std::size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    draw(options);
    EXPECT_EQ(bytes_of(path("o.tif")) + bytes_of(path("d.tif")), first) << threads;
  }
  options.memory_budget = 1000;
  EXPECT_THAT(refusal(options, ErrorCode::budget), HasSubstr("needs --memory-budget"));
}

TEST_F(OrthophotoTest, OverviewsAreMeansOfWhatIsThere) {
  build_terrain();
  draw(heights(1, {0.5, 0.5}));
  const ReadRaster fine = read_raster(*files_, path("d.tif")),
                   half = read_raster(*files_, path("d.tif"), 1);
  ASSERT_EQ(half.width, (fine.width + 1) / 2);
  ASSERT_EQ(half.height, (fine.height + 1) / 2);
  for (std::uint32_t y = 0; y < fine.height / 2; ++y) {
    for (std::uint32_t x = 0; x < fine.width / 2; ++x) {
      const double mean =
          (double{fine.height_at(2 * x, 2 * y)} + fine.height_at(2 * x + 1, 2 * y) +
           fine.height_at(2 * x, 2 * y + 1) + fine.height_at(2 * x + 1, 2 * y + 1)) /
          4;
      ASSERT_EQ(half.height_at(x, y), static_cast<float>(mean)) << x << ' ' << y;
    }
  }
  EXPECT_EQ(
      half.height_at(half.width - 1, 3),
      static_cast<float>(
          (double{fine.height_at(fine.width - 1, 6)} + fine.height_at(fine.width - 1, 7)) / 2))
      << "an odd last column stands for two";
}

TEST_F(OrthophotoTest, ARegionEndsIt) {
  build_terrain();
  RasterOptions options = heights(1);
  options.region.box = BoundsD{{10, 20, 0}, {40, 50, 200}};
  draw(options);
  const ReadRaster box = read_raster(*files_, path("d.tif"));
  EXPECT_EQ(box.width, 30);
  EXPECT_EQ(box.height, 30);
  EXPECT_EQ(box.left, 10);
  EXPECT_EQ(box.top, 50);
  std::ofstream(path("p.json"))
      << R"({"type": "Polygon", "coordinates": [[[10, 20], [40, 20], [10, 50], [10, 20]]]})";
  options.region = {.polygon = path("p.json")};
  draw(options);
  const ReadRaster half = read_raster(*files_, path("d.tif"));
  EXPECT_EQ(half.height_at(29, 0), kNoHeight);
  EXPECT_EQ(half.height_at(0, 29), box.height_at(0, 29));
  options.region = {.box = BoundsD{{1e6, 0, 0}, {1e6 + 1, 1, 1}}};
  EXPECT_THAT(refusal(options, ErrorCode::usage), HasSubstr("no triangle lies in the box"));
}

TEST_F(OrthophotoTest, TilesOfMixedLevelsHaveNoGap) {
  build_terrain();
  std::ofstream(path("cut.txt")) << "1/0\n2/2\n2/3\n";
  RasterOptions options = heights(1);
  options.selection = path("cut.txt");
  draw(options);
  const ReadRaster raster = read_raster(*files_, path("d.tif"));
  for (std::uint32_t y = 6; y + 6 < raster.height; ++y) {
    for (std::uint32_t x = 6; x + 6 < raster.width; ++x)
      ASSERT_NE(raster.height_at(x, y), kNoHeight) << x << ' ' << y;
  }
}

TEST_F(OrthophotoTest, WhatMakesNoSenseIsRefused) {
  build_terrain();
  EXPECT_THAT(refusal(heights(1e-5), ErrorCode::usage), HasSubstr("give --gsd 0.0006"));
  RasterOptions options = heights(1);
  options.selection = OutlineSelection{};
  EXPECT_THAT(refusal(options, ErrorCode::usage), HasSubstr("no outline"));
  options = heights(1);
  options.picture = path("o.png");
  EXPECT_THAT(refusal(options, ErrorCode::usage), HasSubstr("ends in .tif"));
  options.picture = options.heights;
  EXPECT_THAT(refusal(options, ErrorCode::usage), HasSubstr("another output"));
  EXPECT_FALSE(fs::exists(path("o.png")));
}

TEST_F(OrthophotoTest, AFailureLeavesNothing) {
  build_terrain();
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory_.path()))
      all.push_back(entry.path().filename());
    std::ranges::sort(all);
    return all;
  };
  const std::vector<std::string> before = names();
  execution::CancelToken cancelled;
  cancelled.cancel();
  execution::NoProgress progress;
  RasterOptions options = heights(1);
  options.picture = path("o.tif");
  EXPECT_THROW(export_rasters(*files_, path("a.hier"), options, progress, cancelled), Error);
  EXPECT_EQ(names(), before);
  // Of the two files neither is there when one cannot get its name.
  for (const tests::Call call : {tests::Call::rename, tests::Call::sync}) {
    tests::FaultyFileSystem faulty;
    faulty.fail(call, 2);
    const execution::CancelToken going;
    EXPECT_THROW(export_rasters(faulty, path("a.hier"), options, progress, going), Error);
    EXPECT_EQ(names(), before);
  }
}

TEST_F(OrthophotoTest, PointsHaveNoSurface) {
  tests::Sample sample = tests::make_sample(tests::points(300), {});
  tests::write_sample(*files_, path("a.hier"), sample);
  EXPECT_THAT(refusal(heights(1), ErrorCode::usage), HasSubstr("points alone"));
}

TEST_F(OrthophotoTest, IfNoPixelIsGivenItIsAsFineAsTheInput) {
  build_terrain();
  RasterOptions options = heights(1);
  options.pixel.reset();
  EXPECT_THAT(draw(options), HasSubstr("pixels of 2 (about as fine as the input"));
}

TEST(PixelGrid, HasTheAskedCorners) {
  const PixelGrid grid = grid_over({{0.3, -1, 0}, {1.1, 2, 0}}, 0.1, {});
  EXPECT_EQ(grid.width, 8) << "0.3 / 0.1 is a little less than 3";
  EXPECT_EQ(grid.height, 30);
  const PixelGrid shifted = grid_over({{0, 0, 0}, {4, 4, 0}}, 2, {1, 1});
  EXPECT_EQ(shifted.width, 3);
  EXPECT_EQ(shifted.left, -1);
  EXPECT_EQ(shifted.top, 5);
  EXPECT_EQ(grid_over({{1, 1, 1}, {1, 1, 1}}, 1, {}).width, 1);
}

}  // namespace
}  // namespace meshhier::exporting
