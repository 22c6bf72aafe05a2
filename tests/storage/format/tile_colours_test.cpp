#include "storage/format/tile_colours.h"

#include "base/srgb.h"

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

constexpr std::size_t kAlpha = 3;

AttributeLayout layout_of(ColourType type, ColourSpace space = ColourSpace::srgb) {
  return {.colour = type, .alpha = true, .space = space};
}

TEST(TileColoursTest, BytesOfAScreenAreLightOf16BitsAndComeBack) {
  const TileColours colours(layout_of(ColourType::u8), false);
  EXPECT_EQ(colours.stored_type(), ColourType::u16);
  for (int byte = 0; byte < 256; ++byte) {
    const auto number = static_cast<float>(byte);
    const float light = colours.stored(number, 0);
    ASSERT_NEAR(light, 65535 * light_of(byte / 255.0), 0.5);
    ASSERT_EQ(colours.number(light, 0), number);
    ASSERT_EQ(colours.stored(number, kAlpha), 257 * number);
    ASSERT_EQ(colours.number(257 * number, kAlpha), number);
  }
}

TEST(TileColoursTest, LightThatNoByteBecomesIsNotSound) {
  const TileColours colours(layout_of(ColourType::u8), false);
  for (const std::size_t channel : {std::size_t{0}, std::size_t{2}, kAlpha}) {
    int sound = 0;
    for (int light = 0; light <= 65535; ++light)
      sound += colours.is_sound(static_cast<float>(light), channel) ? 1 : 0;
    EXPECT_EQ(sound, 256) << channel;
  }
}

TEST(TileColoursTest, ShortsOfAScreenAreLightAsFloatsAndComeBack) {
  const TileColours colours(layout_of(ColourType::u16), false);
  EXPECT_EQ(colours.stored_type(), ColourType::f32);
  for (int value = 0; value <= 65535; ++value) {
    const auto number = static_cast<float>(value);
    ASSERT_NEAR(colours.stored(number, 1), light_of(value / 65535.0), 1e-7);
    for (const std::size_t channel : {std::size_t{1}, kAlpha})
      ASSERT_EQ(colours.number(colours.stored(number, channel), channel), number);
  }
}

TEST(TileColoursTest, FloatsOfAScreenAreLightAndWhatComesBackIsTheSameLight) {
  const TileColours colours(layout_of(ColourType::f32), false);
  EXPECT_EQ(colours.stored_type(), ColourType::f32);
  std::mt19937 random(7);
  for (int i = 0; i < 1'000'000; ++i) {
    const float number = std::ldexp(static_cast<float>(random()), -32 - i % 20);
    const float light = colours.stored(number, 0);
    ASSERT_NEAR(light, light_of(number), 1e-7);
    const float back = colours.number(light, 0);
    ASSERT_NEAR(back, number, 1e-6 * number);
    ASSERT_EQ(colours.stored(back, 0), light) << number;
    ASSERT_EQ(colours.stored(number, kAlpha), number);
  }
}

TEST(TileColoursTest, LightAndColoursOfEarlierFormatsStayAsTheyAre) {
  for (const ColourType type : {ColourType::u8, ColourType::u16, ColourType::f32}) {
    for (const TileColours& colours : {TileColours(layout_of(type, ColourSpace::linear), false),
                                       TileColours(layout_of(type), true)}) {
      EXPECT_EQ(colours.stored_type(), type);
      const float number = full_number(type) / 3;
      EXPECT_EQ(colours.stored(number, 0), number);
      EXPECT_EQ(colours.number(number, 0), number);
      EXPECT_TRUE(colours.is_sound(number, 0));
    }
  }
  EXPECT_EQ(TileColours({}, false).stored_type(), ColourType::none);
}

TEST(TileColoursTest, OnlyColoursOfVerticesChange) {
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8, .texcoords = true};
  const TileColours colours(layout, false);
  const std::vector<float> vertices{0, 0, 1, 255, 0, 124, 0.5F, 0.25F, 0, 1, 0, 1, 2, 3, 7.5F, -3};
  const std::vector<float> stored = colours.all_stored(vertices);
  EXPECT_EQ(stored, (std::vector<float>{0, 0, 1, 65535, 0, 13209, 0.5F, 0.25F,  //
                                        0, 1, 0, 20, 40, 60, 7.5F, -3}));
  EXPECT_EQ(colours.all_numbers(stored), vertices);
}

}  // namespace
}  // namespace meshhier::storage
