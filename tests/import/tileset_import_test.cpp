// Tilesets of 3D Tiles: what their finest tiles become.
#include "base/error.h"
#include "config/input_frame.h"
#include "import/imported.h"
#include "import/open_picture.h"
#include "mesh_io/tileset.h"
#include "storage/io/forwarding_files.h"
#include "storage/io/zip_files.h"
#include "support/gltf_builder.h"
#include "tests/support/error_message.h"
#include "tests/support/gzip.h"
#include "tests/support/memory_files.h"
#include "tests/support/sample_texture.h"
#include "tests/support/zip_archive.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

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
using tests::Imported;
using tests::little;

/// A triangle from (x, 0, 0) on, in glTF's axes.
GltfBuilder triangle(float x = 0) {
  GltfBuilder gltf;
  const std::vector<float> corners{x, 0, 0, x + 1, 0, 0, x, 2, 0};
  gltf.show({{"attributes", {{"POSITION", gltf.accessor(corners, "VEC3")}}}});
  return gltf;
}

std::string word(std::size_t number) {
  return little(static_cast<std::uint32_t>(number));
}

std::string b3dm(const std::string& glb, std::string table = "", const std::string& binary = "",
                 const std::string& batches = "") {
  table.resize((table.size() + 7) / 8 * 8, ' ');
  return "b3dm" + word(1) + word(28 + table.size() + binary.size() + batches.size() + glb.size()) +
         word(table.size()) + word(binary.size()) + word(batches.size()) + word(0) + table +
         binary + batches + glb;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string cmpt(const std::vector<std::string>& tiles) {
  std::string all;
  for (const std::string& tile : tiles)
    all += tile;
  return "cmpt" + word(1) + word(16 + all.size()) + word(tiles.size()) + all;
}

GltfJson tile_of(const std::string& uri) {
  return {{"boundingVolume", {{"sphere", {0, 0, 0, 10}}}},
          {"geometricError", 0},
          {"content", {{"uri", uri}}}};
}

GltfJson moved(GltfJson tile, double x, double y, double z) {
  tile["transform"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1};
  return tile;
}

std::string tileset_of(const GltfJson& root, const std::string& version = "1.0") {
  return GltfJson{{"asset", {{"version", version}}}, {"geometricError", 100}, {"root", root}}
      .dump();
}

class TilesetImportTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) {
    files_.put(fs::path("w") / name, content);
  }
  Imported import(const GltfJson& root) {
    put("tileset.json", tileset_of(root));
    return tests::import_files(files_, fs::path("w/tileset.json"));
  }
  std::string failure(const GltfJson& root) {
    put("tileset.json", tileset_of(root));
    return failure();
  }
  std::string failure() {
    return tests::error_message(ErrorCode::input,
                                [&] { tests::import_files(files_, fs::path("w/tileset.json")); });
  }
  config::Config framed(const std::string& more = "") {
    return config::with_input_frame(
        files_, config::parse_config(R"({"input": "w/tileset.json", "output": "h")" + more + "}",
                                     {"config", {}}, std::vector<std::string>{}));
  }

  tests::MemoryFiles files_;
};

TEST_F(TilesetImportTest, TheFinestTilesAreTheMeshAndZIsUp) {
  put("coarse.glb", triangle(50).glb());
  put("a.glb", triangle().glb());
  put("b.glb", triangle(5).glb());
  GltfJson root = tile_of("coarse.glb");
  root["refine"] = "REPLACE";
  root["children"] = {tile_of("a.glb"), moved(tile_of("b.glb"), 0, 0, 7)};
  const Imported mesh = import(root);
  EXPECT_THAT(mesh.positions, ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 0, 2},
                                          Vec3d{5, 0, 7}, Vec3d{6, 0, 7}, Vec3d{5, 0, 9}));
  EXPECT_EQ(mesh.triangles.size(), 2);
  EXPECT_EQ(mesh.count("coarser_tiles"), 1);
  EXPECT_THAT(mesh.companions(), ElementsAre("w/tileset.json"));
  EXPECT_EQ(mesh.summary.files[0].format, "GLB");
  EXPECT_EQ(mesh.summary.files.back().format, "tileset");
  EXPECT_EQ(framed().up, UpAxis::z);
  EXPECT_FALSE(framed().placement.transform) << "it is nowhere in particular";
  EXPECT_EQ(framed(R"(, "up": "y")").up, UpAxis::y) << "as it is asked for";
}

TEST_F(TilesetImportTest, TilesThatAddAreAllOfIt) {
  put("coarse.glb", triangle(50).glb());
  put("a.glb", triangle().glb());
  put("b.glb", triangle(5).glb());
  GltfJson middle = tile_of("a.glb");  // adds as its parent does
  middle["children"] = {tile_of("b.glb")};
  GltfJson root = tile_of("coarse.glb");
  root["refine"] = "add";
  root["children"] = {middle};
  const Imported mesh = import(root);
  EXPECT_EQ(mesh.triangles.size(), 3);
  EXPECT_EQ(mesh.count("coarser_tiles"), 0);
}

