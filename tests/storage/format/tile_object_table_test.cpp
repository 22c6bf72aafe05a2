// Tables of objects in tiles: there and back, within their bounds, and damaged.
#include "storage/format/tile_object_table.h"

#include "gltf/sample_hierarchy.h"
#include "storage/format/glb.h"
#include "storage/format/tile_glb.h"
#include "support/decode_failure.h"
#include "support/open_glb.h"
#include "support/same_tile.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using storage::decode_tile;
using storage::encode_tile;
using storage::make_tile_objects;
using storage::ObjectColumns;
using testing::ElementsAre;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;
using Json = nlohmann::ordered_json;
using Properties = std::vector<ObjectProperty>;

const Properties kAllTypes{{"height", ObjectPropertyType::number},
                           {"is listed", ObjectPropertyType::boolean},
                           {"name", ObjectPropertyType::text},
                           {"7 built", ObjectPropertyType::date}};

SampleHierarchy sample_of(const Properties& properties, const std::string& value = "quality") {
  const AttributeLayout layout{
      .normals = true, .values = {{value, ValueType::f32}, {"object", ValueType::u32, true, true}}};
  return with_objects(with_copies(make_sample(torus(250, 0.05F), 5, {layout, {}})), properties);
}

TEST(TileObjectTable, ComesBackInAnyCompression) {
  for (const Properties& properties : {Properties{}, kAllTypes}) {
    for (const auto compression :
         {storage::Compression::none, storage::Compression::zlib, storage::Compression::meshopt,
          storage::Compression::meshopt_zlib}) {
      SampleHierarchy sample = sample_of(properties);
      sample.format.compression = compression;
      for (const PublishedTile& tile : sample.tiles) {
        const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
        const PublishedTile back =
            decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName);
        EXPECT_TRUE(back.objects == tile.objects);
        EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
      }
    }
  }
}

TEST(TileObjectTable, TakesItsAttributeFromNoValue) {
  const SampleHierarchy sample = sample_of(kAllTypes, "FEATURE_ID_0");
  const Json root = OpenGlb(encode_tile(sample.tiles.front(), sample.tree, sample.format)).json;
  const Json& attributes = root["meshes"][0]["primitives"][0]["attributes"];
  const auto type_of = [&](const char* name) -> unsigned {
    return root["accessors"][attributes.at(name).get<std::size_t>()]["componentType"];
  };
  constexpr unsigned kU16 = 5123, kF32 = 5126;
  EXPECT_EQ(type_of("_FEATURE_ID_0"), kU16);
  EXPECT_EQ(type_of("_FEATURE_ID_0_2"), kF32);
  const Json& metadata = root["extensions"]["EXT_structural_metadata"];
  EXPECT_EQ(metadata["propertyAttributes"][0]["properties"]["FEATURE_ID_0"]["attribute"],
            "_FEATURE_ID_0_2");
}

/// The texts of a column, as a viewer reads them.
std::vector<std::string> texts_of(const TileObjects& objects, const storage::ObjectColumn& column) {
  std::vector<std::string> texts;
  const auto start = [&](std::size_t i) {
    return storage::load_little<std::uint32_t>(objects.table.data() + column.starts + 4 * i);
  };
  for (std::size_t i = 0; i < objects.objects.size(); ++i)
    texts.emplace_back(
        reinterpret_cast<const char*>(objects.table.data() + column.values + start(i)),
        start(i + 1) - start(i));
  return texts;
}

TEST(TileObjectTable, HasAColumnForEachProperty) {
  const TileObjects made =
      make_tile_objects(std::array{3U, 4U, 8U}, kAllTypes,
                        [](std::uint32_t object) { return sample_object(object, kAllTypes); });
  const ObjectColumns columns({kAllTypes, 3, made.columns, made.text_bytes});
  ASSERT_EQ(columns.bytes, made.table.size());
  ASSERT_EQ(columns.columns.size(), 6U);
  EXPECT_EQ(columns.columns[4].id, "name_2");
  EXPECT_EQ(columns.columns[5].id, "_7_built");
  EXPECT_THAT(texts_of(made, columns.columns[1]),
              ElementsAre("Gebäude/3", "Gebäude/4", "Gebäude/8"));
  EXPECT_THAT(texts_of(made, columns.columns[4]),
              ElementsAre("", "xé€", std::string(200, 'x') + "é€"));
  const auto number = [&](std::size_t i) {
    return storage::load_little<double>(made.table.data() + columns.columns[2].values + 8 * i);
  };
  EXPECT_EQ(number(0), std::numeric_limits<double>::lowest());
  EXPECT_EQ(number(1), 4 / 7.0);
  const std::byte* listed = made.table.data() + columns.columns[3].values;
  EXPECT_THAT((std::vector(listed, listed + 3)),
              ElementsAre(std::byte{255}, std::byte{1}, std::byte{0}));
}

