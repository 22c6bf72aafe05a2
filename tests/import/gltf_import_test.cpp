// glTF and GLB files: what they become.
#include "base/error.h"
#include "images/image_codec.h"
#include "images/ktx2_coder.h"
#include "import/imported.h"
#include "mesh_io/gltf_extensions.h"
#include "storage/format/tile_glb.h"
#include "support/gltf_builder.h"
#include "tests/gltf/sample_hierarchy.h"
#include "tests/support/error_message.h"
#include "tests/support/gzip.h"
#include "tests/support/memory_files.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::GltfBuilder;
using tests::GltfJson;
using tests::Imported;
using tests::ImportHow;
using Triangle3 = std::array<std::uint32_t, 3>;

const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const std::vector<float> kSquareUv{0, 1, 1, 1, 1, 0, 0, 0};
const std::vector<std::uint16_t> kSquareCorners{0, 1, 2, 0, 2, 3};

class GltfImportTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) {
    files_.put(fs::path("w") / name, content);
  }
  Imported import(const std::string& name, const ImportHow& how = {}) {
    return tests::import_files(files_, fs::path("w") / name, how);
  }
  Imported import(const GltfBuilder& gltf, const ImportHow& how = {}) {
    put("a.glb", gltf.glb());
    return import("a.glb", how);
  }
  std::string failure(const GltfBuilder& gltf, ErrorCode code = ErrorCode::input) {
    put("a.glb", gltf.glb());
    return failure("a.glb", code);
  }
  std::string failure(const std::string& name, ErrorCode code = ErrorCode::input) {
    return tests::error_message(code, [&] { import(name); });
  }

  tests::MemoryFiles files_;
};

/// The square's positions and corners.
GltfJson square(GltfBuilder& gltf) {
  return {{"attributes", {{"POSITION", gltf.accessor(kSquare, "VEC3")}}},
          {"indices", gltf.accessor(kSquareCorners, "SCALAR")}};
}

GltfJson textured_square(GltfBuilder& gltf, std::size_t material) {
  GltfJson primitive = square(gltf);
  primitive["attributes"]["TEXCOORD_0"] = gltf.accessor(kSquareUv, "VEC2");
  primitive["material"] = material;
  return primitive;
}

TEST_F(GltfImportTest, AGlbIsImportedBitForBit) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  const std::vector<float> normals{0, 0, 1, 0, 0, 2, 0.1F, 0, 1, 0, 0, 0};
  primitive["attributes"]["NORMAL"] = gltf.accessor(normals, "VEC3");
  gltf.show(primitive);
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.layout, AttributeLayout{.normals = true});
  EXPECT_EQ(mesh.attributes, normals);
  EXPECT_THAT(mesh.positions,
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{1, 1, 0}, Vec3d{0, 1, 0}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle3{0, 1, 2}, Triangle3{0, 2, 3}));
  EXPECT_EQ(mesh.summary.files[0].format, "GLB");
  EXPECT_EQ(mesh.summary.faces, 2U);
}

TEST_F(GltfImportTest, BuffersAreFilesOrData) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  put("data/the buffer.bin", gltf.bin);
  put("a.gltf", gltf.text("data/the%20buffer.bin"));
  const Imported external = import("a.gltf");
  EXPECT_EQ(external.positions.size(), 4U);
  ASSERT_EQ(external.summary.files.size(), 2U);
  EXPECT_EQ(external.summary.files[1].name, "the buffer.bin");
  EXPECT_EQ(external.summary.files[1].bytes, gltf.bin.size());

  GltfBuilder embedded;
  embedded.bin =
      std::string("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80?\0\0\0\0", 36);
  embedded.add("bufferViews", {{"buffer", 0}, {"byteLength", 36}});
  embedded.add("accessors",
               {{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  embedded.show({{"attributes", {{"POSITION", 0}}}});
  put("b.gltf", embedded.text("data:application/octet-stream;base64,"
                              "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"));
  EXPECT_THAT(import("b.gltf").positions,
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}));
}

TEST_F(GltfImportTest, FilesBesideAreLookedForOnlyBelowTheFolder) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  put("a.bin", gltf.bin);
  files_.put("b.bin", gltf.bin);
  for (const char* uri : {"../b.bin", "sub/../../b.bin", "/b.bin", "http://x/b.bin", "file:b.bin",
                          "%2e%2e/b.bin", "%2Fb.bin", "b%00.bin", "%zz", ""}) {
    put("a.gltf", gltf.text(uri));
    EXPECT_THAT(failure("a.gltf"), HasSubstr("a.gltf: buffers[0]")) << uri;
  }
  put("a.gltf", gltf.text("none.bin"));
  EXPECT_THAT(failure("a.gltf"), HasSubstr("w/none.bin is not there"));
  put("a.bin", gltf.bin.substr(1));
  put("a.gltf", gltf.text("a.bin"));
  EXPECT_THAT(failure("a.gltf"), HasSubstr("buffers[0] has 59 bytes, expected 60"));
}

TEST_F(GltfImportTest, AChangedBufferIsAnotherInput) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  put("a.bin", gltf.bin);
  put("a.gltf", gltf.text("a.bin"));
  const InputFiles input(files_, fs::path("w/a.gltf"), {});
  EXPECT_EQ(input.bytes(), gltf.bin.size() + files_.bytes("w/a.gltf").size());
  const std::uint64_t before = input.checksum(execution::CancelToken());
  EXPECT_EQ(import("a.gltf").summary.checksum, before);
  gltf.bin[5] = 'x';
  put("a.bin", gltf.bin);
  EXPECT_NE(input.checksum(execution::CancelToken()), before);
  put("a.bin", gltf.bin + "longer");
  EXPECT_THROW(input.check_unchanged(), Error);
}

TEST_F(GltfImportTest, StripsAndFansAreTurnedAsTheSpecificationSays) {
  const std::vector<float> five{0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0};
  for (const bool indexed : {false, true}) {
    for (const int mode : {4, 5, 6}) {
      GltfBuilder gltf;
      GltfJson primitive{{"attributes", {{"POSITION", gltf.accessor(five, "VEC3")}}},
                         {"mode", mode}};
      const std::vector<std::uint8_t> corners{0, 1, 2, 3, 4};
      if (indexed)
        primitive["indices"] = gltf.accessor(corners, "SCALAR");
      gltf.show(primitive);
      if (mode == 4) {
        EXPECT_THAT(failure(gltf), HasSubstr("has 5 elements for a list of triangles"));
        continue;
      }
      const Imported mesh = import(gltf);
      if (mode == 5) {
        EXPECT_THAT(mesh.triangles,
                    ElementsAre(Triangle3{0, 1, 2}, Triangle3{2, 1, 3}, Triangle3{2, 3, 4}));
      } else {
        EXPECT_THAT(mesh.triangles,
                    ElementsAre(Triangle3{0, 1, 2}, Triangle3{0, 2, 3}, Triangle3{0, 3, 4}));
      }
    }
  }
}

TEST_F(GltfImportTest, PointsAndLinesAreCounted) {
  GltfBuilder gltf;
  const GltfJson shown = square(gltf);
  gltf.show(shown);
  for (int mode = 0; mode < 4; ++mode) {
    GltfJson other = shown;
    other["mode"] = mode;
    gltf.show(other);
  }
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.count("ignored_points_and_lines"), 4U);
}

TEST_F(GltfImportTest, NodesPlaceTurnAndMirrorMeshes) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["attributes"]["NORMAL"] =
      gltf.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0, 1}, "VEC3");
  const std::size_t mesh_number = gltf.mesh(primitive);
  // A quarter turn around z, then the parent doubles and mirrors x.
  gltf.node({{"children", {1}}, {"scale", {-2, 1, 1}}, {"translation", {10, 0, 0}}});
  gltf.node({{"mesh", mesh_number}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}});
  const Imported mesh = import(gltf);
  ASSERT_EQ(mesh.positions.size(), 4U);
  EXPECT_NEAR(mesh.positions[1].x, 10, 1e-12);
  EXPECT_NEAR(mesh.positions[1].y, 1, 1e-12);
  EXPECT_NEAR(mesh.positions[2].x, 12, 1e-12);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle3{0, 2, 1}, Triangle3{0, 3, 2}));
  // (0, 1, 1) turns to (-1, 0, 1); by the inverse transpose x is divided by -2.
  EXPECT_NEAR(mesh.attributes[6], 0.5 / std::sqrt(1.25), 1e-6);
  EXPECT_NEAR(mesh.attributes[8], 1 / std::sqrt(1.25), 1e-6);
}