TEST_F(TilesetImportTest, CentresAndTablesOfB3dm) {
  put("a.b3dm", b3dm(triangle().glb(), R"({"BATCH_LENGTH":0,"RTC_CENTER":[10,20,30]})"));
  GltfJson root = moved(tile_of("a.b3dm"), 1, 1, 1);
  const std::vector<Vec3d> expected{{11, 21, 31}, {12, 21, 31}, {11, 21, 33}};
  EXPECT_EQ(import(root).positions, expected);
  EXPECT_EQ(import(root).summary.files[0].format, "b3dm");

  const std::string numbers = GltfBuilder::bytes_of(std::vector<float>{-1, 10, 20, 30});
  put("a.b3dm", b3dm(triangle().glb(), R"({"BATCH_LENGTH":1,"RTC_CENTER":{"byteOffset":4}})",
                     numbers, R"({"id":[7]}      )"));
  EXPECT_EQ(import(root).positions, expected);

  put("a.b3dm", b3dm(triangle().glb(), R"({"RTC_CENTER":{"byteOffset":5}})", numbers));
  EXPECT_THAT(failure(root), HasSubstr("byteOffset is 5, expected an integer from 0 to 4"));
  put("a.b3dm", b3dm(triangle().glb(), R"({"RTC_CENTER":[1,2]})"));
  EXPECT_THAT(failure(root), HasSubstr("RTC_CENTER is a list, expected 3 numbers"));
}

TEST_F(TilesetImportTest, OlderHeadersOfB3dm) {
  const std::string glb = triangle().glb();
  const std::string batches = R"({"id":[1,2,3]} )";
  put("a.b3dm", "b3dm" + word(1) + word(20 + batches.size() + glb.size()) + word(3) +
                    word(batches.size()) + batches + glb);
  put("b.b3dm", "b3dm" + word(1) + word(24 + batches.size() + glb.size()) + word(batches.size()) +
                    word(0) + word(3) + batches + glb);
  put("c.b3dm", "b3dm" + word(1) + word(20 + glb.size()) + word(0) + word(0) + glb);
  GltfJson root = tile_of("a.b3dm");
  root["refine"] = "ADD";
  root["children"] = {tile_of("b.b3dm"), tile_of("c.b3dm")};
  EXPECT_EQ(import(root).triangles.size(), 3);
}

TEST_F(TilesetImportTest, TilesWithinTiles) {
  put("a.cmpt",
      cmpt({b3dm(triangle().glb()), cmpt({triangle(3).glb(), "i3dm" + word(1) + word(12)}),
            "pnts" + word(1) + word(12), "vctr" + word(1) + word(12),
            "geom" + word(1) + word(12)}));
  const Imported mesh = import(tile_of("a.cmpt"));
  EXPECT_EQ(mesh.triangles.size(), 2);
  EXPECT_EQ(mesh.positions[3], (Vec3d{3, 0, 0}));
  EXPECT_EQ(mesh.count("ignored_instanced_tiles"), 1);
  EXPECT_EQ(mesh.count("ignored_point_tiles"), 1);
  EXPECT_EQ(mesh.count("ignored_vector_tiles"), 2);
  EXPECT_THAT(
      mesh.warnings,
      ElementsAre("w/tileset.json: 1 i3dm tile left out: only tiles of meshes are read",
                  "w/tileset.json: 1 point tile left out: only tiles of meshes are read",
                  "w/tileset.json: 2 vector tiles left out: only tiles of meshes are read"));

  std::string deep = cmpt({triangle().glb()});
  for (int i = 0; i < 8; ++i)
    deep = cmpt({deep});
  put("a.cmpt", deep);
  EXPECT_THAT(failure(tile_of("a.cmpt")), HasSubstr("deeper than 8 levels"));
}

TEST_F(TilesetImportTest, TilesetsWithinTilesetsAndNamesAsServersTakeThem) {
  put("parts/one/tileset.json",
      tileset_of(moved(tile_of("../shared%20tile.glb?v=1.2"), 100, 0, 0)));
  put("parts/shared tile.glb", triangle().glb());
  GltfJson old = tile_of("");
  old["content"] = {{"url", "parts/one/tileset.json"}};  // before 1.0
  GltfJson several = tile_of("");
  several.erase("content");
  several["contents"] = {{{"uri", "parts/shared tile.glb"}}, {{"uri", "parts/shared tile.glb"}}};
  GltfJson extension = tile_of("");
  extension.erase("content");
  extension["extensions"]["3DTILES_multiple_contents"]["content"] = {
      {{"uri", "./parts/shared%20tile.glb#x"}}};
  GltfJson root = moved(tile_of(""), 0, 5, 0);
  root.erase("content");
  root["children"] = {old, several, extension};
  const Imported mesh = import(root);
  ASSERT_EQ(mesh.triangles.size(), 4);
  EXPECT_EQ(mesh.positions[0], (Vec3d{100, 5, 0}));
  EXPECT_EQ(mesh.positions[3], (Vec3d{0, 5, 0}));
  EXPECT_THAT(mesh.companions(), ElementsAre("w/tileset.json", "w/parts/one/tileset.json"));
}

TEST_F(TilesetImportTest, PicturesLieWithinTheTile) {
  GltfBuilder gltf = triangle();
  const std::vector<float> uv{0, 1, 1, 1, 0, 0};
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = gltf.accessor(uv, "VEC2");
  gltf.json["meshes"][0]["primitives"][0]["material"] =
      gltf.textured_material({{"bufferView", gltf.view("a picture")}, {"mimeType", "image/png"}});
  put("a.b3dm", b3dm(gltf.glb(), R"({"BATCH_LENGTH":0})"));
  const Imported mesh = import(tile_of("a.b3dm"));
  ASSERT_EQ(mesh.materials.images.size(), 1);
  const images::ImageSource& image = mesh.materials.images[0];
  EXPECT_EQ(image.file, "w/a.b3dm");
  EXPECT_EQ(files_.content("w/a.b3dm").substr(image.offset, image.bytes), "a picture");
}

