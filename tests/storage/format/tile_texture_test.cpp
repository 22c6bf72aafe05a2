// Pictures and texture coordinates in tiles: what is written is read, and nothing else is.
#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/tile_glb.h"
#include "support/decode_failure.h"
#include "support/open_glb.h"
#include "support/same_tile.h"
#include "support/sample_texture.h"
#include "tests/support/share.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::Compression;
using storage::encode_tile;
using testing::HasSubstr;

PublishedTile read_textured(const std::vector<std::byte>& bytes, NodeId node,
                            const SampleHierarchy& sample) {
  return storage::decode_tile(bytes, node, sample.tree, sample.format, "textured.glb");
}

struct PictureKind {
  TextureFormat format;
  AlphaMode alpha = AlphaMode::opaque;
};

std::vector<PictureKind> picture_kinds() {
  std::vector<PictureKind> kinds;
  for (const ImageFormat format :
       {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp, ImageFormat::ktx2}) {
    for (const AlphaMode alpha : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend})
      kinds.push_back({{format, 80, alpha != AlphaMode::mask}, alpha});
  }
  return kinds;
}

/// Returns samples of any layout, picture, lattice and kind of mesh, with computed normals and
/// copies and without.
std::vector<SampleHierarchy> textured_samples() {
  std::vector<SampleHierarchy> samples;
  for (const AttributeLayout& layout : sample_layouts_without_texcoords()) {
    const SampleHierarchy sample = with_copies(make_sample(torus(150, 0.05F), 3, {layout, {}}));
    samples.push_back(textured(sample));
    if (!layout.normals)
      samples.push_back(textured(shaded(sample), {ImageFormat::png}));
  }
  for (const PictureKind& kind : picture_kinds())
    samples.push_back(textured(make_sample(torus(100, 0.05F), 2), kind.format, kind.alpha));
  for (const int bits : {8, 20})
    samples.push_back(textured(quantized(with_copies(make_sample(open_grid(9, 9), 5)), bits)));
  for (const TestMesh& mesh : {non_manifold(150), soup(60), duplicates(120), points(40), points(3)})
    samples.push_back(textured(shaded(make_sample(mesh, 3))));
  return samples;
}

/// A tile with copies, computed normals, colours and splits.
SampleHierarchy full_textured(Compression compression = Compression::none) {
  const AttributeLayout layout{.colour = ColourType::u8};
  return textured(shaded(
      with_copies(make_sample(torus(200, 0.05F), 5, {layout, {1.5, 0, -1e7}, compression}))));
}

TEST(TileTextures, ComeBackHoweverTilesArePacked) {
  std::size_t splits = 0;
  for (SampleHierarchy& sample : textured_samples()) {
    for (const Compression compression :
         {Compression::none, Compression::zlib, Compression::meshopt, Compression::meshopt_zlib}) {
      sample.format.compression = compression;
      for (const PublishedTile& tile : sample.tiles) {
        const auto bytes = encode_tile(tile, sample.tree, sample.format);
        const PublishedTile back = read_textured(bytes, tile.node, sample);
        expect_same_mesh(tile, back);
        if (sample.tree.is_partition(tile.node))
          expect_same_attributes(tile, back);
        EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
        splits += back.shading.split_of.size();
      }
    }
  }
  EXPECT_GT(splits, 10000U);
}

/// The same with normal maps instead of pictures, of all tiles above the partitions.
SampleHierarchy mapped(SampleHierarchy sample, ImageFormat format) {
  sample.format.normal_maps = NormalMapFormat{format, 80};
  for (PublishedTile& tile : sample.tiles) {
    if (!sample.tree.is_partition(tile.node))
      add_normal_map(tile, sample_image(format));
  }
  return sample;
}