TEST_F(GltfImportTest, AMatrixIsColumnByColumnAndPositionsBecomeDoublesIfNeeded) {
  GltfBuilder gltf;
  const std::size_t number = gltf.mesh(square(gltf));
  gltf.node({{"mesh", number}, {"matrix", {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0.1, 0, 5, 1}}});
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.positions[2], (Vec3d{1.1, 0, 6}));
}

TEST_F(GltfImportTest, AMeshOfSeveralNodesIsThereSeveralTimes) {
  GltfBuilder gltf;
  const std::size_t number = gltf.mesh(square(gltf));
  gltf.node({{"mesh", number}});
  gltf.node({{"mesh", number}, {"translation", {4, 0, 0}}});
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.positions.size(), 8U);
  EXPECT_EQ(mesh.positions[5], (Vec3d{5, 0, 0}));
  EXPECT_EQ(mesh.triangles.size(), 4U);
  EXPECT_EQ(mesh.triangles[2], (Triangle3{4, 5, 6}));
  EXPECT_EQ(mesh.count("repeated_meshes"), 1U);
}

TEST_F(GltfImportTest, TheSceneIsTheOneThatIsNamed) {
  GltfBuilder gltf;
  const std::size_t number = gltf.mesh(square(gltf));
  gltf.node({{"mesh", number}});
  gltf.node({{"mesh", number}, {"translation", {4, 0, 0}}});
  gltf.json["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {1}}}};
  EXPECT_EQ(import(gltf).positions.size(), 8U);
  gltf.json["scene"] = 1;
  EXPECT_EQ(import(gltf).positions[0], (Vec3d{4, 0, 0}));
}

TEST_F(GltfImportTest, NodesThatAreReachedTwiceAreRefused) {
  GltfBuilder gltf;
  gltf.node({{"mesh", gltf.mesh(square(gltf))}, {"children", {1}}});
  gltf.node({{"children", {0}}});
  gltf.json["scenes"] = {{{"nodes", {0}}}};
  EXPECT_THAT(failure(gltf), HasSubstr("nodes[0] is reached twice"));
  gltf.json["nodes"][1]["children"] = {1};
  EXPECT_THAT(failure(gltf), HasSubstr("nodes[1] is reached twice"));
  gltf.json["nodes"][1] = GltfJson::object();
  gltf.json["scenes"][0]["nodes"] = {0, 0};
  EXPECT_THAT(failure(gltf), HasSubstr("nodes[0] is reached twice"));
}

TEST_F(GltfImportTest, SLOW_ADeepTreeIsNoProblem) {
  GltfBuilder gltf;
  constexpr int kDepth = 20000;
  for (int i = 1; i < kDepth; ++i)
    gltf.node({{"children", {i}}});
  gltf.node({{"mesh", gltf.mesh(square(gltf))}});
  EXPECT_EQ(import(gltf).positions.size(), 4U);
}

/// Whatever the memory: in parts of a few thousand vertices, or all at once.
TEST_F(GltfImportTest, OnlyVerticesThatTrianglesUseAreThere) {
  constexpr std::uint32_t kVertices = 30000;
  std::vector<float> positions;
  for (std::uint32_t i = 0; i < kVertices; ++i)
    positions.insert(positions.end(), {static_cast<float>(i), static_cast<float>(i % 7), 0});
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i + 20 < kVertices; i += 10)
    corners.insert(corners.end(), {kVertices - 1 - i, i + 1, (i * 13) % kVertices});
  GltfBuilder gltf;
  gltf.show({{"attributes", {{"POSITION", gltf.accessor(positions, "VEC3")}}},
             {"indices", gltf.accessor(corners, "SCALAR")}});
  const Imported mesh = import(gltf);
  const Imported tight = import(gltf, {.memory = tests::kTight});
  EXPECT_EQ(mesh.positions, tight.positions);
  EXPECT_EQ(mesh.triangles, tight.triangles);
  const std::set<std::uint32_t> used(corners.begin(), corners.end());
  ASSERT_EQ(mesh.positions.size(), used.size());
  EXPECT_EQ(mesh.count("vertices_left_out"), kVertices - used.size());
  EXPECT_TRUE(std::ranges::is_sorted(mesh.positions, {}, [](Vec3d p) { return p.x; }));
  std::size_t next = 0;
  for (const Triangle3& t : mesh.triangles) {
    while (corners[next] == corners[next + 1] || corners[next + 1] == corners[next + 2] ||
           corners[next + 2] == corners[next])
      next += 3;
    for (const std::uint32_t corner : t)
      ASSERT_EQ(mesh.positions[corner].x, corners[next++]);
  }
}

TEST_F(GltfImportTest, IntegersAreFractionsWhereTheyAreNormalized) {
  GltfBuilder gltf;
  const std::vector<std::int16_t> positions{0, 0, 0, 0, 32767, 0, 0, 0, -32768, 16384, 0, 0};
  GltfJson primitive{
      {"attributes",
       {{"POSITION", gltf.accessor(positions, "VEC4", {{"type", "VEC3"}, {"count", 3}})},
        {"NORMAL", gltf.accessor(std::vector<std::int8_t>{127, 0, 0, 0, -128, 0, 0, 0, -127},
                                 "VEC3", {{"normalized", true}})}}}};
  gltf.json["bufferViews"][0]["byteStride"] = 8;
  gltf.show(primitive);
  Imported mesh = import(gltf);
  EXPECT_THAT(mesh.positions,
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{32767, 0, 0}, Vec3d{-32768, 16384, 0}));
  EXPECT_THAT(mesh.attributes, ElementsAre(1, 0, 0, 0, -1, 0, 0, 0, -1));
  gltf.json["accessors"][0]["normalized"] = true;
  mesh = import(gltf);
  EXPECT_EQ(mesh.positions[1], (Vec3d{1, 0, 0}));
  EXPECT_EQ(mesh.positions[2], (Vec3d{-1, 16384.0F / 32767.0F, 0}));
}

TEST_F(GltfImportTest, SparseAccessorsReplaceElements) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  const std::size_t indices = gltf.view(GltfBuilder::bytes_of(std::vector<std::uint8_t>{1, 3}));
  const std::size_t values = gltf.view(GltfBuilder::bytes_of(std::vector<float>{7, 8, 9, 4, 5, 6}));
  gltf.json["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  gltf.show(primitive);
  EXPECT_THAT(import(gltf).positions,
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{7, 8, 9}, Vec3d{1, 1, 0}, Vec3d{4, 5, 6}));
  gltf.json["accessors"][0].erase("bufferView");
  EXPECT_THAT(import(gltf).positions,
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{7, 8, 9}, Vec3d{0, 0, 0}, Vec3d{4, 5, 6}));
  gltf.bin[gltf.json["bufferViews"][indices]["byteOffset"].get<std::size_t>()] = 3;
  EXPECT_THAT(failure(gltf), HasSubstr("accessors[0].sparse.indices: item 1 is 3"));
}

TEST_F(GltfImportTest, AttributesOfApplicationsAreValues) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  GltfJson& attributes = primitive["attributes"];
  attributes["_QUALITY"] = gltf.accessor(std::vector<float>{.1F, .2F, .3F, .4F}, "SCALAR");
  attributes["_FEATURE_ID_0"] = gltf.accessor(std::vector<float>{5, 5, 6, 6}, "SCALAR");
  attributes["_CLASS"] = gltf.accessor(std::vector<std::uint16_t>{9, 8, 7, 6}, "SCALAR");
  attributes["_FLOW"] = gltf.accessor(std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8}, "VEC2");
  attributes["TEXCOORD_7"] = gltf.accessor(kSquareUv, "VEC2");
  gltf.show(primitive);
  const Imported mesh = import(gltf);
  EXPECT_THAT(mesh.layout.values, ElementsAre(ScalarAttribute{"CLASS", ValueType::u16, true},
                                              ScalarAttribute{"FEATURE_ID_0", ValueType::f32, true},
                                              ScalarAttribute{"FLOW_1", ValueType::f32},
                                              ScalarAttribute{"FLOW_2", ValueType::f32},
                                              ScalarAttribute{"QUALITY", ValueType::f32}));
  EXPECT_THAT(mesh.values(0), ElementsAre(9, 8, 7, 6));
  EXPECT_THAT(mesh.values(2), ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(mesh.values(3), ElementsAre(2, 4, 6, 8));
  EXPECT_THAT(mesh.values(4), ElementsAre(double{.1F}, double{.2F}, double{.3F}, double{.4F}));
}

