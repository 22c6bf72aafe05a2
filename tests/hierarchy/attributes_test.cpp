#include "hierarchy/attribute_rules.h"
#include "hierarchy/vec.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

TEST(Attributes, ChannelsOfEveryLayoutFollowEachOther) {
  for (const bool normals : {false, true}) {
    for (const ColourType colour :
         {ColourType::none, ColourType::u8, ColourType::u16, ColourType::f32}) {
      for (const bool alpha : {false, true}) {
        for (const bool texcoords : {false, true}) {
          const AttributeLayout layout{normals, colour, alpha, texcoords};
          const auto first_of = [&](AttributeKind kind) {
            return static_cast<int>(layout.part(kind).first);
          };
          int channels = 0;
          EXPECT_EQ(first_of(AttributeKind::normals), channels);
          channels += normals ? 3 : 0;
          EXPECT_EQ(first_of(AttributeKind::colours), channels);
          channels += colour == ColourType::none ? 0 : alpha ? 4 : 3;
          EXPECT_EQ(first_of(AttributeKind::texcoords), channels);
          channels += texcoords ? 2 : 0;
          EXPECT_EQ(layout.channels(), channels);
          EXPECT_LE(layout.channels(), kMaxChannels);
        }
      }
    }
  }
  EXPECT_EQ(
      AttributeLayout({true, ColourType::f32, true, true}).part(AttributeKind::material).first, 9U);
  EXPECT_EQ((AttributeLayout{true, ColourType::f32, true, true, true}.channels()),
            kMaxChannels - kMaxValueChannels);
}

TEST(Attributes, NormalsAndColoursLieBeforeTexcoords) {
  const AttributeLayout layout{true, ColourType::u8, true, true, true};
  EXPECT_EQ(layout.without_texcoords(), (AttributeLayout{true, ColourType::u8, true}));
  EXPECT_EQ(static_cast<std::size_t>(layout.without_texcoords().channels()),
            layout.part(AttributeKind::texcoords).first);
}

TEST(Attributes, AlphaWithoutColoursHasNoChannel) {
  EXPECT_EQ((AttributeLayout{false, ColourType::none, true, false}.channels()), 0);
}

TEST(Attributes, AnAveragedNormalGetsUnitLengthAndTheRestStays) {
  const AttributeLayout layout{true, ColourType::u8, true, true};
  std::array<float, 9> channels{0.3F, 0, -0.4F, 10.5F, 20, 30, 40, 0.25F, 7};
  AttributeRules(layout).normalize(channels);
  EXPECT_FLOAT_EQ(channels[0], 0.6F);
  EXPECT_EQ(channels[1], 0.0F);
  EXPECT_FLOAT_EQ(channels[2], -0.8F);
  const std::array<float, 6> rest{10.5F, 20, 30, 40, 0.25F, 7};
  for (std::size_t i = 0; i < rest.size(); ++i)
    EXPECT_EQ(channels[i + 3], rest[i]);
}

TEST(Attributes, AZeroNormalStaysZero) {
  std::array<float, 3> channels{};
  AttributeRules({true, ColourType::none, false, false}).normalize(channels);
  EXPECT_EQ(channels, (std::array<float, 3>{}));
}

TEST(Attributes, TinyAndHugeNormalsGetUnitLengthToo) {
  for (const float size : {std::numeric_limits<float>::denorm_min(), 1e-30F, 1e30F,
                           std::numeric_limits<float>::max()}) {
    std::array<float, 3> channels{size, -size, size};
    AttributeRules({true, ColourType::none, false, false}).normalize(channels);
    EXPECT_NEAR(length(Vec3d{channels[0], channels[1], channels[2]}), 1.0, 1e-6) << size;
    EXPECT_LT(channels[1], 0.0F);
  }
}

TEST(Attributes, WithoutNormalsNothingIsTouched) {
  std::array<float, 3> channels{3, 4, 12};  // colours
  AttributeRules({false, ColourType::f32, false, false}).normalize(channels);
  EXPECT_EQ(channels, (std::array<float, 3>{3, 4, 12}));
  AttributeRules().normalize({});
}

}  // namespace
}  // namespace meshhier::tests