TEST(TileObjectTable, CutsTextsBetweenCharacters) {
  const TileObjects made = make_tile_objects(std::array{0U}, {}, [](std::uint32_t) {
    return ObjectRow{std::string(254, 'n') + "€€", {}, {}, 0, 0};
  });
  EXPECT_THAT(made.text_bytes, ElementsAre(254U));
}

TEST(TileObjectTable, LeavesOutTheLastColumnsThatAreTooMuch) {
  Properties many;
  for (int i = 0; i < 60; ++i)
    many.push_back({"p" + std::to_string(i), ObjectPropertyType::text});
  std::vector<std::uint32_t> objects(2000);
  for (std::uint32_t i = 0; i < objects.size(); ++i)
    objects[i] = 3 * i + 2;
  const TileObjects made = make_tile_objects(
      objects, many, [&](std::uint32_t object) { return sample_object(object, many); });
  EXPECT_LE(made.table.size(), storage::kMostTileTableBytes);
  EXPECT_GE(made.table.size(), storage::kMostTileTableBytes - 500'000);
  EXPECT_LT(made.columns, 62U);

  const TileObjects named =
      make_tile_objects(std::array{1U}, Properties{{std::string(255, 'a'), {}}}, [](auto) {
        return ObjectRow{"", {1.0}, {}, 0, 0};
      });
  EXPECT_EQ(named.columns, 3U);
  Properties wordy;
  for (int i = 10; i < 40; ++i)
    wordy.push_back({std::string(250, 'a') + std::to_string(i), {}});
  EXPECT_EQ(make_tile_objects(std::array{1U}, wordy,
                              [&](std::uint32_t) {
                                return ObjectRow{"", std::vector<ObjectValue>(30), {}, 0, 0};
                              })
                .columns,
            2U + 4096 / 252);
}

TEST(TileObjectTable, SANITIZED_WhatDoesNotFitIsRefused) {
  const SampleHierarchy sample = sample_of(kAllTypes);
  const PublishedTile& tile = sample.tiles.front();
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  const auto failure = [&](const auto& damage) {
    OpenGlb glb(bytes);
    damage(glb);
    return decode_failure(glb.close(), tile.node, sample);
  };
  EXPECT_EQ(failure([](OpenGlb&) {}), "");
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.extension()["objectCount"] = 0; }),
              HasSubstr("without a row"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.extension()["objectCount"] = 1U << 25; }),
              HasSubstr("objectCount"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.extension()["objectColumns"] = 7; }),
              HasSubstr("objectColumns"));
  EXPECT_THAT(failure([](OpenGlb& glb) {
                glb.extension()["objectTextBytes"] = {1, 2};
              }),
              HasSubstr("objectTextBytes"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.extension()["objectTextBytes"][0] = -1; }),
              HasSubstr("objectTextBytes"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.extension()["objectTextBytes"][0] = 4294967295U; }),
              HasSubstr("BIN"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.view("objectTable")[0] ^= std::byte{1}; }),
              HasSubstr("row"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.view("objectTable")[3] ^= std::byte{255}; }),
              HasSubstr("ascend"));
  EXPECT_THAT(failure([](OpenGlb& glb) { glb.attribute("_FEATURE_ID_0")[1] ^= std::byte{255}; }),
              HasSubstr("row"));
  const ObjectColumns columns(
      {kAllTypes, tile.objects.objects.size(), tile.objects.columns, tile.objects.text_bytes});
  EXPECT_THAT(failure([&](OpenGlb& glb) {
                glb.view("objectTable")[columns.columns[1].starts + 7] ^= std::byte{255};
              }),
              HasSubstr("follow"));
}

}  // namespace
}  // namespace meshhier::tests