std::vector<SampleHierarchy> mapped_samples() {
  std::vector<SampleHierarchy> samples;
  for (const AttributeLayout& layout : sample_layouts()) {
    const SampleHierarchy sample = with_copies(make_sample(torus(150, 0.05F), 5, {layout, {}}));
    samples.push_back(mapped(sample, ImageFormat::jpeg));
    if (!layout.normals)
      samples.push_back(mapped(shaded(sample), ImageFormat::png));
  }
  samples.push_back(
      mapped(quantized(shaded(make_sample(open_grid(9, 9), 5)), 12), ImageFormat::webp));
  samples.push_back(mapped(shaded(make_sample(open_grid(9, 9), 5)), ImageFormat::ktx2));
  samples.push_back(mapped(shaded(make_sample(points(40), 3)), ImageFormat::jpeg));
  const SampleHierarchy shaded_torus = shaded(make_sample(torus(150, 0.05F), 5));
  for (const AlphaMode alpha : {AlphaMode::opaque, AlphaMode::mask})
    samples.push_back(with_relief(shaded_torus, ImageFormat::jpeg, ImageFormat::webp, alpha));
  samples.push_back(with_relief(shaded_torus, ImageFormat::ktx2, ImageFormat::ktx2));
  samples.push_back(with_relief(make_sample(torus(150), 5, {{.normals = true}, {}}),
                                ImageFormat::webp, ImageFormat::png));
  samples.push_back(
      with_relief(shaded(make_sample(points(40), 3)), ImageFormat::png, ImageFormat::png));
  return samples;
}

TEST(TileNormalMaps, ComeBackHoweverTilesArePacked) {
  std::size_t maps = 0;
  for (SampleHierarchy& sample : mapped_samples()) {
    for (const Compression compression : {Compression::none, Compression::meshopt_zlib}) {
      sample.format.compression = compression;
      for (const PublishedTile& tile : sample.tiles) {
        const auto bytes = encode_tile(tile, sample.tree, sample.format);
        const PublishedTile back = read_textured(bytes, tile.node, sample);
        expect_same_mesh(tile, back);
        EXPECT_EQ(back.normal_map, tile.normal_map);
        EXPECT_EQ(back.image, tile.image);
        EXPECT_EQ(back.shading.tangents.size(), tile.shading.tangents.size());
        EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
        maps += back.normal_map.empty() ? 0 : 1;
      }
    }
  }
  EXPECT_GT(maps, 50U);
}

TEST(TileNormalMaps, SANITIZED_ATangentThatIsNoneIsRefused) {
  const SampleHierarchy sample =
      mapped(shaded(make_sample(torus(200, 0.05F), 5)), ImageFormat::jpeg);
  const PublishedTile& root = sample.tiles.front();
  for (const TangentCode wrong :
       {TangentCode{0, 0, 0, 127}, {127, 127, 0, 127}, {127, 0, 0, 0}, {127, 0, 0, -128}}) {
    PublishedTile tile = root;
    tile.shading.tangents[3] = wrong;
    const auto bytes = encode_tile(tile, sample.tree, sample.format);
    EXPECT_THAT(decode_failure(bytes, tile.node, sample), HasSubstr("the tangent of vertex"));
  }
}

TEST(TileNormalMaps, APartitionHasNone) {
  SampleHierarchy sample = mapped(shaded(make_sample(torus(200, 0.05F), 5)), ImageFormat::jpeg);
  const PublishedTile& partition = sample.tiles.back();
  ASSERT_TRUE(sample.tree.is_partition(partition.node));
  PublishedTile tile = partition;
  add_normal_map(tile, sample_image(ImageFormat::jpeg));
  const auto bytes = encode_tile(tile, sample.tree, sample.format);
  EXPECT_THAT(decode_failure(bytes, tile.node, sample), HasSubstr("a normal map of a partition"));
}