TEST_F(GltfImportTest, ValuesOfPrimitivesAreOfOneType) {
  GltfBuilder gltf;
  GltfJson one = square(gltf), other = square(gltf);
  one["attributes"]["_A"] =
      gltf.accessor(std::vector<std::uint8_t>{1, 2, 3, 4}, "SCALAR", {{"normalized", true}});
  other["attributes"]["_A"] = gltf.accessor(std::vector<float>{.5F, 0, 0, 0}, "SCALAR");
  one["attributes"]["_B"] = gltf.accessor(std::vector<float>{7, 7, 7, 7}, "SCALAR");
  one["attributes"]["_C"] = gltf.accessor(std::vector<std::uint8_t>{1, 1, 1, 1}, "SCALAR");
  gltf.show(one);
  gltf.show(other);
  const Imported mesh = import(gltf);
  EXPECT_THAT(mesh.layout.values, ElementsAre(ScalarAttribute{"A", ValueType::f32},
                                              ScalarAttribute{"B", ValueType::f32}));
  EXPECT_EQ(mesh.values(0)[3], 4) << "what is stored, not a fraction";
  EXPECT_EQ(mesh.values(0)[4], .5);
  EXPECT_EQ(mesh.values(1)[0], 7);
  EXPECT_TRUE(std::isnan(mesh.values(1)[4]));
  EXPECT_EQ(mesh.count("dropped_values"), 4U);
}

TEST_F(GltfImportTest, ValuesThatAreWrongAreRefused) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["attributes"]["_A"] = gltf.accessor(std::vector<float>{1, 2, 3}, "SCALAR");
  gltf.show(primitive);
  EXPECT_THAT(failure(gltf), HasSubstr("3 elements for _A, POSITION has 4"));
}

TEST_F(GltfImportTest, ColoursKeepTheirTypeIfAllHaveIt) {
  const std::vector<std::uint8_t> bytes{0, 128, 255, 9, 1, 2, 3, 9, 4, 5, 6, 9, 7, 8, 9, 9};
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["attributes"]["COLOR_0"] = gltf.accessor(bytes, "VEC4", {{"normalized", true}});
  gltf.show(primitive);
  Imported mesh = import(gltf);
  EXPECT_EQ(
      mesh.layout,
      (AttributeLayout{.colour = ColourType::u8, .alpha = true, .space = ColourSpace::linear}));
  EXPECT_EQ(mesh.attributes, std::vector<float>(bytes.begin(), bytes.end()));

  GltfJson other = square(gltf);
  other["attributes"]["COLOR_0"] =
      gltf.accessor(std::vector<float>{.1F, .2F, .3F, 0, 0, 0, 1, 1, 1, 2, 0, 0}, "VEC3");
  gltf.show(other);
  gltf.show(square(gltf));
  mesh = import(gltf);
  EXPECT_EQ(
      mesh.layout,
      (AttributeLayout{.colour = ColourType::f32, .alpha = true, .space = ColourSpace::linear}));
  EXPECT_EQ(mesh.attributes[1], 128.0F / 255.0F);
  EXPECT_EQ(mesh.attributes[16], .1F);
  EXPECT_EQ(mesh.attributes[19], 1);  // alpha
  EXPECT_EQ(mesh.attributes[32], 1);  // glTF's value for no colour
  EXPECT_EQ(mesh.count("vertices_made_white"), 0U);
}

TEST_F(GltfImportTest, WhatAPrimitiveDoesNotHaveIsFilledInAndCounted) {
  GltfBuilder gltf;
  GltfJson full = textured_square(gltf, gltf.add("materials", GltfJson::object()));
  full["attributes"]["NORMAL"] = gltf.accessor(std::vector<float>(12, 1), "VEC3");
  gltf.show(full);
  gltf.show(square(gltf));
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.layout, (AttributeLayout{.normals = true, .texcoords = true}));
  EXPECT_EQ(mesh.count("vertices_without_normal"), 4U);
  EXPECT_EQ(mesh.count("vertices_without_texcoord"), 4U);
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST_F(GltfImportTest, PicturesAreFilesRangesOrData) {
  GltfBuilder gltf;
  const std::size_t in_glb = gltf.view("the picture");
  gltf.show(textured_square(gltf, gltf.textured_material({{"uri", "b.png"}})));
  gltf.show(textured_square(
      gltf, gltf.textured_material({{"bufferView", in_glb}, {"mimeType", "image/png"}})));
  gltf.show(
      textured_square(gltf, gltf.textured_material({{"uri", "data:image/png;base64,cGl4ZWxz"}})));
  put("b.png", "x");
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.layout, (AttributeLayout{.texcoords = true, .material = true}));
  ASSERT_EQ(mesh.materials.images.size(), 3U);
  EXPECT_EQ(mesh.materials.images[0].file, fs::path("w/b.png"));
  EXPECT_EQ(mesh.materials.images[0].bytes, 0U);
  const images::ImageSource& range = mesh.materials.images[1];
  EXPECT_EQ(range.file, fs::path("w/a.glb"));
  EXPECT_EQ(files_.content("w/a.glb").substr(range.offset, range.bytes), "the picture");
  const std::vector<std::byte>& data = mesh.materials.images[2].data;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(data.data()), data.size()), "pixels");
  EXPECT_EQ(mesh.material_of(0), 0U);
  EXPECT_EQ(mesh.material_of(2), 1U);
  EXPECT_EQ(mesh.material_of(5), 2U);
  EXPECT_EQ(mesh.texcoord(0, 0), (Vec2f{0, 1}));
  EXPECT_EQ(mesh.count("missing_images"), 0U);
  ASSERT_TRUE(mesh.summary.textures);
  EXPECT_EQ(mesh.summary.textures->images, 3U);
  EXPECT_THAT(mesh.companions(), ElementsAre("w/b.png"));
}

TEST_F(GltfImportTest, AMissingPictureShowsItsMaterialsColour) {
  GltfBuilder gltf;
  const std::size_t missing = gltf.textured_material({{"uri", "none.png"}});
  gltf.json["materials"][missing]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0, 1, 0.25};
  gltf.show(textured_square(gltf, missing));
  Imported mesh = import(gltf);
  EXPECT_EQ(mesh.layout, (AttributeLayout{.colour = ColourType::u8, .texcoords = true}));
  EXPECT_EQ(mesh.attributes[0], 188);  // sRGB of 0.5
  ASSERT_EQ(mesh.warnings.size(), 1U);
  EXPECT_THAT(mesh.warnings[0], HasSubstr("none.png"));
  EXPECT_THAT(mesh.companions(), ElementsAre("no w/none.png"));

  gltf.show(textured_square(gltf, gltf.textured_material({{"uri", "b.png"}})));
  gltf.show(square(gltf));  // with the default material
  put("b.png", "x");
  mesh = import(gltf);
  ASSERT_EQ(mesh.materials.materials.size(), 3U);
  EXPECT_EQ(mesh.materials.materials[mesh.material_of(5)], images::Material{});
  const images::Material& colour = mesh.materials.materials[mesh.material_of(0)];
  EXPECT_FALSE(colour.image);
  EXPECT_EQ(colour.colour[0], 188 / 255.0F);  // sRGB of 0.5
  EXPECT_EQ(colour.colour[3], 0.25F);
  EXPECT_EQ(mesh.count("missing_images"), 1U);
  const Imported ignored = import(gltf, {.textures = Textures::ignore});
  EXPECT_EQ(ignored.layout, AttributeLayout{.texcoords = true});
  EXPECT_THAT(ignored.warnings, IsEmpty());
  EXPECT_THAT(ignored.companions(), IsEmpty());
}

TEST_F(GltfImportTest, PicturesAreFoundAsThoseOfAnObj) {
  files_.put("textures/a.png", "x");
  put("tex/Brick Red.png", "x");
  put("50%.png", "x");
  put("b.png", "x");
  const std::vector<std::pair<const char*, const char*>> found{
      {"../textures/a.png", "w/../textures/a.png"},
      {"..\\textures\\a.png", "w/../textures/a.png"},
      {"tex\\Brick%20Red.png", "w/tex/Brick Red.png"},
      {"TEX/brick red.PNG", "w/tex/Brick Red.png"},
      {"50%25.png", "w/50%.png"},
      {"50%.png", "w/50%.png"},
      {"C:\\Users\\me\\b.png", "w/b.png"},
      {"file:///home/me/b.png", "w/b.png"},
      {"/home/me/B.PNG", "w/b.png"},
      {"none/at/all/b.png", "w/b.png"}};
  for (const auto& [uri, path] : found) {
    GltfBuilder gltf;
    gltf.show(textured_square(gltf, gltf.textured_material({{"uri", uri}})));
    const Imported mesh = import(gltf);
    ASSERT_EQ(mesh.materials.images.size(), 1U) << uri;
    EXPECT_EQ(mesh.materials.images[0].file, fs::path(path)) << uri;
  }
  for (const char* uri : {"../c.png", "b%2.pn", "", "..", "%00b.png"}) {
    GltfBuilder gltf;
    gltf.show(textured_square(gltf, gltf.textured_material({{"uri", uri}})));
    const Imported mesh = import(gltf);
    EXPECT_EQ(mesh.count("missing_images"), 1U) << uri;
    EXPECT_EQ(mesh.warnings.size(), 1U) << uri;
  }
}