TEST_F(TilesetImportTest, OtherAxesOfTheGltf) {
  put("a.glb", triangle().glb());
  const auto with_up = [&](const char* up) {
    GltfJson whole = GltfJson::parse(tileset_of(tile_of("a.glb")));
    whole["asset"]["gltfUpAxis"] = up;
    put("tileset.json", whole.dump());
    return tests::import_files(files_, fs::path("w/tileset.json")).positions;
  };
  EXPECT_THAT(with_up("Z"), ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 2, 0}));
  EXPECT_THAT(with_up("X"), ElementsAre(Vec3d{0, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0, 2, 0}));
}

// A place on the equator: east is +y there, north +z.
constexpr double kRadius = 6378137;

TEST_F(TilesetImportTest, ARootThatPlacesItOnTheGlobeIsItsPlace) {
  put("a.glb", triangle().glb());
  GltfJson root = tile_of("a.glb");
  const Transform place{0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, kRadius + 0.25, 0, 0, 1};
  root["transform"] = place;
  EXPECT_EQ(import(root).positions[1], (Vec3d{1, 0, 0}));
  EXPECT_EQ(framed().placement.transform, place);
  EXPECT_EQ(framed(R"(, "placement": {"longitude": 1, "latitude": 2})").placement.transform,
            std::nullopt)
      << "the config places it";
}

/// The largest distance of any point from where it should be.
double off(const std::vector<Vec3d>& found, const std::vector<Vec3d>& expected) {
  double most = found.size() == expected.size() ? 0 : 1e9;
  for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
    most = std::max(most, length(found[i] - expected[i]));
  return most;
}

TEST_F(TilesetImportTest, GeocentricTilesGetALocalFrame) {
  GltfBuilder gltf;  // a triangle in geocentric axes: z is glTF's y, y its -z
  const std::vector<float> corners{0, 0, 0, 0, 0, -1, 3, 2, 0};
  gltf.show({{"attributes", {{"POSITION", gltf.accessor(corners, "VEC3")}}}});
  put("a.b3dm", b3dm(gltf.glb(), R"({"RTC_CENTER":[6378137.25,0,0]})"));
  const std::vector<Vec3d> expected{{0, 0, 0.25}, {1, 0, 0.25}, {0, 2, 3.25}};
  for (const GltfJson& volume :
       {GltfJson{{"sphere", {kRadius + 0.3, 0, 0, 10}}},
        GltfJson{{"box", {kRadius - 0.3, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}}},
        GltfJson{{"region", {-1e-7, -1e-7, 1e-7, 1e-7, -1, 1}}}}) {
    GltfJson root = tile_of("a.b3dm");
    root["boundingVolume"] = volume;
    EXPECT_LT(off(import(root).positions, expected), 1e-8) << volume;
    const Transform place{0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, kRadius, 0, 0, 1};
    const Transform found = framed().placement.transform.value();
    for (std::size_t i = 0; i < place.size(); ++i)
      EXPECT_NEAR(found[i], place[i], 1e-12) << volume << i;
  }
}

TEST_F(TilesetImportTest, RegionsAcrossTheDateLineAndAtThePole) {
  put("a.glb", triangle().glb());
  const auto frame_of = [&](const GltfJson& region) {
    GltfJson root = tile_of("a.glb");
    root["boundingVolume"] = {{"region", region}};
    put("tileset.json", tileset_of(root));
    return mesh_io::globe_frame(files_, "w/tileset.json", {}).value().to_globe;
  };
  constexpr double kPi = 3.14159265358979;
  EXPECT_EQ(frame_of({kPi - 1e-6, -1e-7, -kPi + 1e-6, 1e-7, 0, 0}).offset, (Vec3d{-kRadius, 0, 0}));
  const auto pole = frame_of({-kPi, kPi / 2 - 1e-9, kPi, kPi / 2, 0, 0});
  EXPECT_EQ(pole.offset, (Vec3d{0, 0, 6356752}));
  EXPECT_FALSE(mesh_io::is_mirrored(pole));
  EXPECT_THAT(failure(GltfJson{{"boundingVolume", {{"region", {200, 0, 210, 1, 0, 0}}}},
                               {"content", {{"uri", "a.glb"}}}}),
              HasSubstr("has a region beyond half a turn"));
}

TEST_F(TilesetImportTest, TwoTilesetsShareTheFrameOfTheFirst) {
  put("a.glb", triangle().glb());
  const auto placed = [&](double up) {
    GltfJson root = tile_of("a.glb");
    root["transform"] = {0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, kRadius + up, 0, 0, 1};
    return tileset_of(root);
  };
  put("one.json", placed(0));
  put("two.json", placed(8));
  mesh_io::InputPaths both;
  both.assign({"w/one.json", "w/two.json"});
  EXPECT_LT(off(tests::import_files(files_, both).positions,
                {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}, {0, 0, 8}, {1, 0, 8}, {0, 0, 10}}),
            1e-8);
}