TEST(TileNormalMaps, APictureAndAMapAreOfOneMaterialAndTheSameCoordinates) {
  const SampleHierarchy sample =
      with_relief(shaded(make_sample(torus(200, 0.05F), 5)), ImageFormat::jpeg, ImageFormat::webp);
  const PublishedTile& root = sample.tiles.front();
  OpenGlb glb(encode_tile(root, sample.tree, sample.format));
  EXPECT_EQ(glb.json["materials"][0].dump(),
            R"({"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":1,)"
            R"("baseColorTexture":{"index":0}},"doubleSided":true,"normalTexture":{"index":1}})");
  EXPECT_EQ(glb.json["textures"].dump(),
            R"([{"sampler":0,"source":0},)"
            R"({"sampler":0,"extensions":{"EXT_texture_webp":{"source":1}}}])");
  EXPECT_EQ(glb.json["images"][0]["mimeType"], "image/jpeg");
  EXPECT_EQ(glb.json["images"][1]["bufferView"], glb.extension()["normalMap"]);
  const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("TANGENT"));
  EXPECT_FALSE(attributes.contains("TEXCOORD_1"));
}

TEST(TileNormalMaps, SANITIZED_AMapOfOtherSidesThanItsPictureIsRefused) {
  const SampleHierarchy sample =
      with_relief(shaded(make_sample(torus(200, 0.05F), 5)), ImageFormat::jpeg, ImageFormat::jpeg);
  PublishedTile tile = sample.tiles.front();
  tile.normal_map.height *= 2;
  EXPECT_THAT(decode_failure(encode_tile(tile, sample.tree, sample.format), tile.node, sample),
              HasSubstr("picture and normal map have different sides"));
}

TEST(TileTextures, DoNotChangeTheMesh) {
  for (const SampleHierarchy& sample : textured_samples()) {
    SampleHierarchy plain = sample;
    plain.format.computed_normals = false;
    plain.format.textures.reset();
    for (PublishedTile tile : sample.tiles) {
      const PublishedTile back =
          read_textured(encode_tile(tile, sample.tree, sample.format), tile.node, sample);
      tile.shading = {};
      tile.image = {};
      PublishedTile other =
          read_textured(encode_tile(tile, plain.tree, plain.format), tile.node, plain);
      other.shading = back.shading;
      other.image = back.image;
      expect_same_mesh(other, back);
      expect_same_attributes(other, back);
    }
  }
}

TEST(TileTextures, APictureIsTheLastViewByteForByte) {
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const SampleHierarchy sample = full_textured(compression);
    const PublishedTile& tile = sample.tiles.back();
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    const auto number = glb.extension()["image"].get<std::size_t>();
    EXPECT_EQ(number + 1, glb.json["bufferViews"].size());
    const auto& view = glb.json["bufferViews"][number];
    EXPECT_EQ(view["buffer"], 0);
    EXPECT_EQ(view["byteLength"], tile.image.bytes.size());
    EXPECT_FALSE(view.contains("target"));
    EXPECT_FALSE(view.contains("extensions"));
    EXPECT_TRUE(std::ranges::equal(tile.image.bytes,
                                   std::span(glb.view("image"), tile.image.bytes.size())));
    EXPECT_EQ(glb.json["images"][0].dump(),
              fmt::format(R"({{"bufferView":{},"mimeType":"image/jpeg"}})", number));
  }
}