/// A material whose one picture is of what it emits.
GltfJson emissive_material(GltfBuilder& gltf, const GltfJson& base, const GltfJson& light) {
  const std::size_t number = gltf.textured_material({{"uri", "b.png"}});
  GltfJson& material = gltf.json["materials"][number];
  material["emissiveTexture"] = material["pbrMetallicRoughness"]["baseColorTexture"];
  material["emissiveFactor"] = light;
  material["pbrMetallicRoughness"] = {{"baseColorFactor", base}};
  return number;
}

TEST_F(GltfImportTest, WhatIsEmittedIsAddedToTheBaseColour) {
  put("b.png", "x");
  for (const bool is_black : {true, false}) {
    GltfBuilder gltf;
    const GltfJson base = is_black ? GltfJson{0, 0, 0, 1} : GltfJson{0.25, 0.5, 0, 1};
    gltf.show(textured_square(gltf, emissive_material(gltf, base, {1, 1, 0.5})));
    const Imported mesh = import(gltf);
    ASSERT_EQ(mesh.materials.materials.size(), 1U);
    const images::Material& shown = mesh.materials.materials[0];
    EXPECT_TRUE(shown.image);
    EXPECT_EQ(shown.factor, (std::array<float, 4>{1, 1, 0.5F, 1}));
    EXPECT_EQ(shown.light,
              is_black ? (std::array<float, 3>{}) : (std::array<float, 3>{0.25F, 0.5F, 0}));
    EXPECT_EQ(mesh.count("ignored_emission"), 0U);
  }
}

TEST_F(GltfImportTest, APictureOfLightWithoutAFactorShowsNothing) {
  put("b.png", "x");
  GltfBuilder gltf;
  const std::size_t number = emissive_material(gltf, {1, 0, 0, 1}, {0, 0, 0});
  gltf.show(textured_square(gltf, number));
  gltf.json["materials"][number].erase("emissiveFactor");  // the same
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.layout, (AttributeLayout{.colour = ColourType::u8, .texcoords = true}));
  EXPECT_EQ(mesh.attributes[0], 255);
  EXPECT_EQ(mesh.attributes[1], 0);
  EXPECT_THAT(mesh.companions(), IsEmpty());
}

TEST_F(GltfImportTest, LightWithoutPicturesIsPartOfTheColour) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["material"] =
      gltf.add("materials",
               {{"emissiveFactor", {0.25, 0, 0.1}},
                {"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0, 0, 1}}}},
                {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
  gltf.show(primitive);
  Imported mesh = import(gltf);
  EXPECT_EQ(mesh.attributes[0], 255) << "0.25 + 5";
  EXPECT_EQ(mesh.attributes[1], 0);
  EXPECT_EQ(mesh.attributes[2], 255);
  gltf.json["materials"][0]["extensions"].erase("KHR_materials_emissive_strength");
  mesh = import(gltf);
  EXPECT_EQ(mesh.attributes[0], 188) << "0.5, as a screen has it";
  EXPECT_EQ(mesh.attributes[2], 89);
  gltf.json["materials"][0]["extensions"]["KHR_materials_unlit"] = GltfJson::object();
  EXPECT_EQ(import(gltf).attributes[0], 137) << "nothing emits where nothing is lit";
}

TEST_F(GltfImportTest, ColoursOfVerticesAreNoPartOfTheLight) {
  put("b.png", "x");
  const std::vector<float> half(12, 0.5F);
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["attributes"]["COLOR_0"] = gltf.accessor(half, "VEC3");
  primitive["material"] = gltf.add("materials", {{"emissiveFactor", {0.125, 0, 1}}});
  gltf.show(primitive);
  Imported mesh = import(gltf);
  EXPECT_THAT(std::vector<float>(mesh.attributes.begin(), mesh.attributes.begin() + 3),
              ElementsAre(0.625F, 0.5F, 1));
  EXPECT_EQ(mesh.count("ignored_emission"), 0U);

  // In one mesh with pictures, which colours multiply as a whole.
  GltfJson lamp = textured_square(gltf, emissive_material(gltf, {0, 0, 0, 1}, {1, 1, 1}));
  GltfJson lit = textured_square(gltf, emissive_material(gltf, {1, 1, 0, 1}, {1, 1, 1}));
  lamp["attributes"]["COLOR_0"] = lit["attributes"]["COLOR_0"] = gltf.accessor(half, "VEC3");
  gltf.show(lamp);
  gltf.show(lit);
  mesh = import(gltf);
  EXPECT_EQ(mesh.count("ignored_emission"), 2U) << "that of the first and of the last";
  const auto& materials = mesh.materials.materials;
  EXPECT_EQ(materials[mesh.material_of(0)].colour, (std::array<float, 4>{1, 1, 1, 1}));
  EXPECT_TRUE(materials[mesh.material_of(2)].image);
  EXPECT_FALSE(materials[mesh.material_of(4)].image);
  EXPECT_EQ(materials[mesh.material_of(4)].colour, (std::array<float, 4>{1, 1, 0, 1}));
  const std::size_t channels = mesh.attributes.size() / mesh.positions.size();
  EXPECT_EQ(mesh.attributes[0], 0.5F);
  EXPECT_EQ(mesh.attributes[4 * channels], 1) << "black times it is black";
  EXPECT_EQ(mesh.attributes[8 * channels], 0.5F);
}

TEST_F(GltfImportTest, BesideABaseColoursPictureTheEmissiveOneIsCounted) {
  put("b.png", "x");
  put("c.png", "x");
  GltfBuilder gltf;
  const std::size_t number = gltf.textured_material({{"uri", "b.png"}});
  gltf.json["materials"][number]["emissiveTexture"] = {
      {"index", gltf.add("textures", {{"source", gltf.add("images", {{"uri", "c.png"}})}})}};
  gltf.show(textured_square(gltf, number));
  EXPECT_EQ(import(gltf).count("ignored_emission"), 0U) << "its factor is 0";
  gltf.json["materials"][number]["emissiveFactor"] = {0, 0, 1};
  const Imported mesh = import(gltf);
  EXPECT_EQ(mesh.count("ignored_emission"), 1U);
  EXPECT_THAT(mesh.companions(), ElementsAre("w/b.png"));
  gltf.json["materials"][number].erase("emissiveTexture");
  EXPECT_EQ(import(gltf).materials.materials[0].light, (std::array<float, 3>{0, 0, 1}));
}

TEST_F(GltfImportTest, APictureOfAFormatThatIsNotReadIsTold) {
  GltfBuilder gltf;
  const std::size_t number = gltf.textured_material({{"uri", "b.avif"}});
  gltf.json["textures"][0].erase("source");
  gltf.json["textures"][0]["extensions"]["EXT_texture_avif"]["source"] = 0;
  gltf.show(textured_square(gltf, number));
  const Imported mesh = import(gltf);
  ASSERT_EQ(mesh.warnings.size(), 1U);
  EXPECT_THAT(mesh.warnings[0], HasSubstr("AVIF, which cannot be read"));

  gltf.json["textures"][0]["extensions"]["MSFT_texture_dds"]["source"] = 0;
  EXPECT_THAT(import(gltf).warnings[0], HasSubstr("DDS, which cannot be read"));
  gltf.json["textures"][0]["extensions"].erase("MSFT_texture_dds");

  gltf.json["extensionsRequired"] = {"EXT_texture_avif"};
  EXPECT_THAT(failure(gltf), HasSubstr("leave them out with \"texture\": {\"use\": false}"));
  EXPECT_EQ(import(gltf, {.textures = Textures::ignore}).positions.size(), 4U);
  gltf.json["textures"][0]["source"] = 0;  // another picture is there
  EXPECT_EQ(failure(gltf), "");
  gltf.json["textures"][0].erase("source");
  gltf.json["meshes"][0]["primitives"][0].erase("material");  // nobody shows it
  EXPECT_EQ(failure(gltf), "");
}

/// A file of a picture of that many texels a side.
std::string picture_file(ImageFormat format, std::uint32_t side, int quality = 100) {
  images::Image image(side, side, 3);
  std::ranges::fill(image.texels, std::uint8_t{128});
  const auto bytes = images::encode_image(image, format, quality);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class PictureFormsTest : public GltfImportTest {
 protected:
  PictureFormsTest() {
    const std::size_t number = gltf_.textured_material({{"uri", "b.png"}});
    gltf_.add("images", {{"uri", "b.ktx2"}});
    gltf_.json["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 1;
    gltf_.json["extensionsRequired"] = {"KHR_texture_basisu"};
    gltf_.show(textured_square(gltf_, number));
  }
  fs::path shown() {
    const Imported mesh = import(gltf_);
    return mesh.materials.images.empty() ? "" : mesh.materials.images[0].file.filename();
  }

  GltfBuilder gltf_;
};

TEST_F(PictureFormsTest, AFileOfKtx2AloneIsRead) {
  gltf_.json["textures"][0].erase("source");
  put("b.ktx2", picture_file(ImageFormat::ktx2, 8));
  EXPECT_EQ(shown(), "b.ktx2");
}

TEST_F(PictureFormsTest, TheOneWithMoreTexelsIsTaken) {
  put("b.png", picture_file(ImageFormat::png, 8));
  put("b.ktx2", picture_file(ImageFormat::ktx2, 16));
  EXPECT_EQ(shown(), "b.ktx2");
  put("b.png", picture_file(ImageFormat::png, 16));
  EXPECT_EQ(shown(), "b.png") << "of equal ones that which loses less";
}

TEST_F(PictureFormsTest, WhatIsMissingOrBrokenYieldsToTheOther) {
  put("b.ktx2", picture_file(ImageFormat::ktx2, 8));
  EXPECT_EQ(shown(), "b.ktx2") << "b.png is not there";
  put("b.png", "x");
  EXPECT_EQ(shown(), "b.ktx2");
  put("b.png", picture_file(ImageFormat::png, 4));
  put("b.ktx2", picture_file(ImageFormat::ktx2, 8).substr(0, 60));
  EXPECT_EQ(shown(), "b.png");
}

TEST_F(PictureFormsTest, WithoutTheProgramForItsBlocksTheFileIsRefused) {
  if (!images::missing_for_ktx2().empty())
    GTEST_SKIP() << images::missing_for_ktx2();
  put("b.png", picture_file(ImageFormat::png, 4));
  put("b.ktx2", picture_file(ImageFormat::ktx2, 8, 50));
  EXPECT_EQ(shown(), "b.ktx2");
  ASSERT_EQ(::setenv("MESHHIER_KTX2", "/nowhere", 1), 0);
  EXPECT_THAT(failure(gltf_, ErrorCode::io),
              HasSubstr("b.ktx2: pictures in KTX2 as ETC1S are coded by Node.js"));
  put("broken.glb", "glTF");
  mesh_io::InputPaths inputs("w/broken.glb");
  inputs.emplace_back("w/a.glb");
  try {
    tests::import_files(files_, inputs);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io) << "before any mesh is read: " << error.what();
  }
  put("b.ktx2", picture_file(ImageFormat::ktx2, 8));
  EXPECT_EQ(shown(), "b.ktx2") << "UASTC needs none";
  ASSERT_EQ(::unsetenv("MESHHIER_KTX2"), 0);
}

TEST_F(GltfImportTest, MaterialsHaveWrapsAlphaAndOtherCoordinates) {
  GltfBuilder gltf;
  put("b.webp", "x");
  put("b.png", "x");
  const std::size_t number = gltf.textured_material({{"uri", "b.png"}}, {{"texCoord", 1}});
  gltf.add("images", {{"uri", "b.webp"}});
  gltf.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  gltf.json["textures"][0]["sampler"] = 0;
  gltf.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}});
  GltfJson& material = gltf.json["materials"][number];
  material["alphaMode"] = "MASK";
  material["alphaCutoff"] = 0.25;
  material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0.5, 1, 1};
  GltfJson primitive = textured_square(gltf, number);
  primitive["attributes"]["TEXCOORD_1"] = gltf.accessor(
      std::vector<std::uint8_t>{255, 0, 0, 51, 0, 0, 0, 0}, "VEC2", {{"normalized", true}});
  gltf.show(primitive);
  const Imported mesh = import(gltf);
  ASSERT_EQ(mesh.materials.materials.size(), 1U);
  const images::Material& found = mesh.materials.materials[0];
  EXPECT_EQ(found.wrap_u, Wrap::clamp);
  EXPECT_EQ(found.wrap_v, Wrap::mirrored);
  EXPECT_EQ(found.alpha, AlphaMode::mask);
  EXPECT_EQ(found.alpha_cutoff, 0.25F);
  EXPECT_EQ(mesh.materials.images[0].file, fs::path("w/b.webp"));
  EXPECT_EQ(found.factor, (std::array<float, 4>{1, 0.5F, 1, 1}));
  EXPECT_EQ(mesh.texcoord(0, 0), (Vec2f{1, 0}));
  EXPECT_EQ(mesh.texcoord(0, 1), (Vec2f{0, 0.2F}));
}

