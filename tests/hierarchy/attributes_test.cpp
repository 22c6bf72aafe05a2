#include "base/vec.h"
#include "hierarchy/attribute_rules.h"

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

TEST(Attributes, PartsLieOneBehindTheOtherAndCoverAllChannels) {
  const AttributeLayout layout{.normals = true,
                               .colour = ColourType::u16,
                               .texcoords = true,
                               .material = true,
                               .values = {{"a", ValueType::f64}, {"b", ValueType::u8}}};
  std::size_t end = 0;
  for (const AttributePart& part : layout.parts()) {
    EXPECT_EQ(part.first, end);
    EXPECT_EQ(layout.part(part.kind).first, part.first);
    EXPECT_GT(part.count, 0U) << row_of(part.kind).name;
    EXPECT_TRUE(part.has(part.first) && part.has(part.end() - 1));
    EXPECT_FALSE(part.has(part.first - 1) || part.has(part.end()));
    end = part.end();
  }
  EXPECT_EQ(end, static_cast<std::size_t>(layout.channels()));
  for (const AttributePart& part : AttributeLayout().parts())
    EXPECT_EQ(part.end(), 0U);
}

TEST(Attributes, AreTold) {
  EXPECT_EQ(attribute_names({}), "none");
  EXPECT_EQ(attribute_names({.normals = true, .colour = ColourType::u8, .alpha = true}),
            "normals, 8-bit colours with alpha");
  EXPECT_EQ(attribute_names({.texcoords = true, .values = {{"a", ValueType::u8}}}),
            "texture coordinates, 1 value");
  EXPECT_EQ(attribute_names({.texcoords = true, .material = true}), "textures");
}

TEST(AttributeRules, MeansOfAScreensColoursAreThoseOfLight) {
  const AttributeRules rules({.colour = ColourType::u8, .alpha = true});
  EXPECT_EQ(rules.summand(0, 255), 1);
  EXPECT_LT(rules.summand(2, 128), 0.25);
  EXPECT_EQ(rules.summand(3, 128), 128);  // opacity
  for (const double number : {0.0, 1.0, 77.0, 255.0})
    EXPECT_NEAR(rules.number(1, rules.summand(1, number)), number, 1e-9);
  const AttributeRules light({.colour = ColourType::u8, .space = ColourSpace::linear});
  EXPECT_EQ(light.summand(0, 128), 128);
}

TEST(AttributeRules, BetweenTwoVerticesEachKindHasItsOwnMean) {
  const AttributeRules rules({.normals = true,
                              .colour = ColourType::f32,
                              .texcoords = true,
                              .values = {{"heat", ValueType::f32}, {"part", ValueType::u8, true}}});
  std::array<float, 10> to{1, 0, 0, 0, 1, 0.5F, 4, 7, 0, 1};
  const std::array<float, 10> other{0, 1, 0, 1, 1, 0.5F, 8, 9, 1, 0};
  rules.move(to.data(), other.data(), 0.25F);
  EXPECT_FLOAT_EQ(to[0], 0.75F);
  EXPECT_FLOAT_EQ(to[1], 0.25F);
  EXPECT_GT(to[3], 0.5F);  // a quarter of the light
  EXPECT_EQ(to[4], 1);
  EXPECT_EQ(to[5], 0.5F);
  EXPECT_EQ(to[6], 5);
  EXPECT_EQ(to[7], 7);  // of more weight
  EXPECT_FLOAT_EQ(to[8], 0.25F);
  EXPECT_FLOAT_EQ(to[9], 0.75F);
  EXPECT_TRUE(rules.is_quantity(6) && rules.is_quantity(7));
  EXPECT_FALSE(rules.is_quantity(5) || rules.is_quantity(8));
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