TEST(TileTextures, TheMaterialShowsThePicture) {
  for (const PictureKind& kind : picture_kinds()) {
    const SampleHierarchy sample =
        textured(make_sample(torus(100, 0.05F), 2), kind.format, kind.alpha);
    OpenGlb glb(encode_tile(sample.tiles.back(), sample.tree, sample.format));
    const auto& material = glb.json["materials"][0];
    EXPECT_EQ(material["pbrMetallicRoughness"].dump(),
              R"({"metallicFactor":0,"roughnessFactor":1,"baseColorTexture":{"index":0}})");
    EXPECT_EQ(material.value("alphaMode", "OPAQUE"),
              (std::array{"OPAQUE", "MASK", "BLEND"})[static_cast<std::size_t>(kind.alpha)]);
    EXPECT_EQ(material.contains("extensions"), kind.format.unlit);
    const bool webp = kind.format.format == ImageFormat::webp;
    const bool ktx2 = kind.format.format == ImageFormat::ktx2;
    EXPECT_EQ(glb.json["textures"][0].dump(),
              webp   ? R"({"sampler":0,"extensions":{"EXT_texture_webp":{"source":0}}})"
              : ktx2 ? R"({"sampler":0,"extensions":{"KHR_texture_basisu":{"source":0}}})"
                     : R"({"sampler":0,"source":0})");
    EXPECT_EQ(glb.json["images"][0]["mimeType"] == "image/ktx2", ktx2);
    EXPECT_EQ(glb.json["samplers"][0].dump(),
              R"({"magFilter":9729,"minFilter":9987,"wrapS":33071,"wrapT":33071})");
    const auto used = glb.json["extensionsUsed"];
    EXPECT_EQ(used.back(), "MESHHIER_tile");
    EXPECT_EQ(std::ranges::count(used, "KHR_materials_unlit"), kind.format.unlit ? 1 : 0);
    EXPECT_EQ(std::ranges::count(used, "EXT_texture_webp"), webp ? 1 : 0);
    EXPECT_EQ(std::ranges::count(used, "KHR_texture_basisu"), ktx2 ? 1 : 0);
    EXPECT_EQ(glb.json.contains("extensionsRequired"), webp || ktx2);
  }
}

TEST(TileTextures, ColoursDoNotTintThePicture) {
  const SampleHierarchy sample = full_textured();
  for (const PublishedTile& tile : sample.tiles) {
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_TRUE(attributes.contains("_COLOR_0"));
    EXPECT_FALSE(attributes.contains("COLOR_0"));
  }
}

TEST(TileTextures, ColoursThatTintAreThoseThatViewersMultiply) {
  const SampleHierarchy hidden = full_textured();
  SampleHierarchy sample = hidden;
  sample.format.attributes.tints = true;
  for (const PublishedTile& tile : sample.tiles) {
    const auto bytes = encode_tile(tile, sample.tree, sample.format);
    OpenGlb glb(bytes);
    const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_FALSE(attributes.contains("_COLOR_0"));
    EXPECT_TRUE(attributes.contains("COLOR_0"));
    const auto other = encode_tile(tile, hidden.tree, hidden.format);
    EXPECT_EQ(read_textured(bytes, tile.node, sample).mesh.vertices.attributes,
              read_textured(other, tile.node, hidden).mesh.vertices.attributes);
  }
}

TEST(TileTextures, ATileWithoutTrianglesHasNone) {
  const SampleHierarchy sample = textured(make_sample(points(50), 2));
  OpenGlb glb(encode_tile(sample.tiles.back(), sample.tree, sample.format));
  EXPECT_EQ(glb.extension()["image"], -1);
  EXPECT_EQ(glb.extension()["imageWidth"], 0);
  EXPECT_FALSE(glb.json.contains("images"));
  EXPECT_FALSE(glb.json["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_0"));
}

TEST(TileTextures, AHierarchyHasThemInAllTilesOrInNone) {
  SampleHierarchy with = textured(make_sample(torus(100), 2));
  SampleHierarchy without = make_sample(torus(100), 2);
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    with.format.compression = without.format.compression = compression;
    for (std::size_t i = 0; i < with.tiles.size(); ++i) {
      const NodeId node = with.tiles[i].node;
      const auto textured_bytes = encode_tile(with.tiles[i], with.tree, with.format);
      const auto bytes = encode_tile(without.tiles[i], without.tree, without.format);
      EXPECT_NE(decode_failure(textured_bytes, node, without), "");
      EXPECT_THAT(decode_failure(bytes, node, with), HasSubstr("\"splitCount\" is missing"));
    }
  }
}

// ---- damage

/// The first number of a split.
std::size_t first_split_number(OpenGlb& glb) {
  std::size_t vertices = 0;
  for (const char* key : {"ownCount", "ghostCount", "copyCount"})
    vertices += glb.extension()[key].get<std::size_t>();
  return vertices;
}

void store_texcoord(OpenGlb& glb, std::size_t number, float value) {
  storage::store_little(value, glb.attribute("TEXCOORD_0") + 4 * number);
}