// A hierarchy's root moves by the origin first: what is read of it are the input's coordinates.
TEST_F(TilesetImportTest, AHierarchyIsReadInTheCoordinatesOfItsInput) {
  put("a.glb", triangle().glb());
  const Transform place{0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, kRadius + 0.25, 0, 0, 1};
  const auto read = [&](const Transform& transform, const char* generator) {
    GltfJson root = tile_of("a.glb");
    root["transform"] = transform;
    root["extras"]["origin"] = {1000, -20, 3};
    GltfJson whole = GltfJson::parse(tileset_of(root));
    whole["asset"]["extras"]["generator"] = generator;
    put("tileset.json", whole.dump());
    return tests::import_files(files_, fs::path("w/tileset.json")).positions;
  };
  Transform moved = kIdentity;
  moved[12] = 1000;
  moved[13] = -20;
  moved[14] = 3;
  const std::vector<Vec3d> input{{1000, -20, 3}, {1001, -20, 3}, {1000, -20, 5}};
  EXPECT_EQ(read(moved, "meshhier 9"), input) << "it is nowhere in particular";
  EXPECT_FALSE(framed().placement.transform);

  Transform there = place;  // after the move by the origin
  there[12] += 3;
  there[13] += 1000;
  there[14] += -20;
  EXPECT_EQ(read(there, "meshhier 9"), input);
  EXPECT_EQ(framed().placement.transform, place);
  EXPECT_EQ(read(there, "another"), (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}));
  EXPECT_EQ(framed().placement.transform, there);
}

TEST_F(TilesetImportTest, WhatCannotBeReadIsRefusedWithItsPlace) {
  put("a.glb", triangle().glb());
  put("../outside.glb", triangle().glb());
  GltfJson implicit = tile_of("a.glb");
  implicit["implicitTiling"] = {{"subdivisionScheme", "QUADTREE"}};
  EXPECT_THAT(failure(implicit), HasSubstr("root.implicitTiling has no \"subtrees\""));
  EXPECT_THAT(failure(tile_of("https://host/a.b3dm")), HasSubstr("fetch the whole tileset first"));
  EXPECT_THAT(failure(tile_of("b.glb")),
              HasSubstr("root.content is b.glb, which is no file below the folder"));
  EXPECT_THAT(failure(tile_of("../outside.glb")), HasSubstr("no file below the folder"));
  EXPECT_THAT(failure(tile_of("/w/a.glb")), HasSubstr("no file below the folder"));
  EXPECT_THAT(failure(tile_of("tileset.json")), HasSubstr("is a tileset that holds itself"));
  GltfJson nothing = tile_of("");
  nothing["content"] = GltfJson::object();
  EXPECT_THAT(failure(nothing), HasSubstr("root.content has no \"uri\""));
  nothing.erase("content");
  EXPECT_THAT(failure(nothing), HasSubstr("is a tileset without a mesh in its finest tiles"));
  GltfJson bent = tile_of("a.glb");
  bent["transform"] = {1, 2};
  EXPECT_THAT(failure(bent), HasSubstr("root.transform is a list, expected 16 numbers"));
  put("tileset.json", R"({"asset": {"version": "1.0"}, "geometricError": 1})");
  EXPECT_THAT(failure(), HasSubstr("its JSON has no \"root\""));
}

TEST_F(TilesetImportTest, BrokenTilesAreRefused) {
  const std::string whole = b3dm(triangle().glb(), R"({"BATCH_LENGTH":0})");
  const auto refused = [&](const std::string& content) {
    put("a.b3dm", content);
    return failure(tile_of("a.b3dm"));
  };
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes)
    EXPECT_THAT(refused(whole.substr(0, bytes)), HasSubstr("w/a.b3dm")) << bytes;
  EXPECT_THAT(refused("b3dm" + word(2) + word(28) + std::string(16, '\0')),
              HasSubstr("of version 2, expected 1"));
  EXPECT_THAT(refused("b3dm" + word(1) + word(28) + word(1000) + std::string(12, '\0')),
              HasSubstr("reach beyond its end"));
  EXPECT_THAT(refused("cmpt" + word(1) + word(16) + word(4000000000)),
              HasSubstr("ends behind 0 of 4000000000 tiles"));
  EXPECT_THAT(refused("cmpt" + word(1) + word(28) + word(1) + "b3dm" + word(1) + word(13)),
              HasSubstr("a tile of 13 bytes begins, but the composite has 12 more"));
  EXPECT_EQ(refused(tests::gzip(whole)), "");
  const std::string packed = tests::gzip(whole);
  for (std::size_t bytes = 1; bytes < packed.size(); bytes += 7)
    EXPECT_THAT(refused(packed.substr(0, bytes)), HasSubstr("w/a.b3dm")) << bytes;
  for (std::size_t bytes = 1; bytes < whole.size(); bytes += 7)
    EXPECT_THAT(refused(tests::gzip(whole.substr(0, bytes))), HasSubstr("w/a.b3dm")) << bytes;
  EXPECT_THAT(refused("cmpt" + word(1) + word(16 + 12 * 70000) + word(70000) +
                      [] {
                        std::string tiles;
                        for (int i = 0; i < 70000; ++i)
                          tiles += "i3dm" + word(1) + word(12);
                        return tiles;
                      }()),
              HasSubstr("holds more than 65536 tiles"));
  EXPECT_THAT(refused("i3dm" + word(1) + word(12)), HasSubstr("without a mesh"));
  EXPECT_THAT(refused("plainly nothing"), HasSubstr("found 'plainly nothing'"));
}