TEST_F(GltfImportTest, TextureTransformsAreAppliedToCoordinates) {
  GltfBuilder gltf;
  put("b.png", "x");
  const GltfJson transform{{"offset", {10, 20}}, {"rotation", std::acos(0.0)}, {"scale", {2, 4}}};
  gltf.show(textured_square(
      gltf, gltf.textured_material({{"uri", "b.png"}},
                                   {{"extensions", {{"KHR_texture_transform", transform}}}})));
  const Imported mesh = import(gltf);
  // (1, 1) is scaled to (2, 4), turned to (4, -2), moved.
  EXPECT_NEAR(mesh.texcoord(0, 1).u, 14, 1e-6);
  EXPECT_NEAR(mesh.texcoord(0, 1).v, 18, 1e-6);
}

TEST_F(GltfImportTest, GlossyMaterialsHaveADiffusePicture) {
  GltfBuilder gltf;
  put("b.png", "x");
  const std::size_t number = gltf.textured_material({{"uri", "b.png"}});
  gltf.json["materials"][number] = {
      {"extensions",
       {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseTexture", {{"index", 0}}}}}}}};
  gltf.show(textured_square(gltf, number));
  EXPECT_TRUE(import(gltf).layout.material);
  GltfJson& material = gltf.json["materials"][number];
  for (const char* empty : {"{}", R"({"metallicFactor": 0})", R"({"roughnessFactor": 0.5})"}) {
    material["pbrMetallicRoughness"] = GltfJson::parse(empty);
    EXPECT_TRUE(import(gltf).layout.material) << empty;
  }
  material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {{"diffuseFactor", {1, 0, 0, 1}}};
  Imported mesh = import(gltf);
  EXPECT_EQ(mesh.attributes[0], 255);
  EXPECT_EQ(mesh.attributes[1], 0);
  material["pbrMetallicRoughness"] = {{"baseColorFactor", {0, 1, 0, 1}}};
  mesh = import(gltf);
  EXPECT_EQ(mesh.attributes[0], 0);
  EXPECT_EQ(mesh.attributes[1], 255);
}

TEST_F(GltfImportTest, ColoursTimesFactorsAreProductsOfLight) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["attributes"]["COLOR_0"] =
      gltf.accessor(std::vector<std::uint8_t>{255, 128, 0, 255, 255, 128, 0, 255,  //
                                              255, 128, 0, 255, 255, 128, 0, 51},
                    "VEC4", {{"normalized", true}});
  primitive["material"] =
      gltf.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 0.5}}}}});
  gltf.show(primitive);
  Imported mesh = import(gltf);
  EXPECT_EQ(
      mesh.layout,
      (AttributeLayout{.colour = ColourType::u16, .alpha = true, .space = ColourSpace::linear}));
  EXPECT_THAT(std::vector<float>(mesh.attributes.begin() + 12, mesh.attributes.end()),
              ElementsAre(32768, 8224, 0, 6554));
  // One grey is a factor as any other.
  gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.25, 0.25, 0.25, 1};
  EXPECT_EQ(import(gltf).attributes[0], 16384);
  gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 1};
  EXPECT_EQ(import(gltf).layout.colour, ColourType::u8);
  // A part without colours of its own shows the factor, in light.
  gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0.5, 2, 1};
  GltfJson other = square(gltf);
  other["material"] = 0;
  gltf.show(other);
  gltf.show(square(gltf));
  mesh = import(gltf);
  EXPECT_THAT(std::vector<float>(mesh.attributes.begin() + 16, mesh.attributes.begin() + 20),
              ElementsAre(0, 32768, 65535, 65535));
  EXPECT_EQ(mesh.attributes.back(), 65535);
}

