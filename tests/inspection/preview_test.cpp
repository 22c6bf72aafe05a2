#include "inspection/preview.h"

#include "base/error.h"
#include "images/image_codec.h"
#include "inspection/kept_view.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::inspection {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A flat sheet: 4 wide (x), 1 high (y), so that views differ.
tests::TestMesh sheet() {
  tests::TestMesh mesh = tests::open_grid(60, 15);
  for (Vec3f& p : mesh.positions)
    p = {p.x / 15, p.y / 15, 0};
  return mesh;
}

class PictureTest : public testing::Test {
 protected:
  fs::path hierarchy(const char* ending = ".hier") const {
    return directory_.path() / (std::string("mesh") + ending);
  }

  void build(const tests::TestMesh& mesh, const char* ending = ".hier") {
    tests::write_ply(mesh, directory_.path() / "mesh.ply");
    config::Config config = tests::smooth_config();
    config.input = directory_.path() / "mesh.ply";
    config.output = hierarchy(ending);
    if (std::string(ending) == ".3tz")
      config.storage.container = storage::Container::archive;
    config.partition.vertices = 150;
    config.preview = false;
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {.force = true},
                              {*files_, progress, execution::CancelToken()});
  }

  PreviewOptions options() const {
    PreviewOptions options;
    options.output = directory_.path() / "picture.png";
    options.replace = true;
    options.width = 120;
    options.height = 90;
    return options;
  }

  images::Image picture(const PreviewOptions& options, const char* ending = ".hier") {
    execution::NoProgress progress;
    make_picture(*files_, hierarchy(ending), options, progress, {});
    return images::decode_image(storage::read_file(*files_, options.output, 1 << 24), "picture",
                                1 << 24);
  }

  ErrorCode failure(const PreviewOptions& options, std::string& message) {
    try {
      picture(options);
    } catch (const Error& error) {
      message = error.what();
      return error.code();
    }
    ADD_FAILURE() << "nothing failed";
    return ErrorCode::internal;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

/// Columns and rows that anything covers.
struct Covered {
  std::size_t columns = 0, rows = 0;
};
Covered covered(const images::Image& picture) {
  Covered covered;
  const auto is_covered = [&](std::uint32_t x, std::uint32_t y) {
    return picture.at(x, y)[3] > 127;
  };
  for (std::uint32_t x = 0; x < picture.width; ++x) {
    bool any = false;
    for (std::uint32_t y = 0; y < picture.height; ++y)
      any = any || is_covered(x, y);
    covered.columns += any ? 1 : 0;
  }
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    bool any = false;
    for (std::uint32_t x = 0; x < picture.width; ++x)
      any = any || is_covered(x, y);
    covered.rows += any ? 1 : 0;
  }
  return covered;
}

TEST_F(PictureTest, HasTheSizeAndTheViewAskedFor) {
  build(sheet());
  PreviewOptions front = options();
  front.view = Standpoint{0, 0};
  const images::Image picture_front = picture(front);
  EXPECT_EQ(picture_front.width, 120U);
  EXPECT_EQ(picture_front.height, 90U);
  const Covered wide = covered(picture_front);
  EXPECT_NEAR(static_cast<double>(wide.columns), 4.0 * static_cast<double>(wide.rows), 4);
  EXPECT_NEAR(static_cast<double>(wide.columns), 120 - 2 * 0.04 * 120, 2);
  PreviewOptions right = front;
  right.view = Standpoint{90, 0};
  EXPECT_LE(covered(picture(right)).columns, 2U) << "seen from its edge";
  PreviewOptions z_up = front;
  z_up.up = UpAxis::z;
  z_up.view = Standpoint{0, 90};
  const Covered map = covered(picture(z_up));
  EXPECT_NEAR(static_cast<double>(map.columns), 4.0 * static_cast<double>(map.rows), 4);
}

TEST_F(PictureTest, TheFirstViewIsShownUnlessAnotherIsAskedFor) {
  build(tests::torus(4000, 0.05F));
  const storage::HierarchyReader reader(*files_, hierarchy());
  const images::Image usual = picture(options());
  PreviewOptions same = options();
  same.view = reader.manifest().first_view;
  ASSERT_TRUE(same.view);
  EXPECT_EQ(picture(same), usual);
  same.view->azimuth += 40;
  EXPECT_NE(picture(same), usual);
}