TEST_F(TilesetImportTest, ATilesetIsKnownByItsRootWhereverThatStands) {
  put("a.glb", triangle().glb());
  const std::string root = tile_of("a.glb").dump();
  const std::string bare =
      R"({"boundingVolume": {"sphere": [0, 0, 0, 9]}, "content": {"url": "a.glb"}})";
  const std::string text(200000, 'x'), wide(60000, '\xc3');
  std::string umlauts;
  for (const char c : wide)
    umlauts += {c, '\xa4'};
  for (const std::string& whole : {R"({"asset": {"version": "1.1"}, "schema": {"id": ")" + text +
                                       R"("}, "geometricError": 1, "root": )" + root + "}",
                                   R"({"extras": {"a": [")" + umlauts + R"("]}, "root": )" + root +
                                       R"(, "asset": {"version": "1.0"}})",
                                   R"({"asset": {"version": "0.0"}, "root": )" + bare + "}",
                                   "\xef\xbb\xbf \n{\"root\": " + bare + ", \"asset\": {}}",
                                   R"({"properties": {"scenes": {"meshes": 1}}, "root": )" + root +
                                       R"(, "asset": {"extras": "x"}})"}) {
    put("tileset.json", whole);
    EXPECT_EQ(tests::import_files(files_, fs::path("w/tileset.json")).triangles.size(), 1)
        << whole.substr(0, 60);
    put("inner.json", whole);
    EXPECT_EQ(import(tile_of("inner.json")).triangles.size(), 1) << whole.substr(0, 60);
  }
}

TEST_F(TilesetImportTest, AGltfThatHasItsWordsIsNone) {
  GltfBuilder gltf = triangle();
  gltf.json["asset"]["extras"] = {{"geometricError", 12.5}, {"root", {{"asset", 1}}}};
  put("a.bin", gltf.bin);
  put("a.gltf", gltf.text("a.bin"));
  EXPECT_EQ(tests::import_files(files_, fs::path("w/a.gltf")).triangles.size(), 1);
  EXPECT_EQ(import(tile_of("a.gltf")).triangles.size(), 1);
}

TEST_F(TilesetImportTest, AnExternalTilesetRefinesAsTheTileThatNamesIt) {
  for (const char* name : {"a.glb", "ext/b.glb", "ext/c.glb"})
    put(name, triangle().glb());
  const auto triangles = [&](const char* outer, const char* inner) {
    GltfJson external = tile_of("b.glb");
    external["children"] = {tile_of("c.glb")};
    if (inner != nullptr)
      external["refine"] = inner;
    put("ext/tileset.json", tileset_of(external));
    GltfJson root = tile_of("a.glb");
    root["refine"] = outer;
    root["children"] = {tile_of("ext/tileset.json")};
    return import(root).triangles.size();
  };
  EXPECT_EQ(triangles("ADD", nullptr), 3);
  EXPECT_EQ(triangles("ADD", "REPLACE"), 2);
  EXPECT_EQ(triangles("REPLACE", nullptr), 1);
  EXPECT_EQ(triangles("REPLACE", "ADD"), 2);
}

TEST_F(TilesetImportTest, AVolumeOfTheGlobeLeavesThePlaceToTheTiles) {
  put("a.glb", triangle().glb());
  const Transform place{0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, kRadius + 0.25, 0, 0, 1};
  constexpr double kPi = 3.14159265358979;
  for (const GltfJson& volume :
       {GltfJson{{"sphere", {0, 0, 0, kRadius}}},
        GltfJson{{"box", {0, 0, 0, kRadius, 0, 0, 0, kRadius, 0, 0, 0, kRadius}}},
        GltfJson{{"box", {kRadius - 3e5, 1e6, 2e5, 5e5, 0, 0, 0, 2e6, 0, 0, 0, 2e6}}},
        GltfJson{{"region", {-kPi, -kPi / 2, kPi, kPi / 2, -100, 9000}}},
        GltfJson{{"region", {-0.3, 0.5, 0.2, 0.9, 0, 100}}}, GltfJson::object()}) {
    GltfJson root = tile_of("");
    root.erase("content");
    root["boundingVolume"] = volume;
    GltfJson tower = tile_of("a.glb");
    tower["transform"] = place;
    root["children"] = {tower};
    EXPECT_EQ(import(root).positions[1], (Vec3d{1, 0, 0})) << volume << " exactly";
    EXPECT_EQ(framed().placement.transform, place) << volume;

    put("ext/tileset.json", tileset_of(tower));  // also where another document has it
    put("ext/a.glb", triangle().glb());
    root["children"] = {tile_of("ext/tileset.json")};
    EXPECT_EQ(import(root).positions[1], (Vec3d{1, 0, 0})) << volume;

    GltfJson other = tower;  // with another one the middle of both
    other["transform"][13] = 200;
    root["children"] = {tower, other};
    EXPECT_EQ(import(root).triangles.size(), 2);
    const Transform middle = framed().placement.transform.value();
    EXPECT_NEAR(middle[12], kRadius, 1);
    EXPECT_NEAR(middle[13], 100, 1e-9) << volume;
  }
}

