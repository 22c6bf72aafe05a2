// Implicit tiles of 3D Tiles: which of them are there, and what is refused.
#include "base/error.h"
#include "import/imported.h"
#include "mesh_io/tile_volume.h"
#include "support/gltf_builder.h"
#include "tests/support/error_message.h"
#include "tests/support/gzip.h"
#include "tests/support/memory_files.h"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::GltfBuilder;
using tests::GltfJson;
using tests::little;

std::string triangle_at(float x) {
  GltfBuilder gltf;
  const std::vector<float> corners{x, 0, 0, x + 0.5F, 0, 0, x, 1, 0};
  gltf.show({{"attributes", {{"POSITION", gltf.accessor(corners, "VEC3")}}}});
  return gltf.glb();
}

/// Bits of a text such as "10110".
std::string bits_of(const std::string& text) {
  std::string bytes((text.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '1')
      bytes[i / 8] = static_cast<char>(bytes[i / 8] | 1 << i % 8);
  }
  return bytes;
}

/// 8 bytes.
std::string word_of(std::size_t number) {
  return little(static_cast<std::uint32_t>(number)) + little(0);
}

/// A subtree with availabilities of tiles, contents and child subtrees, each "0", "1" (constant) or
/// bits.
struct SubtreeText {
  GltfJson json = {{"bufferViews", GltfJson::array()}, {"buffers", GltfJson::array()}};
  std::string bits;

  SubtreeText(const std::string& tiles, const std::vector<std::string>& contents,
              const std::string& children) {
    json["tileAvailability"] = add(tiles);
    for (const std::string& content : contents)
      json["contentAvailability"].push_back(add(content));
    json["childSubtreeAvailability"] = add(children);
  }
  GltfJson add(const std::string& text) {
    if (text.size() == 1)
      return {{"constant", text == "1" ? 1 : 0}};
    const std::string bytes = bits_of(text);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bits.size()}, {"byteLength", bytes.size()}});
    bits += bytes;
    bits.resize((bits.size() + 7) / 8 * 8);
    return {{"bitstream", json["bufferViews"].size() - 1}};
  }
  std::string binary() {
    if (!bits.empty())
      json["buffers"] = {{{"byteLength", bits.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 7) / 8 * 8, ' ');
    return "subt" + little(1) + word_of(text.size()) + word_of(bits.size()) + text + bits;
  }
  std::string plain(const std::string& buffer) {
    json["buffers"] = {{{"byteLength", bits.size()}, {"uri", buffer}}};
    return json.dump();
  }
};

class ImplicitTilesTest : public testing::Test {
 protected:
  ImplicitTilesTest() {
    tiling_ = {{"subdivisionScheme", "QUADTREE"},
               {"subtreeLevels", 2},
               {"availableLevels", 4},
               {"subtrees", {{"uri", "s/{level}.{x}.{y}.subtree"}}}};
    root_ = {{"boundingVolume", {{"box", {0, 0, 0, 8, 0, 0, 0, 8, 0, 0, 0, 8}}}},
             {"geometricError", 9},
             {"refine", "REPLACE"},
             {"content", {{"uri", "{level}/{x}/{y}.glb"}}}};
  }
  void put(const std::string& name, const std::string& content) {
    files_.put(fs::path("w") / name, content);
  }
  /// Puts a tile whose triangle begins at `x`.
  void put_tile(const std::string& name, float x) { put(name, triangle_at(x)); }
  tests::Imported import() {
    root_["implicitTiling"] = tiling_;
    put("tileset.json",
        GltfJson{{"asset", {{"version", "1.1"}}}, {"geometricError", 100}, {"root", root_}}.dump());
    return tests::import_files(files_, fs::path("w/tileset.json"));
  }
  /// Where triangles begin.
  std::vector<double> found() {
    const tests::Imported mesh = import();
    std::vector<double> all;
    for (const auto& t : mesh.triangles)
      all.push_back(mesh.positions[t[0]].x);
    return all;
  }
  std::string failure() {
    return tests::error_message(ErrorCode::input, [&] { import(); });
  }

  tests::MemoryFiles files_;
  GltfJson tiling_, root_;
};