TEST_F(PictureTest, APieceFillsThePicture) {
  build(sheet());
  PreviewOptions front = options();
  front.view = Standpoint{0, 0};
  front.region.box = BoundsD{{0.3, 0.1, -1}, {1.1, 0.5, 1}};  // twice as wide as high
  const Covered box = covered(picture(front));
  EXPECT_NEAR(static_cast<double>(box.columns), 2.0 * static_cast<double>(box.rows), 3);
  EXPECT_NEAR(static_cast<double>(box.columns), 120 - 2 * 0.04 * 120, 2);
  // From above the sheet is a line, which a polygon shortens: y points up.
  std::ofstream(directory_.path() / "a.geojson")
      << R"({"type": "Polygon", "coordinates": [[[1, -1], [3, -1], [3, 1], [1, 1]]]})";
  front.region = {.polygon = directory_.path() / "a.geojson"};
  const Covered polygon = covered(picture(front));
  EXPECT_NEAR(static_cast<double>(polygon.columns), 2.0 * static_cast<double>(polygon.rows), 3);
  std::string message;
  front.region = {.box = BoundsD{{7, 7, 7}, {8, 8, 8}}};
  EXPECT_EQ(failure(front, message), ErrorCode::usage);
  EXPECT_THAT(message, HasSubstr("no triangle lies in the box"));
}

TEST_F(PictureTest, PointsAreShown) {
  build(tests::points(500));
  const Covered shown = covered(picture(options()));
  EXPECT_GT(shown.columns, 3U);
  EXPECT_GT(shown.rows, 3U);
}

TEST_F(PictureTest, AnyCutOfASheetCoversIt) {
  build(sheet());
  PreviewOptions some = options();
  some.view = Standpoint{0, 0};
  some.selection = Level{2};
  const images::Image fine = picture(some);
  std::ofstream(directory_.path() / "cut.txt") << "1/0\n2/2\n2/3\n";
  for (const PreviewSelection& selection :
       {PreviewSelection{Level{0}}, PreviewSelection{directory_.path() / "cut.txt"},
        PreviewSelection{exporting::LargestError{0}},
        PreviewSelection{exporting::LargestError{100}}}) {
    some.selection = selection;
    const images::Image other = picture(some);
    std::size_t differing = 0;
    for (std::size_t i = 3; i < fine.texels.size(); i += 4)
      differing += fine.texels[i] != other.texels[i] ? 1 : 0;
    EXPECT_LE(differing, 60U) << "the rim alone";
  }
}

TEST_F(PictureTest, TheErrorAskedForDecidesTheTiles) {
  const tests::TestMesh mesh = tests::sphere(4000);
  build(mesh);
  const auto line = [&](std::optional<PreviewSelection> selection) {
    PreviewOptions some = options();
    some.selection = selection;
    execution::NoProgress progress;
    return make_picture(*files_, hierarchy(), some, progress, {});
  };
  EXPECT_THAT(line(exporting::LargestError{10}), HasSubstr("120 x 90 pixels, 1 tile, "));
  EXPECT_THAT(line(exporting::LargestError{0}),
              HasSubstr(std::to_string(mesh.triangles.size()) + " triangles"));
  EXPECT_THAT(line(Level{1}), HasSubstr(" 2 tiles, "));
}

TEST_F(PictureTest, IsTheSameForAnyMemoryAndContainer) {
  build(tests::torus(4000, 0.05F));
  build(tests::torus(4000, 0.05F), ".3tz");
  PreviewOptions large = options();
  large.width = 700;
  large.height = 600;
  const images::Image expected = picture(large);
  PreviewOptions small = large;
  small.memory_budget = std::uint64_t{71} << 20;
  EXPECT_EQ(picture(small), expected);
  EXPECT_EQ(picture(large, ".3tz"), expected);
}

TEST_F(PictureTest, ABackgroundIsBehindItAll) {
  build(tests::sphere(1000));
  PreviewOptions some = options();
  some.background = {10, 200, 30};
  const images::Image on_green = picture(some);
  EXPECT_EQ(on_green.at(0, 0)[0], 10);
  EXPECT_EQ(on_green.at(0, 0)[1], 200);
  EXPECT_EQ(on_green.at(0, 0)[2], 30);
  some.background.reset();
  some.format = ImageFormat::webp;
  some.output = directory_.path() / "picture.webp";
  EXPECT_EQ(picture(some).at(0, 0)[3], 0);
}