TEST_F(TilesetImportTest, CentresTellThePlaceIfVolumesDoNot) {
  put("a.b3dm", b3dm(triangle().glb(), R"({"RTC_CENTER":[0,6378137,0]})"));
  GltfJson root = tile_of("a.b3dm");
  root["boundingVolume"] = {{"sphere", {0, 0, 0, kRadius}}};
  import(root);
  EXPECT_EQ(framed().placement.transform.value()[13], kRadius);
  put("b.b3dm", b3dm(triangle().glb(), R"({"RTC_CENTER":[0,-6378137,0]})"));
  root["contents"] = {{{"uri", "b.b3dm"}}};
  import(root);
  EXPECT_FALSE(framed().placement.transform) << "all around the globe";
}

TEST_F(TilesetImportTest, DocumentsThatMakeAnyNumberOfTilesAreRefusedSoon) {
  put("a.glb", triangle().glb());
  const auto name = [](int i) { return "part" + std::to_string(i) + ".json"; };
  const auto grow = [&](int documents) {
    for (int i = 0; i < documents; ++i) {
      GltfJson root = tile_of("");
      root.erase("content");
      root["children"] = GltfJson::array();
      for (int k = 0; k < 10; ++k)
        root["children"].push_back(tile_of(i + 1 < documents ? name(i + 1) : "a.glb"));
      put(name(i), tileset_of(root));
    }
    put("tileset.json", files_.content("w/" + name(0)));
  };
  grow(12);
  EXPECT_THAT(failure(), HasSubstr("is a tileset of 1222222222221 tiles, as its 12 documents name "
                                   "each other; up to 1048576 are read"));
  grow(40);
  EXPECT_THAT(failure(), HasSubstr("more than 1000000000000000000 tiles"));
  grow(3);
  EXPECT_EQ(tests::import_files(files_, fs::path("w/tileset.json")).triangles.size(), 1000);
  grow(70);
  EXPECT_THAT(failure(), HasSubstr("deeper than 64 levels"));
}

TEST_F(TilesetImportTest, ContentsCountAsTilesDo) {
  put("a.glb", triangle().glb());
  for (const bool is_shown : {true, false}) {
    GltfJson many = tile_of("a.glb");
    many["contents"] = GltfJson(1500, GltfJson{{"uri", "a.glb"}});
    if (!is_shown)
      many["children"] = {tile_of("a.glb")};
    put("many.json", tileset_of(many));
    GltfJson root = tile_of("a.glb");
    root["children"] = GltfJson(1000, tile_of("many.json"));
    put("tileset.json", tileset_of(root));
    EXPECT_THAT(failure(), HasSubstr("; up to 1048576 are read")) << is_shown;
  }
}

/// Contents lie in the tile, packed or as data.
TEST_F(TilesetImportTest, ContentsInGzipAndAsDataAreReadWithTheirPictures) {
  GltfBuilder gltf = triangle();
  const std::vector<float> uv{0, 1, 1, 1, 0, 0};
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = gltf.accessor(uv, "VEC2");
  const std::vector<std::byte> png = tests::sample_png(5, 3, false);
  gltf.json["meshes"][0]["primitives"][0]["material"] = gltf.textured_material(
      {{"bufferView", gltf.view({reinterpret_cast<const char*>(png.data()), png.size()})},
       {"mimeType", "image/png"}});
  const std::string tile = b3dm(gltf.glb(), R"({"BATCH_LENGTH":0,"RTC_CENTER":[1,2,3]})");
  const auto data = [](const std::string& content) {
    return "data:application/octet-stream;base64," + base64(content);
  };
  put("a.b3dm", tests::gzip(tile));
  put("b.cmpt", tests::gzip(cmpt({tile})));
  put("c.json", tests::gzip(tileset_of(tile_of("a.b3dm"))));
  for (const std::string& uri :
       {std::string("a.b3dm"), std::string("b.cmpt"), std::string("c.json"), data(tile),
        data(cmpt({tile})), data(tests::gzip(tile)), data(tileset_of(tile_of("a.b3dm")))}) {
    SCOPED_TRACE(uri.substr(0, 60) + std::to_string(uri.size()));
    const Imported mesh = import(tile_of(uri));
    ASSERT_EQ(mesh.positions.size(), 3);
    EXPECT_EQ(mesh.positions[1], (Vec3d{2, 2, 3}));
    ASSERT_EQ(mesh.materials.images.size(), 1);
    const auto picture = open_picture(mesh.materials.images[0], files_);
    EXPECT_EQ(picture->info().width, 5);
    EXPECT_EQ(picture->info().height, 3);
  }
  EXPECT_THAT(failure(tile_of("data:model/gltf-binary,abc")), HasSubstr("that is no base64"));
  EXPECT_THAT(failure(tile_of("data:model/gltf-binary;base64,a$c")), HasSubstr("is no base64"));
  EXPECT_THAT(failure(tile_of(data("nothing"))), HasSubstr("found 'nothing'"));
}

TEST_F(TilesetImportTest, DeepTilesetsAreReadAndDeeperOnesRefused) {
  put("a.glb", triangle().glb());
  const auto nested = [&](int levels) {
    GltfJson tile = tile_of("a.glb");
    for (int i = 0; i < levels; ++i) {
      GltfJson parent = tile_of("a.glb");
      parent["children"] = GltfJson::array({tile});
      tile = parent;
    }
    return tile;
  };
  EXPECT_EQ(import(nested(200)).count("coarser_tiles"), 200);
  EXPECT_THAT(failure(nested(300)), HasSubstr("nested deeper than 512 levels"));
}