nlohmann::ordered_json& image_view(OpenGlb& glb) {
  return glb.json["bufferViews"][glb.extension()["image"].get<std::size_t>()];
}

/// One change to a good file of the last tile of full_textured(), and what is said of it.
struct TextureDamage {
  const char* name;
  std::function<void(OpenGlb&)> apply;
  const char* message;
};
void PrintTo(const TextureDamage& damage, std::ostream* out) {
  *out << damage.name;
}

class DamagedTextures : public testing::TestWithParam<TextureDamage> {};

TEST_P(DamagedTextures, SANITIZED_AreRefusedByName) {
  const SampleHierarchy sample = full_textured();
  const PublishedTile& tile = sample.tiles.back();
  const auto bytes = encode_tile(tile, sample.tree, sample.format);
  ASSERT_EQ(decode_failure(bytes, tile.node, sample), "");
  OpenGlb glb(bytes);
  GetParam().apply(glb);
  EXPECT_THAT(decode_failure(glb.close(), tile.node, sample), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, DamagedTextures,
    testing::Values(
        TextureDamage{"no_picture", [](OpenGlb& g) { g.extension()["image"] = -1; }, "\"image\""},
        TextureDamage{"no_view", [](OpenGlb& g) { g.extension()["image"] = 15; },
                      "\"byteLength\" is missing"},
        TextureDamage{"another_view", [](OpenGlb& g) { g.extension()["image"] = 1; }, ""},
        TextureDamage{"views_are_no_array", [](OpenGlb& g) { g.json["bufferViews"] = 7; },
                      "\"byteLength\" is missing"},
        TextureDamage{"no_length", [](OpenGlb& g) { image_view(g).erase("byteLength"); },
                      "\"byteLength\" is missing"},
        TextureDamage{"length_0", [](OpenGlb& g) { image_view(g)["byteLength"] = 0; },
                      "a picture whose byteLength is 0"},
        TextureDamage{"length_too_short", [](OpenGlb& g) { image_view(g)["byteLength"] = 100; },
                      "the BIN chunk has"},
        TextureDamage{"length_too_long",
                      [](OpenGlb& g) { image_view(g)["byteLength"] = 4294967295U; },
                      "the BIN chunk has"},
        TextureDamage{"width_0", [](OpenGlb& g) { g.extension()["imageWidth"] = 0; },
                      "a picture whose imageWidth is 0"},
        TextureDamage{"height_0", [](OpenGlb& g) { g.extension()["imageHeight"] = 0; },
                      "a picture whose imageHeight is 0"},
        TextureDamage{"too_wide", [](OpenGlb& g) { g.extension()["imageWidth"] = 8193; },
                      "imageWidth"},
        TextureDamage{"no_height", [](OpenGlb& g) { g.extension().erase("imageHeight"); },
                      "\"imageHeight\" is missing"},
        TextureDamage{"another_mime_type",
                      [](OpenGlb& g) { g.json["images"][0]["mimeType"] = "image/gif"; },
                      "/images/0/mimeType"},
        TextureDamage{"not_that_of_its_alpha",
                      [](OpenGlb& g) { g.json["materials"][0]["alphaMode"] = "BLEND"; },
                      "/images/0/mimeType"},
        TextureDamage{"opaque_in_words",
                      [](OpenGlb& g) { g.json["materials"][0]["alphaMode"] = "OPAQUE"; },
                      "/materials/0"},
        TextureDamage{"no_sampler", [](OpenGlb& g) { g.json.erase("samplers"); }, "samplers"},
        TextureDamage{"no_texture", [](OpenGlb& g) { g.json.erase("textures"); }, "textures"},
        TextureDamage{"lit", [](OpenGlb& g) { g.json["materials"][0].erase("extensions"); },
                      "/materials/0"},
        TextureDamage{
            "nan",
            [](OpenGlb& g) { store_texcoord(g, 5, std::numeric_limits<float>::quiet_NaN()); },
            "the texture coordinate of vertex 2 is (0."},
        TextureDamage{"below_0", [](OpenGlb& g) { store_texcoord(g, 6, -1e-9F); },
                      "the texture coordinate of vertex 3 is (-1e-09"},
        TextureDamage{"above_1", [](OpenGlb& g) { store_texcoord(g, 1, std::nextafter(1.F, 2.F)); },
                      "the texture coordinate of vertex 0 is"},
        TextureDamage{"of_a_split",
                      [](OpenGlb& g) {
                        store_texcoord(g, 2 * first_split_number(g),
                                       std::numeric_limits<float>::infinity());
                      },
                      "(inf"},
        TextureDamage{
            "split_elsewhere",
            [](OpenGlb& g) { g.attribute("POSITION")[12 * first_split_number(g)] ^= std::byte{1}; },
            "split 0 has not the POSITION of its vertex"},
        TextureDamage{
            "split_of_another_colour",
            [](OpenGlb& g) { make_white(&g.attribute("_COLOR_0")[8 * first_split_number(g)]); },
            "split 0 has not the COLOR_0 of its vertex"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(TileTextures, SplitsKeepNormalsThatAreNotComputed) {
  const SampleHierarchy sample = textured(make_sample(torus(200), 2, {{.normals = true}, {}}));
  const PublishedTile& tile = sample.tiles.back();
  ASSERT_FALSE(tile.shading.split_of.empty());
  OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
  glb.attribute("NORMAL")[12 * first_split_number(glb)] ^= std::byte{1};
  EXPECT_THAT(decode_failure(glb.close(), tile.node, sample),
              HasSubstr("split 0 has not the NORMAL of its vertex"));
}

TEST(TileTextures, SANITIZED_RandomFlipsAreRefusedOrHarmless) {
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const SampleHierarchy sample = full_textured(compression);
    std::size_t refused = 0;
    for (std::size_t round = share().index; round < 2000; round += share().count) {
      std::mt19937 random(15'000 + static_cast<std::uint32_t>(round));
      const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
      auto bytes = encode_tile(tile, sample.tree, sample.format);
      const std::size_t bin = OpenGlb(bytes).bin.size() - tile.image.bytes.size() - 3;
      const std::size_t end = bytes.size() - tile.image.bytes.size() - 3;
      bytes[end - 1 - random() % bin] ^= static_cast<std::byte>(1U << random() % 8);
      if (!decode_failure(bytes, tile.node, sample).empty()) {
        ++refused;
        continue;
      }
      const PublishedTile read = read_textured(bytes, tile.node, sample);
      EXPECT_TRUE(std::ranges::all_of(read.shading.texcoords, [](const Vec2f& t) {
        return t.u >= 0 && t.u <= 1 && t.v >= 0 && t.v <= 1;
      }));
    }
    EXPECT_GT(refused, share().part_of(2000) / 4);
  }
}

TEST(TileTextures, SANITIZED_RandomNumbersInTheJsonAreRefused) {
  const SampleHierarchy sample = full_textured();
  const std::array<nlohmann::ordered_json, 5> values{-1, 0, 3, 4294967295U, "x"};
  for (std::size_t round = share().index; round < 1000; round += share().count) {
    std::mt19937 random(16'000 + static_cast<std::uint32_t>(round));
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    const nlohmann::ordered_json flat = glb.json.flatten();
    auto place = flat.begin();
    std::advance(place, static_cast<std::ptrdiff_t>(random() % flat.size()));
    const auto& value = values[random() % values.size()];
    // A boundary may be larger than it need be; what a picture's sides are is in its bytes alone.
    if (place.key().ends_with("rimCount") || place.key().find("/image") != std::string::npos)
      continue;
    const bool same = place.value() == value;
    glb.json[nlohmann::ordered_json::json_pointer(place.key())] = value;
    EXPECT_EQ(decode_failure(glb.close(), tile.node, sample).empty(), same) << place.key() << value;
  }
}

}  // namespace
}  // namespace meshhier::tests