TEST_F(GltfImportTest, InvisibleNodesAndThoseBelowAreLeftOut) {
  GltfBuilder gltf;
  const std::size_t number = gltf.mesh(square(gltf));
  const auto visible = [](bool is_visible) {
    return GltfJson{{"KHR_node_visibility", {{"visible", is_visible}}}};
  };
  gltf.node({{"mesh", number}, {"extensions", visible(true)}});
  gltf.node({{"mesh", number}, {"extensions", visible(false)}, {"children", {2}}});
  gltf.node({{"mesh", number}, {"extensions", visible(true)}});  // below an invisible one
  gltf.node({{"children", {4}}, {"extensions", {{"KHR_node_visibility", GltfJson::object()}}}});
  gltf.node({{"mesh", number}, {"translation", {5, 0, 0}}});
  gltf.json["extensionsRequired"] = {"KHR_node_visibility"};
  Imported mesh = import(gltf);
  EXPECT_EQ(mesh.positions.size(), 8U);
  EXPECT_EQ(mesh.positions[4], (Vec3d{5, 0, 0}));
  EXPECT_EQ(mesh.count("hidden_meshes"), 2U);
  gltf.json["nodes"][4]["extensions"] = {{"KHR_node_visibility", {{"visible", 0}}}};
  EXPECT_THAT(failure(gltf), HasSubstr("visible"));
}

/// A square that hangs on joints, below an armature of a hundredth.
struct Skinned {
  GltfBuilder gltf;
  std::size_t joints = 0, weights = 0;

  explicit Skinned(const std::vector<float>& weights_of,
                   const std::vector<std::uint8_t>& joints_of = std::vector<std::uint8_t>(16)) {
    GltfJson primitive = square(gltf);
    joints = gltf.accessor(joints_of, "VEC4");
    weights = gltf.accessor(weights_of, "VEC4");
    primitive["attributes"]["JOINTS_0"] = joints;
    primitive["attributes"]["WEIGHTS_0"] = weights;
    primitive["attributes"]["NORMAL"] =
        gltf.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1}, "VEC3");
    gltf.node({{"scale", {0.01, 0.01, 0.01}}, {"children", {1, 2, 3}}});
    gltf.node({{"translation", {0, 0, 100}}});
    gltf.node({{"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}});
    gltf.node({{"mesh", gltf.mesh(primitive)}, {"skin", 0}, {"translation", {5, 5, 5}}});
    gltf.json["scenes"] = {{{"nodes", {0}}}};
    // The inverse of the armature's scale.
    const std::vector<float> hundred{100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 1};
    std::vector<float> binds = hundred;
    binds.insert(binds.end(), hundred.begin(), hundred.end());
    gltf.json["skins"] = {
        {{"joints", {1, 2}},
         {"inverseBindMatrices", gltf.accessor(binds, "VEC4", {{"type", "MAT4"}, {"count", 2}})}}};
  }
};

const std::vector<float> kAllOnTheFirst{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

TEST_F(GltfImportTest, JointsPlaceASkinnedMeshAndItsNodeDoesNot) {
  const Imported mesh = import(Skinned(kAllOnTheFirst).gltf);
  ASSERT_EQ(mesh.positions.size(), 4U);
  EXPECT_LT(length(mesh.positions[2] - Vec3d{1, 1, 1}), 1e-6);
  EXPECT_EQ(mesh.count("skinned_meshes"), 1U);
  EXPECT_EQ(mesh.count("ignored_skins"), 0U);
  EXPECT_NEAR(mesh.attributes[7], 1, 1e-6) << "normals are turned alike";
}

TEST_F(GltfImportTest, AVertexIsAMeanOfItsJointsByWeights) {
  const std::vector<std::uint8_t> joints{0, 1, 99, 99, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  // Their sum need not be 1; what is not above 0 does not count.
  const float nan = std::nanf("");
  const std::vector<float> weights{0, 0, 0, 0, .5F, .5F, 0, 0, 3, 0, -1, nan, 1, 0, 0, 0};
  const Imported mesh = import(Skinned(weights, joints).gltf);
  EXPECT_LT(length(mesh.positions[0] - Vec3d{0, 0, 1}), 1e-6) << "the first, as none has a weight";
  EXPECT_LT(length(mesh.positions[1] - Vec3d{0.5, 0.5, 0.5}), 1e-6);
  EXPECT_LT(length(mesh.positions[2] - Vec3d{-1, 1, 0}), 1e-6) << "a quarter turn";
  EXPECT_NEAR(mesh.attributes[6], -1, 1e-6) << "so is its normal";
  EXPECT_LT(length(mesh.positions[3] - Vec3d{0, 1, 1}), 1e-6);
}

TEST_F(GltfImportTest, SkinsMayLackMatricesAndTheirJointsTheScene) {
  Skinned bare(kAllOnTheFirst);
  bare.gltf.json["skins"][0].erase("inverseBindMatrices");
  EXPECT_LT(length(import(bare.gltf).positions[2] - Vec3d{0.01, 0.01, 1}), 1e-8);
  Skinned apart(kAllOnTheFirst);
  apart.gltf.json["scenes"][0]["nodes"] = {3};  // not the armature
  EXPECT_LT(length(import(apart.gltf).positions[2] - Vec3d{1, 1, 1}), 1e-6);
  apart.gltf.json["nodes"][1]["children"] = {0};
  EXPECT_THAT(failure(apart.gltf), HasSubstr("is below itself: nodes must be a tree"));
  Skinned mirrored(kAllOnTheFirst);
  mirrored.gltf.json["nodes"][0]["scale"] = {-0.01, 0.01, 0.01};
  EXPECT_THAT(import(mirrored.gltf).triangles[0], Triangle3({0, 2, 1}));
}

TEST_F(GltfImportTest, SkinsThatAreWrongAreRefusedAndThoseWithoutWeightsCounted) {
  std::vector<std::uint8_t> joints(16);
  joints[8] = 2;
  EXPECT_THAT(failure(Skinned(kAllOnTheFirst, joints).gltf),
              HasSubstr("element 2 has the joint 2, but the skin has 2"));
  Skinned few(kAllOnTheFirst);
  few.gltf.json["skins"][0]["joints"] = {1, 2, 0};
  EXPECT_THAT(failure(few.gltf), HasSubstr("has 2 elements of 16 numbers for the matrices of 3"));
  few.gltf.json["skins"][0]["joints"] = GltfJson::array();
  EXPECT_THAT(failure(few.gltf), HasSubstr("skins[0] has no joints"));
  Skinned longer(kAllOnTheFirst);
  longer.gltf.json["accessors"][longer.weights]["count"] = 3;
  EXPECT_THAT(failure(longer.gltf), HasSubstr("has 3 elements for WEIGHTS_0, POSITION has 4"));
  Skinned scalar(kAllOnTheFirst);
  scalar.gltf.json["accessors"][scalar.joints]["type"] = "VEC2";
  EXPECT_THAT(failure(scalar.gltf), HasSubstr("is of no type that JOINTS_0 may have"));
  Skinned stiff(kAllOnTheFirst);
  stiff.gltf.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  const Imported mesh = import(stiff.gltf);
  EXPECT_EQ(mesh.count("ignored_skins"), 1U);
  EXPECT_LT(length(mesh.positions[0] - Vec3d{0.05, 0.05, 0.05}), 1e-8) << "its node's place";
}

TEST_F(GltfImportTest, WhatLetsAllLightThroughIsLeftOut) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  GltfJson helper = square(gltf);
  helper["material"] = gltf.add(
      "materials",
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 1, 0}}}}});
  gltf.show(helper);
  Imported mesh = import(gltf);
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.count("invisible_parts"), 1U);
  GltfJson& material = gltf.json["materials"][0];
  material["alphaMode"] = "OPAQUE";  // then alpha is nothing
  EXPECT_EQ(import(gltf).triangles.size(), 4U);
  material["alphaMode"] = "MASK";
  EXPECT_EQ(import(gltf).triangles.size(), 2U);
  material["alphaCutoff"] = 0;
  EXPECT_EQ(import(gltf).triangles.size(), 4U);
  material["alphaMode"] = "BLEND";
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.2;
  mesh = import(gltf);
  EXPECT_EQ(mesh.triangles.size(), 4U);
  EXPECT_EQ(mesh.count("materials_made_opaque"), 1U);

  GltfBuilder nothing;
  GltfJson only = square(nothing);
  only["material"] = nothing.add(
      "materials",
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0}}}}});
  nothing.show(only);
  EXPECT_THAT(failure(nothing), HasSubstr("a.glb holds nothing that is to be seen"));
}

