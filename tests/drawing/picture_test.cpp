// Pictures at a scale.
#include "images/image_codec.h"
#include "tests/drawing/drawn_models.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::drawing {
namespace {

using testing::HasSubstr;

class PicturesAtScale : public DrawnModels {
 protected:
  images::Image picture(const DrawingOptions& options) {
    const std::string bytes = drawn(options, "a.png");
    return images::decode_image(std::as_bytes(std::span(bytes)), "a.png", 1 << 26);
  }
  /// Without what is beside the model.
  static DrawingOptions bare(double scale) {
    DrawingOptions options;
    options.paper.scale = scale;
    options.paper.has_bar = false;
    options.is_transparent = true;
    options.dots_per_inch = 254;  // ten a millimetre
    return options;
  }
  static std::uint64_t covered(const images::Image& image) {
    std::uint64_t count = 0;
    for (std::size_t i = 3; i < image.texels.size(); i += 4)
      count += image.texels[i] > 0 ? 1 : 0;
    return count;
  }
};

TEST_F(PicturesAtScale, HaveTheSizeAndThePlaceOfTheModel) {
  tests::TestMesh sheet = tests::open_grid(20, 10);
  for (Vec3f& p : sheet.positions)
    p = p + Vec3f{100, 50, 0};
  build(sheet);
  DrawingOptions options = bare(1000);
  options.has_world_file = true;
  const images::Image image = picture(options);
  // 20 x 10 mm, and 5 mm around.
  EXPECT_EQ(image.width, 300U);
  EXPECT_EQ(image.height, 200U);
  EXPECT_EQ(covered(image), 200U * 100U);
  EXPECT_EQ(image.at(49, 99)[3], 0);
  EXPECT_EQ(image.at(50, 50)[3], 255);
  std::ifstream world(path("a.pgw"));
  std::vector<double> numbers(6);
  for (double& number : numbers)
    world >> number;
  EXPECT_NEAR(numbers[0], 0.1, 1e-12);
  EXPECT_NEAR(numbers[3], -0.1, 1e-12);
  EXPECT_NEAR(numbers[4], 95.05, 1e-9);
  EXPECT_NEAR(numbers[5], 64.95, 1e-9);
}

TEST_F(PicturesAtScale, TellTheirDotsAnInch) {
  build(tests::sphere(500));
  DrawingOptions options;
  options.dots_per_inch = 300;
  const std::string bytes = drawn(options, "a.png");
  const std::size_t at = bytes.find("pHYs");
  ASSERT_NE(at, std::string::npos);
  // 11,811 = 0x2e23 dots a metre, both ways, and that it is metres.
  EXPECT_EQ(bytes.substr(at + 4, 9), std::string("\0\0\x2e\x23\0\0\x2e\x23\x01", 9));
}

TEST_F(PicturesAtScale, SidesAreThoseOfTheCompass) {
  // A wedge: low in the west, high in the east, near in the south.
  tests::TestMesh wedge = tests::open_grid(10, 4);
  for (Vec3f& p : wedge.positions)
    p.z = p.x / 2 + p.y / 8;
  build(wedge);
  const auto first_column = [&](Side side) {
    DrawingOptions options = bare(1000);
    options.view = side;
    const images::Image image = picture(options);
    std::uint32_t count = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      count += image.at(60, y)[3] > 0 ? 1 : 0;
    return std::pair(image.width, count);
  };
  const auto [front, low] = first_column(Side::front);
  const auto [back, also_low] = first_column(Side::back);
  EXPECT_EQ(front, 200U);
  EXPECT_EQ(back, 200U);
  EXPECT_NEAR(low, 5, 1);
  EXPECT_NEAR(also_low, 5, 1);
  EXPECT_EQ(first_column(Side::left).first, 140U);
  EXPECT_EQ(first_column(Side::right).first, 140U);
}

TEST_F(PicturesAtScale, ACutTakesAwayWhatIsAboveAndDrawsItsLine) {
  build(tests::sphere(8000));
  DrawingOptions options = bare(20);
  options.cut_heights = {0.6};
  const images::Image cut = picture(options);
  // 0.8 is where the sphere is at 0.6: in pixels from the middle. The line is black.
  const std::uint32_t middle = cut.height / 2, radius = 10 * 1000 / 20 * 8 / 10;
  EXPECT_LT(cut.at(cut.width / 2 + radius, middle)[0], 40);
  EXPECT_GT(cut.at(cut.width / 2 + radius - 10, middle)[0], 60);
  EXPECT_GT(cut.at(cut.width / 2 + radius + 10, middle)[3], 0);
  DrawingOptions none = bare(20);
  none.cut_heights = {-2};
  std::filesystem::remove(path("a.png"));
  EXPECT_THAT(refusal(none, "a.png"), HasSubstr("nothing lies behind the cut"));
}

TEST_F(PicturesAtScale, AreTheSameBytesForAnyThreadsAndBudget) {
  build(tests::torus(20000));
  for (const View& view : {View(PlanFromAbove{}), View(SectionLine{{-1, 0.2}, {1, 0}})}) {
    DrawingOptions options = bare(10);
    options.view = view;
    options.paper.has_bar = options.paper.has_grid = true;
    if (std::holds_alternative<PlanFromAbove>(view))
      options.contours = 0.05;
    const std::string first = drawn(options, "a.png");
    options.memory_budget = std::uint64_t{32} << 20;
    for (const std::size_t threads : {1, 2, 7}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(drawn(options, "a.png"), first) << threads;
    }
  }
}

TEST_F(PicturesAtScale, RefuseWhatCannotBe) {
  build(tests::sphere(500));
  EXPECT_THAT(refusal(bare(0.02), "a.png"), HasSubstr("a side has at most 100000"));
  EXPECT_THAT(refusal(bare(1e9), "a.png"), HasSubstr("--scale 1:1000000000"));
  DrawingOptions world = bare(20);
  world.view = Side::front;
  world.has_world_file = true;
  EXPECT_THAT(refusal(world, "a.png"), HasSubstr("--world-file"));
  DrawingOptions poor = bare(1);
  poor.memory_budget = std::uint64_t{1} << 20;
  EXPECT_THAT(refusal(poor, "a.png", ErrorCode::budget), HasSubstr("--memory-budget"));
  build(tests::points(500));
  EXPECT_THAT(refusal(bare(20), "a.png"), HasSubstr("points alone"));
}

}  // namespace
}  // namespace meshhier::drawing