/// Tiles are read at once, each to a mesh of its own.
TEST_F(TilesetImportTest, ManyTilesAreOneMeshInTheirOrderWithTheirPictures) {
  const std::vector<float> uv{0, 1, 1, 1, 0, 0};
  constexpr int kTiles = 40;
  GltfJson root = tile_of("0.glb");
  root["refine"] = "ADD";
  root["children"] = GltfJson::array();
  for (int i = 0; i < kTiles; ++i) {
    GltfBuilder gltf = triangle(static_cast<float>(2 * i));
    GltfJson& primitive = gltf.json["meshes"][0]["primitives"][0];
    const std::string picture = std::to_string(i % 7) + ".png";
    if (i % 7 != 6)  // that one is missing
      put(picture, "x");
    primitive["attributes"]["TEXCOORD_0"] = gltf.accessor(uv, "VEC2");
    primitive["material"] = gltf.textured_material({{"uri", picture}});
    put(std::to_string(i) + ".glb", gltf.glb());
    if (i > 0)
      root["children"].push_back(tile_of(std::to_string(i) + ".glb"));
  }
  put("tileset.json", tileset_of(root));
  for (const importing::ImportMemory& memory : {tests::kRoomy, tests::kTight}) {
    const Imported mesh =
        tests::import_files(files_, fs::path("w/tileset.json"), {.memory = memory});
    ASSERT_EQ(mesh.triangles.size(), kTiles);
    EXPECT_EQ(mesh.materials.materials.size(), 36) << "one for tiles without a picture";
    EXPECT_EQ(mesh.materials.images.size(), 6);
    EXPECT_EQ(mesh.count("missing_images"), 5) << "each in its own file";
    for (int i = 0; i < kTiles; ++i) {
      const auto number = static_cast<std::size_t>(i);
      EXPECT_EQ(mesh.positions[mesh.triangles[number][0]].x, 2 * i);
      EXPECT_THAT(mesh.shown(number),
                  testing::StartsWith(i % 7 == 6 ? "#" : std::to_string(i % 7) + ".png"));
    }
  }
}

TEST_F(TilesetImportTest, TheFirstOfSeveralBrokenTilesIsTold) {
  GltfJson root = tile_of("0.glb");
  root["refine"] = "ADD";
  root["children"] = GltfJson::array();
  for (int i = 0; i < 20; ++i) {
    GltfBuilder gltf = triangle();
    if (i == 7 || i == 8 || i == 15)
      gltf.json["meshes"][0]["primitives"][0]["indices"] = 99;
    put(std::to_string(i) + ".glb", gltf.glb());
    if (i > 0)
      root["children"].push_back(tile_of(std::to_string(i) + ".glb"));
  }
  for (int i = 0; i < 5; ++i)
    EXPECT_THAT(failure(root), HasSubstr("w/7.glb"));
}

/// A tile of the tileset in an archive is another archive.
TEST_F(TilesetImportTest, ArchivesAreReadAsTheFoldersThatWerePacked) {
  GltfJson root = tile_of("a/0.glb");
  root["refine"] = "ADD";
  root["children"] = {tile_of("a/1.glb"), tile_of("part.3tz")};
  const std::string inner = tests::zip_of(
      {{"tileset.json", tileset_of(tile_of("2.glb")), 8}, {"2.glb", triangle(4).glb()}});
  put("town.3tz", tests::zip_of({{"a/0.glb", triangle(0).glb()},
                                 {"tileset.json", tileset_of(root)},
                                 {"a/1.glb", triangle(2).glb(), 8}}));
  storage::ZipFiles zip(files_);
  EXPECT_THROW(tests::import_files(zip, fs::path("w/town.3tz")), Error) << "part.3tz is not there";
  root["children"].erase(1);
  put("town.3tz", tests::zip_of({{"a/0.glb", triangle(0).glb()},
                                 {"tileset.json", tileset_of(root)},
                                 {"a/1.glb", triangle(2).glb(), 8}}));
  const Imported mesh = tests::import_files(zip, fs::path("w/town.3tz"));
  ASSERT_EQ(mesh.positions.size(), 6);
  EXPECT_EQ(mesh.positions[3].x, 2);
  EXPECT_THAT(mesh.companions(), ElementsAre("w/town.3tz/tileset.json"));

  put("part.3tz", inner);
  put("tileset.json", tileset_of(tile_of("part.3tz")));
  EXPECT_EQ(tests::import_files(zip, fs::path("w/tileset.json")).positions[0].x, 4);
  // Archives that lie beside each other name each other.
  put("parts/chain.3tz", tests::zip_of({{"tileset.json", tileset_of(tile_of("../part.3tz"))}}));
  put("tileset.json", tileset_of(tile_of("parts/chain.3tz")));
  EXPECT_EQ(tests::import_files(zip, fs::path("w/tileset.json")).positions[0].x, 4);
  put("chain.3tz", tests::zip_of({{"tileset.json", tileset_of(tile_of("part.3tz/2.glb"))}}));
  EXPECT_EQ(tests::import_files(zip, fs::path("w/chain.3tz")).positions[0].x, 4);
  put("parts/chain.3tz", tests::zip_of({{"tileset.json", tileset_of(tile_of("../../x.3tz"))}}));
  EXPECT_THROW(tests::import_files(zip, fs::path("w/parts/chain.3tz")), Error);
  put("other.3tz", "a mesh of another format");
  EXPECT_THROW(tests::import_files(zip, fs::path("w/other.3tz")), Error);
}