TEST_F(GltfImportTest, PointsAndLinesAloneAreNoMesh) {
  for (const int mode : {0, 1, 3}) {
    GltfBuilder gltf;
    GltfJson primitive = square(gltf);
    primitive["mode"] = mode;
    gltf.show(primitive);
    EXPECT_THAT(failure(gltf), HasSubstr("a.glb holds points or lines alone, no triangles"));
  }
}

TEST_F(GltfImportTest, ShadersHaveTheBaseColourThatTheirNamesTell) {
  put("b.png", "x");
  const auto shown = [&](const char* values, const char* uniforms = "{}") {
    GltfBuilder gltf;
    const std::size_t number = gltf.textured_material({{"uri", "b.png"}});
    gltf.json["materials"][number] = {
        {"extensions",
         {{"KHR_techniques_webgl", {{"technique", 0}, {"values", GltfJson::parse(values)}}}}}};
    gltf.json["extensions"]["KHR_techniques_webgl"]["techniques"] = {
        {{"uniforms", GltfJson::parse(uniforms)}}};
    gltf.json["extensionsRequired"] = {"KHR_techniques_webgl"};
    gltf.show(textured_square(gltf, number));
    return import(gltf);
  };
  for (const char* values :
       {R"({"u_diffuse": {"index": 0, "texCoord": 0}})", R"({"u_tex": {"index": 0}})",
        R"({"u_normal": {"index": 0}, "u_Diffuse0": {"index": 0}, "u_other": {"index": 0}})"})
    EXPECT_TRUE(shown(values).layout.material) << values;
  EXPECT_TRUE(
      shown("{}", R"({"u_diffuse": {"type": 35678, "value": {"index": 0}}})").layout.material);
  Imported mesh = shown(R"({"u_a": {"index": 0}, "u_b": {"index": 0}})");
  EXPECT_FALSE(mesh.layout.material);
  EXPECT_EQ(mesh.count("ignored_techniques"), 1U);
  EXPECT_EQ(shown(R"({"u_normal": {"index": 0}})").count("ignored_techniques"), 0U);
  mesh = shown(R"({"u_diffuse": [0.2, 0.4, 1, 1], "u_shininess": 5})");
  EXPECT_EQ(mesh.attributes[0], 51) << "values of a screen";
  EXPECT_EQ(mesh.attributes[1], 102);
  EXPECT_EQ(shown(R"({"u_diffuse": "x", "u_tex": 7})").layout.colour, ColourType::none);
}

TEST_F(GltfImportTest, ScenesThatShowMeshesAnyNumberOfTimesAreRefused) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["indices"] = gltf.accessor(std::vector<std::uint8_t>(300000), "SCALAR");
  const std::size_t places = gltf.accessor(std::vector<std::uint8_t>(300000), "VEC3");
  gltf.node(
      {{"mesh", gltf.mesh(primitive)},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  EXPECT_THAT(failure(gltf), HasSubstr("shows 10000000000 triangles"));
}

TEST_F(GltfImportTest, TheCentreOfCesiumIsAddedBehindItsTurn) {
  GltfBuilder gltf;
  const std::size_t number = gltf.mesh(square(gltf));
  gltf.node({{"mesh", number}, {"translation", {0, 0, 1}}});
  gltf.json["extensions"]["CESIUM_RTC"]["center"] = {4000000.0, 500000.0, 4900000.25};
  for (const bool is_required : {false, true}) {
    if (is_required)
      gltf.json["extensionsRequired"] = {"CESIUM_RTC"};
    const Imported mesh = import(gltf);
    // Turned to z up, (x, y, z) is (x, -z, y).
    EXPECT_EQ(mesh.positions[0], (Vec3d{4000000, 4900000.25, -499999}));
  }
  for (const GltfJson& bad : {GltfJson("x"), GltfJson{1, 2}, GltfJson{1, 2, "3"}}) {
    gltf.json["extensions"]["CESIUM_RTC"]["center"] = bad;
    EXPECT_THAT(failure(gltf), HasSubstr("center"));
  }
}

TEST_F(GltfImportTest, InstancesAreCopiesPlacedWithinTheirNode) {
  GltfBuilder gltf;
  const std::size_t number = gltf.mesh(square(gltf));
  const auto instanced = [](const GltfJson& attributes) {
    return GltfJson{{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}};
  };
  const std::size_t moved = gltf.accessor(std::vector<float>{10, 0, 0, 20, 0, 0, 30, 0, 0}, "VEC3");
  const std::size_t turned =
      gltf.accessor(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0, 0, 0, 0, 32767},
                    "VEC4", {{"normalized", true}});
  const std::size_t sized = gltf.accessor(std::vector<float>{1, 1, 1, 1, 1, 1, -2, 1, 1}, "VEC3");
  gltf.node(
      {{"mesh", number},
       {"translation", {0, 0, 7}},
       {"extensions",
        instanced({{"TRANSLATION", moved}, {"ROTATION", turned}, {"SCALE", sized}, {"_ID", 0}})}});
  gltf.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  Imported mesh = import(gltf);
  ASSERT_EQ(mesh.positions.size(), 12U);
  EXPECT_EQ(mesh.positions[1], (Vec3d{11, 0, 7}));
  EXPECT_EQ(mesh.positions[5], (Vec3d{19, 0, 7}));  // half a turn around z
  EXPECT_EQ(mesh.positions[9], (Vec3d{28, 0, 7}));
  EXPECT_EQ(mesh.triangles[0], (Triangle3{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[4], (Triangle3{8, 10, 9}));  // mirrored
  EXPECT_EQ(mesh.count("instanced_meshes"), 3U);

  const auto with = [&](const GltfJson& attributes) {
    gltf.json["nodes"][0]["extensions"] = instanced(attributes);
  };
  with({{"SCALE", sized}});
  EXPECT_EQ(import(gltf).positions[9], (Vec3d{-2, 0, 7}));
  with(GltfJson::object());
  EXPECT_EQ(import(gltf).positions.size(), 4U);
  with({{"TRANSLATION", moved}, {"SCALE", gltf.accessor(std::vector<float>{1, 1, 1}, "VEC3")}});
  EXPECT_THAT(failure(gltf), HasSubstr("places 1 copies of a mesh, others place 3"));
  with({{"ROTATION", moved}});
  EXPECT_THAT(failure(gltf), HasSubstr("has 3 components, but places copies"));
  with({{"ROTATION", gltf.accessor(std::vector<float>{0, 0, 0, 0}, "VEC4")}});
  EXPECT_THAT(failure(gltf), HasSubstr("element 0 is a rotation of zeros"));
  with({{"TRANSLATION", 99}});
  EXPECT_THAT(failure(gltf), HasSubstr("TRANSLATION"));
}

TEST_F(GltfImportTest, PackedFilesAreUnpackedAndTheirPicturesFoundWithin) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  put("a.glb.gz", tests::gzip(gltf.glb()));
  EXPECT_EQ(import("a.glb.gz").positions.size(), 4U);
  put("a.bin", gltf.bin);
  put("a.gltf.gz", tests::gzip(gltf.text("a.bin")));
  EXPECT_EQ(import("a.gltf.gz").summary.files.size(), 2U);
  gltf.show(textured_square(gltf, gltf.textured_material({{"bufferView", gltf.view("picture")}})));
  put("b.glb.gz", tests::gzip(gltf.glb()));
  const Imported mesh = import("b.glb.gz");
  ASSERT_EQ(mesh.materials.images.size(), 1U);
  const images::ImageSource& image = mesh.materials.images[0];
  EXPECT_EQ(image.file, fs::path("w/b.glb.gz"));
  EXPECT_TRUE(image.is_packed);
  EXPECT_EQ(gltf.glb().substr(image.offset, image.bytes), "picture");
}

TEST_F(GltfImportTest, FilesOfSeveralFormatsAreJoined) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  put("a.glb", gltf.glb());
  put("b.obj", "v 5 0 0\nv 6 0 0\nv 6 1 0\nf 1 2 3\n");
  mesh_io::InputPaths paths;
  paths.push_back("w/b.obj");
  paths.push_back("w/a.glb");
  const Imported mesh = tests::import_files(files_, paths);
  EXPECT_EQ(mesh.positions.size(), 7U);
  EXPECT_EQ(mesh.triangles[1], (Triangle3{3, 4, 5}));
}