TEST_F(PictureTest, WhatCannotBeDoneIsRefusedAndLeavesNothing) {
  build(tests::sphere(1000));
  std::string message;
  PreviewOptions some = options();
  some.selection = Level{30};
  EXPECT_EQ(failure(some, message), ErrorCode::usage);
  some = options();
  some.memory_budget = 1 << 20;
  EXPECT_EQ(failure(some, message), ErrorCode::budget);
  EXPECT_THAT(message, HasSubstr("--memory-budget"));
  some = options();
  some.selection = directory_.path() / "none.txt";
  EXPECT_EQ(failure(some, message), ErrorCode::io);
  some = options();
  some.output = hierarchy() / "picture.png";
  EXPECT_EQ(failure(some, message), ErrorCode::usage);
  EXPECT_FALSE(fs::exists(options().output));
  some = options();
  picture(some);
  some.replace = false;
  EXPECT_EQ(failure(some, message), ErrorCode::exists);
}

TEST_F(PictureTest, CanBeEndedAtAnyTile) {
  build(tests::sphere(4000));
  execution::CancelToken cancel;
  cancel.cancel();
  execution::NoProgress progress;
  EXPECT_THROW(make_picture(*files_, hierarchy(), options(), progress, cancel), Error);
  EXPECT_FALSE(fs::exists(options().output));
}

TEST_F(PictureTest, HasThePerspectiveOfALink) {
  build(sheet());
  PreviewOptions asked = options();
  asked.link = "https://example.org/#mesh.hier&2,0.5,5,2,0.5,0";
  const Covered whole = covered(picture(asked));
  // 90 pixels are 2 * 5 * tan(22.5 degrees) high where the sheet is.
  // A pixel at each end is half covered, which counts.
  EXPECT_NEAR(static_cast<double>(whole.columns), 4 * 90 / 4.1421, 1.5);
  EXPECT_NEAR(static_cast<double>(whole.rows), 90 / 4.1421, 1);
  asked.link += "&cut=-1,0,0,2&caps=off";
  EXPECT_NEAR(static_cast<double>(covered(picture(asked)).columns), 2 * 90 / 4.1421, 1);
  asked.link = "#&2,0.5,5,2,0.5,0&box=1,0.25,-1,2,0.75,1&level=0";
  EXPECT_NEAR(static_cast<double>(covered(picture(asked)).columns), 90 / 4.1421, 1);
  asked.link = "#&up=x";  // all of it, upright
  const Covered upright = covered(picture(asked));
  EXPECT_GT(upright.rows, 80U);
  EXPECT_LT(upright.columns, 40U);
  asked.link = "nothing";
  std::string message;
  EXPECT_EQ(failure(asked, message), ErrorCode::usage);
  EXPECT_THAT(message, HasSubstr("--link: expected an address"));
}

TEST_F(PictureTest, HasTheViewThatTheHierarchyKeeps) {
  build(sheet());
  const images::Image before = picture(options());
  const std::string text = [&] {
    const auto bytes = storage::read_file(*files_, hierarchy() / "hierarchy.json", 1 << 20);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }();
  ModelView view;
  view.up = "x";
  keep_view(*files_, hierarchy(), view);
  EXPECT_EQ(kept_view(*files_, hierarchy()), view);
  const Covered upright = covered(picture(options()));
  EXPECT_GT(upright.rows, 80U);
  EXPECT_LT(upright.columns, 40U);
  PreviewOptions asked = options();
  asked.up = UpAxis::y;
  asked.view = Standpoint{0, 0};
  EXPECT_GT(covered(picture(asked)).columns, 100U);
  keep_view(*files_, hierarchy(), {});
  EXPECT_EQ(picture(options()).texels, before.texels);
  const auto bytes = storage::read_file(*files_, hierarchy() / "hierarchy.json", 1 << 20);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), text);
}

TEST_F(PictureTest, AViewMustFitItsHierarchyAndIsNotPutIntoArchives) {
  build(sheet());
  build(sheet(), ".3tz");
  ModelView view;
  view.attribute = "quality";
  EXPECT_THROW(keep_view(*files_, hierarchy(), view), Error);
  EXPECT_THROW(keep_view(*files_, hierarchy(".3tz"), {}), Error);
  EXPECT_TRUE(kept_view(*files_, hierarchy(".3tz")).empty());
}

}  // namespace
}  // namespace meshhier::inspection