/// The index of an archive, which tells other programs where its files lie, counts for nothing.
TEST_F(TilesetImportTest, WhatArchivesHoldBesideTheirDirectoryDoesNotCount) {
  put("town.3tz", tests::zip_of({{"./town/0.glb", triangle(3).glb()},
                                 {"./town/tileset.json", tileset_of(tile_of("0.glb"))},
                                 {"@3dtilesIndex1@", std::string(24, '\xff')}}));
  storage::ZipFiles zip(files_);
  EXPECT_EQ(tests::import_files(zip, fs::path("w/town.3tz")).positions[0].x, 3)
      << "one folder down, below names that begin with a dot";
}

TEST_F(TilesetImportTest, ArchivesAndFoldersWithoutOneTilesetAreTold) {
  const auto failure_of = [&](const char* path, ErrorCode code) {
    storage::ZipFiles zip(files_);
    return tests::error_message(code, [&] { tests::import_files(zip, fs::path(path)); });
  };
  const std::string tileset = tileset_of(tile_of("0.glb"));
  put("none.3tz", tests::zip_of({{"0.glb", "g"}}));
  EXPECT_THAT(failure_of("w/none.3tz", ErrorCode::input),
              HasSubstr("w/none.3tz: holds no tileset.json"));
  put("two.3tz", tests::zip_of({{"a/tileset.json", tileset}, {"b/tileset.json", tileset}}));
  EXPECT_THAT(failure_of("w/two.3tz", ErrorCode::input),
              HasSubstr("are w/two.3tz/a/tileset.json and w/two.3tz/b/tileset.json"));
  put("cut.3tz", tests::zip_of({{"tileset.json", tileset}}).substr(0, 60));
  EXPECT_THAT(failure_of("w/cut.3tz", ErrorCode::input),
              HasSubstr("w/cut.3tz: the archive has no"));
  put("site/one/tileset.json", tileset);
  put("site/one/0.glb", triangle(8).glb());
  put("site/made/hierarchy.json", "{}");
  put("site/made/tileset.json", tileset);
  EXPECT_EQ(tests::import_files(files_, fs::path("w/site")).positions[0].x, 8);
  put("site/two/tileset.json", tileset);
  EXPECT_THAT(failure_of("w/site", ErrorCode::io),
              HasSubstr("the first are w/site/one/tileset.json and w/site/two/tileset.json; name"));
}

TEST_F(TilesetImportTest, MoreTilesThanTheBudgetHoldsAreRefused) {
  put("a.glb", triangle().glb());
  GltfJson root = tile_of("a.glb");
  root["refine"] = "ADD";
  root["children"] = {tile_of("a.glb"), tile_of("a.glb"), tile_of("a.glb")};
  put("tileset.json", tileset_of(root));
  mesh_io::TilesetRoom room{.tiles = 4};
  EXPECT_EQ(mesh_io::read_tileset(files_, "w/tileset.json", nullptr, room).meshes.size(), 4);
  room.tiles = 3;
  try {
    mesh_io::read_tileset(files_, "w/tileset.json", nullptr, room);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::budget);
    EXPECT_THAT(error.what(), HasSubstr("more than 3 tiles; give a larger memory_budget"));
  }
  EXPECT_EQ(mesh_io::TilesetRoom::of(256 << 20).tiles, 131072);
}

/// Counts how often each file is opened.
class OpenedFiles final : public storage::ForwardingFiles {
 public:
  using ForwardingFiles::ForwardingFiles;
  std::unique_ptr<storage::File> open(const fs::path& path) override {
    const std::lock_guard lock(mutex_);
    ++opened[path.filename().string()];
    return others().open(path);
  }
  std::map<std::string, int> opened;

 private:
  std::mutex mutex_;
};

TEST_F(TilesetImportTest, EachTileIsOpenedForItsHeadAndForItsMesh) {
  GltfJson root = tile_of("0.glb");
  root["refine"] = "ADD";
  for (int i = 0; i < 8; ++i)
    put(std::to_string(i) + ".glb", triangle(static_cast<float>(2 * i)).glb());
  for (int i = 1; i < 8; ++i)
    root["children"].push_back(tile_of(std::to_string(i) + ".glb"));
  put("tileset.json", tileset_of(root));
  OpenedFiles counted(files_);
  const Imported once = tests::import_files(counted, fs::path("w/tileset.json"));
  for (int i = 0; i < 8; ++i)
    EXPECT_EQ(counted.opened[std::to_string(i) + ".glb"], 2) << i;
  // Without room each is read where it lies, and again for its checksum.
  const Imported tight =
      tests::import_files(files_, fs::path("w/tileset.json"), {.memory = tests::kTight});
  EXPECT_EQ(once.positions, tight.positions);
  EXPECT_EQ(once.summary.checksum, tight.summary.checksum);
}

}  // namespace
}  // namespace meshhier::importing