TEST_F(GltfImportTest, NumbersThatAreNoneNameTheirAccessor) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), 3e38F}) {
    GltfBuilder gltf;
    std::vector<float> positions = kSquare;
    positions[7] = bad;
    gltf.show({{"attributes", {{"POSITION", gltf.accessor(positions, "VEC3")}}},
               {"indices", gltf.accessor(kSquareCorners, "SCALAR")}});
    EXPECT_THAT(failure(gltf), HasSubstr("accessors[0]: element 2 has"));
  }
}

TEST_F(GltfImportTest, NormalsAndTextureCoordinatesThatAreNoNumbersAreZero) {
  for (const bool is_turned : {false, true}) {
    GltfBuilder gltf;
    GltfJson primitive = square(gltf);
    std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    normals[4] = std::nanf("");
    primitive["attributes"]["NORMAL"] = gltf.accessor(normals, "VEC3");
    primitive["attributes"]["TEXCOORD_0"] = gltf.accessor(
        std::vector<float>{0, 0, 1, std::numeric_limits<float>::infinity(), 1, 1, 0, 1}, "VEC2");
    gltf.show(primitive);
    if (is_turned)
      gltf.json["nodes"][0]["rotation"] = {0, 0, 1, 0};
    const Imported mesh = import(gltf);
    EXPECT_EQ(mesh.count("normals_made_zero"), 1U);
    EXPECT_EQ(mesh.count("texcoords_made_zero"), 1U);
    const std::vector<float> second(mesh.attributes.begin() + 5, mesh.attributes.begin() + 10);
    EXPECT_EQ(second, std::vector<float>(5, 0.0F));
  }
}

TEST_F(GltfImportTest, ExtensionsThatChangeNothingMayBeRequired) {
  std::ifstream manual(fs::path(MESHHIER_SOURCE_DIR) / "docs/input_formats.md");
  const std::string documented(std::istreambuf_iterator<char>(manual), {});
  GltfBuilder gltf;
  gltf.show(square(gltf));
  for (const auto& extensions : {mesh_io::read_extensions(), mesh_io::harmless_extensions()}) {
    for (const mesh_io::GltfExtension& one : extensions) {
      const std::string name = std::string(one.name) + (one.name.ends_with('_') ? "any" : "");
      gltf.json["extensionsRequired"] = {name};
      EXPECT_EQ(failure(gltf), "") << name;
      EXPECT_THAT(documented, HasSubstr("`" + std::string(one.name))) << "in the manual";
    }
  }
}

TEST_F(GltfImportTest, UnknownRequiredExtensionsAreRefusedByName) {
  GltfBuilder gltf;
  gltf.show(square(gltf));
  gltf.json["extensionsRequired"] = {"KHR_materials_unlit", "VENDOR_other"};
  EXPECT_THAT(failure(gltf), HasSubstr("requires the extension VENDOR_other"));
  gltf.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_mesh_quantization"};
  EXPECT_EQ(failure(gltf), "");
}

TEST_F(GltfImportTest, OtherVersionsAreRefused) {
  for (const char* asset :
       {R"({"version":"1.0"})", R"({"version":1})", "{}", R"({"version":"3.0"})"}) {
    put("a.gltf", std::string(R"({"asset":)") + asset + "}");
    EXPECT_THAT(failure("a.gltf"), HasSubstr("convert the file to glTF 2.0")) << asset;
  }
  put("a.glb", "glTF" + tests::little(1) + tests::little(20) + std::string(8, 'x'));
  EXPECT_THAT(failure("a.glb"), HasSubstr("GLB of version 1, expected 2"));
}

/// Each number of each accessor, view and primitive, one after another.
TEST_F(GltfImportTest, LyingNumbersAreRefused) {
  GltfBuilder gltf;
  GltfJson primitive = square(gltf);
  primitive["attributes"]["NORMAL"] = gltf.accessor(kSquare, "VEC3");
  primitive["attributes"]["TEXCOORD_0"] = gltf.accessor(kSquareUv, "VEC2");
  gltf.show(primitive);
  gltf.json["buffers"] = {{{"byteLength", gltf.bin.size()}}};
  for (GltfJson& view : gltf.json["bufferViews"])
    view["byteStride"] = 0;
  for (GltfJson& accessor : gltf.json["accessors"])
    accessor["byteOffset"] = 0;
  ASSERT_EQ(failure(gltf), "");
  const GltfJson flat = gltf.json.flatten();
  std::size_t refused = 0;
  for (const auto& [place, value] : flat.items()) {
    if (!value.is_number())
      continue;
    for (const GltfJson& lie :
         {GltfJson(-1), GltfJson(1.5), GltfJson(4294967295U), GltfJson(4294967296U),
          GltfJson(UINT64_MAX), GltfJson(std::uint64_t{1} << 53), GltfJson(1e300), GltfJson("x"),
          GltfJson(nullptr), GltfJson::array(), GltfJson::object()}) {
      GltfBuilder lying = gltf;
      lying.json[GltfJson::json_pointer(place)] = lie;
      const std::string message = failure(lying);
      EXPECT_THAT(message, HasSubstr("w/a.glb: ")) << place << " " << lie;
      EXPECT_LT(message.size(), 300U);
      refused += message.empty() ? 0 : 1;
    }
  }
  EXPECT_GE(refused, 200U);
}

TEST_F(GltfImportTest, ATruncatedGlbIsRefused) {
  GltfBuilder gltf;
  gltf.show(textured_square(gltf, gltf.textured_material({{"bufferView", gltf.view("picture")}})));
  const std::string whole = gltf.glb();
  put("a.glb", whole);
  ASSERT_EQ(failure("a.glb"), "");
  for (std::size_t size = 4; size < whole.size(); ++size) {
    put("a.glb", whole.substr(0, size));
    EXPECT_THAT(failure("a.glb"), HasSubstr("a.glb")) << size;
    if (size > 16) {
      put("a.glb", whole.substr(0, 8) + tests::little(static_cast<std::uint32_t>(size)) +
                       whole.substr(12, size - 12));
      EXPECT_THAT(failure("a.glb"), HasSubstr("a.glb")) << size;
    }
  }
}

TEST_F(GltfImportTest, ZerosWithoutBytesAreFew) {
  GltfBuilder gltf;
  gltf.add("accessors", {{"componentType", 5126}, {"count", 4000000000U}, {"type", "VEC3"}});
  gltf.show({{"attributes", {{"POSITION", 0}}}});
  EXPECT_THAT(failure(gltf), HasSubstr("accessors[0] has no bufferView for its 4000000000"));
}

TEST_F(GltfImportTest, SLOW_JsonBeyondTheMemoryIsRefused) {
  std::string json = R"({"asset":{"version":"2.0"},"extras":[)";
  for (int i = 0; i < 100000; ++i)
    json += "{},";
  put("a.gltf", json + "{}]}");
  ImportHow tight{.memory = tests::kTight};
  try {
    import("a.gltf", tight);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::budget);
    EXPECT_THAT(error.what(), HasSubstr("give a larger memory_budget"));
  }
  put("b.gltf", R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '['));
  EXPECT_THAT(failure("b.gltf"), HasSubstr("nested deeper than 64 levels"));
}

/// Tiles of a hierarchy are meshes themselves.
TEST_F(GltfImportTest, TilesOfAHierarchyAreMeshes) {
  for (const storage::Compression compression :
       {storage::Compression::none, storage::Compression::meshopt}) {
    storage::TileFormat format;
    format.attributes = {.normals = true, .colour = ColourType::u8};
    format.compression = compression;
    const tests::SampleHierarchy sample = tests::make_sample(tests::sphere(500), 4, format);
    for (const PublishedTile& tile : sample.tiles) {
      const auto bytes = storage::encode_tile(tile, sample.tree, format);
      put("tile.glb", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      const Imported mesh = import("tile.glb");
      EXPECT_EQ(mesh.layout,
                (AttributeLayout{
                    .normals = true, .colour = ColourType::u16, .space = ColourSpace::linear}));
      EXPECT_EQ(mesh.triangles.size() + mesh.summary.degenerate_triangles,
                tile.mesh.interior.size() + tile.mesh.border.size());
    }
  }
}

}  // namespace
}  // namespace meshhier::importing