TEST_F(ImplicitTilesTest, TheFinestTilesOfAQuadtreeAreTheMesh) {
  // The root, its children (0, 0) and (1, 1), and below the latter the subtree of (3, 2).
  put("s/0.0.0.subtree", SubtreeText("11001", {"11001"}, "0000000000000100").binary());
  put("s/2.3.2.subtree", SubtreeText("10010", {"00010"}, "0").binary());
  put_tile("1/0/0.glb", 10);
  put_tile("3/6/5.glb", 20);
  EXPECT_THAT(found(), ElementsAre(10, 20)) << "0/0/0 and 1/1/1 are coarser, and not opened";
  const tests::Imported mesh = import();
  EXPECT_EQ(mesh.count("coarser_tiles"), 2);
  EXPECT_THAT(mesh.companions(),
              ElementsAre("w/tileset.json", "w/s/0.0.0.subtree", "w/s/2.3.2.subtree"));
}

TEST_F(ImplicitTilesTest, WhereTilesAddAllAreTheMesh) {
  put("s/0.0.0.subtree", SubtreeText("11001", {"11001"}, "0").binary());
  put_tile("0/0/0.glb", 5);
  put_tile("1/0/0.glb", 10);
  put_tile("1/1/1.glb", 15);
  root_["refine"] = "ADD";
  EXPECT_THAT(found(), ElementsAre(5, 10, 15));
}

TEST_F(ImplicitTilesTest, SubtreesHaveTheirBitsWithinBesideOrAsData) {
  SubtreeText subtree("11000", {"11000"}, "0");
  put_tile("1/0/0.glb", 10);
  put("s/0.0.0.subtree", tests::gzip(subtree.binary()));
  EXPECT_THAT(found(), ElementsAre(10));
  put("s/bits.bin", subtree.bits);
  put("s/0.0.0.subtree", subtree.plain("bits.bin"));
  EXPECT_THAT(found(), ElementsAre(10));
  EXPECT_THAT(import().companions(),
              ElementsAre("w/tileset.json", "w/s/0.0.0.subtree", "w/s/bits.bin"));
  put("s/0.0.0.subtree",
      subtree.plain("data:application/octet-stream;base64,AwAAAAAAAAADAAAAAAAAAA=="));
  EXPECT_THAT(found(), ElementsAre(10));
}

TEST_F(ImplicitTilesTest, AnOctreeHasThreeAxesAndSeveralContents) {
  tiling_["subdivisionScheme"] = "OCTREE";
  tiling_["subtrees"]["uri"] = "s/{level}.{x}.{y}.{z}.json";
  root_.erase("content");
  root_["contents"] = {{{"uri", "a{level}-{x}{y}{z}.glb"}}, {{"uri", "b{level}-{x}{y}{z}.glb"}}};
  put("s/0.0.0.0.json", SubtreeText("101000001", {"000000001", "001000001"}, "0").binary());
  put_tile("a1-111.glb", 10);
  put_tile("b1-100.glb", 20);
  put_tile("b1-111.glb", 30);
  EXPECT_THAT(found(), ElementsAre(20, 10, 30));
}

TEST_F(ImplicitTilesTest, TheExtensionOfTheVersionBeforeIsTheSame) {
  SubtreeText subtree("11000", {}, "0");
  subtree.json["contentAvailability"] = {{"constant", 1}};  // one, not a list
  subtree.json["tileAvailability"] = {{"bufferView", 0}};
  put("s/0.0.0.subtree", subtree.binary());
  put_tile("1/0/0.glb", 10);
  tiling_.erase("availableLevels");
  tiling_["maximumLevel"] = 1;
  root_["extensions"]["3DTILES_implicit_tiling"] = tiling_;
  put("tileset.json",
      GltfJson{{"asset", {{"version", "1.0"}}}, {"geometricError", 100}, {"root", root_}}.dump());
  EXPECT_EQ(tests::import_files(files_, fs::path("w/tileset.json")).triangles.size(), 1U);
}

TEST_F(ImplicitTilesTest, LevelsEndWhereTheTilesetSays) {
  put("s/0.0.0.subtree", SubtreeText("1", {"1"}, "1").binary());
  put_tile("0/0/0.glb", 5);
  tiling_["availableLevels"] = 1;
  EXPECT_THAT(found(), ElementsAre(5));
}

TEST_F(ImplicitTilesTest, WhatIsMissingOrWrongIsRefusedWithItsPlace) {
  put_tile("1/0/0.glb", 10);
  EXPECT_THAT(failure(), HasSubstr("root.implicitTiling.subtrees is s/0.0.0.subtree, which is no "
                                   "file below the folder"));
  put("s/0.0.0.subtree", SubtreeText("11000", {"11000"}, "1000000000000000").binary());
  EXPECT_THAT(failure(), HasSubstr("is s/2.0.0.subtree, which is no file"));
  put("s/0.0.0.subtree", SubtreeText("0", {"1"}, "0").binary());
  EXPECT_THAT(failure(), HasSubstr("w/s/0.0.0.subtree: is a subtree without its root"));
  put("s/0.0.0.subtree", SubtreeText("11000", {"1", "1"}, "0").binary());
  EXPECT_THAT(failure(), HasSubstr("tells of 2 contents of a tile, whose tileset names 1"));
  put("s/0.0.0.subtree", SubtreeText("11000", {"11000"}, "0").plain("../../out.bin"));
  EXPECT_THAT(failure(), HasSubstr("buffers[0] is ../../out.bin, which is no file below"));
  put("s/0.0.0.subtree", SubtreeText("11000", {"11000"}, "0000").binary());
  EXPECT_THAT(failure(), HasSubstr("bufferViews[2] has 1 bytes, expected 2 for the tiles of 2"));
  put("s/0.0.0.subtree", "{}");
  EXPECT_THAT(failure(), HasSubstr("no \"tileAvailability\""));
  const auto with = [this](const char* key, const GltfJson& value) {
    const GltfJson sound = tiling_;
    tiling_[key] = value;
    std::string why = failure();
    tiling_ = sound;
    return why;
  };
  EXPECT_THAT(with("subtreeLevels", 0), HasSubstr("has subtrees of no levels"));
  EXPECT_THAT(with("subtreeLevels", 14), HasSubstr("subtreeLevels is 14, expected"));
  EXPECT_THAT(with("availableLevels", 53), HasSubstr("availableLevels is 53, expected"));
  EXPECT_THAT(with("subdivisionScheme", "BINARY"), HasSubstr("\"QUADTREE\" or \"OCTREE\""));
  root_["children"] = {root_};
  EXPECT_THAT(failure(), HasSubstr("root has implicit tiles beside \"children\""));
}

TEST_F(ImplicitTilesTest, MoreTilesThanAreReadAreRefusedBeforeTheyAreOpened) {
  tiling_["subtreeLevels"] = 13;
  tiling_["availableLevels"] = 52;
  put("s/0.0.0.subtree", SubtreeText("1", {"1"}, "1").binary());
  EXPECT_THAT(failure(), HasSubstr("w/tileset.json: has more than 1048576 "));
}

TEST_F(ImplicitTilesTest, BrokenSubtreesAreRefused) {
  const std::string whole = SubtreeText("11000", {"11000"}, "0").binary();
  put_tile("1/0/0.glb", 10);
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    put("s/0.0.0.subtree", whole.substr(0, bytes));
    EXPECT_THAT(failure(), HasSubstr("w/s/0.0.0.subtree")) << bytes;
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char mask : {'\x01', '\x10', '\x7f', '\xff'}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ mask);
      put("s/0.0.0.subtree", changed);
      failure();  // or not, but no other error
    }
  }
}

TEST(TileVolumeTest, RegionsAndBoxesAreHalvedWithEachLevel) {
  const auto of = [](const char* kind, const GltfJson& numbers) {
    const GltfJson tile{{"boundingVolume", {{kind, numbers}}}};
    const fs::path path = "t";
    return *mesh_io::VolumeNumbers::of(mesh_io::GltfObject(tile, path));
  };
  const auto box = of("box", {10, 20, 30, 8, 0, 0, 0, 4, 0, 0, 0, 2});
  const auto part = box.part({2, {3, 0, 1}}, true).ball();
  EXPECT_EQ(part->middle, (Vec3d{10 + 6, 20 - 3, 30 - 0.5}));
  EXPECT_EQ(box.part({2, {3, 0, 1}}, false).ball()->middle, (Vec3d{16, 17, 30}));
  EXPECT_DOUBLE_EQ(part->radius, std::sqrt(4 + 1 + 0.25));

  // Across the antimeridian: the second half is west of it.
  constexpr double kPi = std::numbers::pi;
  const auto region = of("region", {kPi - 0.01, 0, -kPi + 0.03, 0.02, 0, 0});
  const auto east = of("region", {-kPi + 0.01, 0, -kPi + 0.03, 0.01, 0, 0}).ball();
  const auto half = region.part({1, {1, 0, 0}}, false).ball();
  EXPECT_NEAR(length(half->middle - east->middle), 0, 1e-3);
  EXPECT_NEAR(half->radius, east->radius, 1e-3);
}

}  // namespace
}  // namespace meshhier::importing
