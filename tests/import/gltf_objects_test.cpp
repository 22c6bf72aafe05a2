// Objects of glTF files and tiles: nodes, materials and features.
#include "base/error.h"
#include "import/imported.h"
#include "support/gltf_builder.h"
#include "tests/support/error_message.h"
#include "tests/support/memory_files.h"

#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using mesh_io::ObjectSource;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::GltfBuilder;
using tests::GltfJson;
using tests::Imported;
using tests::ImportHow;

ImportHow asking(ObjectSource source) {
  ImportHow how;
  how.objects = {source};
  return how;
}

/// Six corners of two triangles.
const std::vector<float> kPair{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

std::string number_word(std::size_t number) {
  return tests::little(static_cast<std::uint32_t>(number));
}

std::string batched_tile(const std::string& glb, std::string json, const std::string& binary = "") {
  json.resize((json.size() + 7) / 8 * 8, ' ');
  const std::string features = R"({"BATCH_LENGTH":2}      )";
  return "b3dm" + number_word(1) +
         number_word(28 + features.size() + json.size() + binary.size() + glb.size()) +
         number_word(features.size()) + number_word(0) + number_word(json.size()) +
         number_word(binary.size()) + features + json + binary + glb;
}

class GltfObjectsTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) {
    files_.put(fs::path("w") / name, content);
  }
  Imported import(const GltfBuilder& gltf, ObjectSource source = ObjectSource::evident) {
    put("a.glb", gltf.glb());
    return tests::import_files(files_, fs::path("w/a.glb"), asking(source));
  }
  std::string failure(const GltfBuilder& gltf, ObjectSource source = ObjectSource::feature) {
    return tests::error_message(ErrorCode::input, [&] { import(gltf, source); });
  }
  Imported import_tiles(const std::vector<std::string>& tiles,
                        ObjectSource from = ObjectSource::evident) {
    GltfJson root{{"boundingVolume", {{"sphere", {0, 0, 0, 10}}}}, {"geometricError", 0}};
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      put(fmt::format("{}.b3dm", i), tiles[i]);
      root["children"].push_back({{"boundingVolume", {{"sphere", {0, 0, 0, 10}}}},
                                  {"geometricError", 0},
                                  {"content", {{"uri", fmt::format("{}.b3dm", i)}}}});
    }
    put("tileset.json",
        GltfJson{{"asset", {{"version", "1.0"}}}, {"geometricError", 9}, {"root", root}}.dump());
    return tests::import_files(files_, fs::path("w/tileset.json"), asking(from));
  }

  tests::MemoryFiles files_;
};

std::string shown(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);
  if (const auto* flag = std::get_if<bool>(&value))
    return *flag ? "true" : "false";
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : "-";
}

std::vector<std::string> rows_of(const Imported& mesh) {
  std::vector<std::string> rows;
  for (const ObjectRow& row : mesh.objects) {
    std::string text = row.name + ":";
    for (const ObjectValue& value : row.values)
      text += ' ' + shown(value);
    rows.push_back(text);
  }
  return rows;
}

TEST_F(GltfObjectsTest, NodesThatShowAMesh) {
  GltfBuilder gltf;
  const std::size_t mesh =
      gltf.mesh({{"attributes", {{"POSITION", gltf.accessor(kPair, "VEC3")}}}});
  gltf.node({{"name", "house"}, {"children", {1, 4}}});
  gltf.node({{"name", "storey"}, {"children", {2, 3}}});
  gltf.node({{"name", "wall"}, {"mesh", mesh}, {"extras", {{"thick", 0.25}, {"tags", {1, 2}}}}});
  gltf.node({{"name", "wall"}, {"mesh", mesh}});
  gltf.node({{"mesh", mesh}});
  gltf.json["scenes"] = GltfJson::array({{{"nodes", {0}}}});
  const Imported evident = import(gltf);
  EXPECT_THAT(rows_of(evident), ElementsAre("house/node 4: - -", "house/storey/wall: [1,2] 0.25",
                                            "house/storey/wall (2): - -"));
  EXPECT_THAT(evident.names_of_triangles(),
              ElementsAre("house/storey/wall", "house/storey/wall", "house/storey/wall (2)",
                          "house/storey/wall (2)", "house/node 4", "house/node 4"));
  gltf.json["nodes"][3].erase("name");
  EXPECT_THAT(import(gltf).objects, IsEmpty()) << "one has a name";
  EXPECT_THAT(import(gltf, ObjectSource::node).objects, SizeIs(3));
  gltf.json["meshes"][0]["name"] = "brick";
  EXPECT_THAT(import(gltf).object_names(),
              ElementsAre("house/brick", "house/storey/brick", "house/storey/wall"));
  gltf.json["nodes"][2]["name"] = 7;
  EXPECT_THAT(import(gltf).objects, SizeIs(3)) << "a name that is no text is none";
}

TEST_F(GltfObjectsTest, CopiesOfANodeAndMaterials) {
  GltfBuilder gltf;
  const GltfJson attributes{{"POSITION", gltf.accessor(kPair, "VEC3")}};
  gltf.add("materials", {{"name", "brick"}});
  gltf.add("materials", {{"name", "glass"}});
  const std::size_t places = gltf.accessor(std::vector<float>{0, 0, 0, 5, 0, 0}, "VEC3");
  gltf.node(
      {{"name", "tree"},
       {"mesh", gltf.mesh({{"attributes", attributes}, {"material", 1}})},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  gltf.node({{"mesh", gltf.mesh({{"attributes", attributes}, {"material", 0}})}});
  EXPECT_THAT(import(gltf, ObjectSource::node).object_names(),
              ElementsAre("node 1", "tree/1", "tree/2"));
  EXPECT_THAT(import(gltf, ObjectSource::material).names_of_triangles(),
              ElementsAre("glass", "glass", "glass", "glass", "brick", "brick"));
}

TEST_F(GltfObjectsTest, WaysOfHostileDepthAreCut) {
  GltfBuilder gltf;
  const std::size_t mesh =
      gltf.mesh({{"attributes", {{"POSITION", gltf.accessor(kPair, "VEC3")}}}});
  for (std::size_t i = 0; i < 3000; ++i) {
    GltfJson node{{"name", fmt::format("level {}", i)}, {"mesh", mesh}};
    if (i + 1 < 3000)
      node["children"] = {i + 1};
    gltf.node(node);
  }
  const Imported mesh_of_all = import(gltf);
  ASSERT_THAT(mesh_of_all.objects, SizeIs(3000));
  for (const ObjectRow& row : mesh_of_all.objects)
    EXPECT_LE(row.name.size(), 5000U);
}

/// Two triangles with features 1 and 0, and a table.
GltfBuilder with_table(const GltfJson& properties, const GltfJson& columns) {
  GltfBuilder gltf;
  gltf.show(
      {{"attributes",
        {{"POSITION", gltf.accessor(kPair, "VEC3")},
         {"_FEATURE_ID_0", gltf.accessor(std::vector<float>{1, 1, 1, 0, 0, 5}, "SCALAR")}}},
       {"extensions",
        {{"EXT_mesh_features",
          {{"featureIds", {{{"featureCount", 2}, {"attribute", 0}, {"propertyTable", 0}}}}}}}}});
  gltf.json["extensions"]["EXT_structural_metadata"] = {
      {"schema",
       {{"classes", {{"building", {{"properties", properties}}}}},
        {"enums",
         {{"roofs",
           {{"values",
             {{{"name", "flat"}, {"value", 0}}, {{"name", "gabled"}, {"value", 7}}}}}}}}}},
      {"propertyTables", {{{"class", "building"}, {"count", 2}, {"properties", columns}}}}};
  return gltf;
}

TEST_F(GltfObjectsTest, FeaturesWithAPropertyTable) {
  GltfBuilder gltf = with_table({}, {});
  const auto view = [&](const std::string& bytes) { return gltf.view(bytes); };
  const std::string offsets = number_word(0) + number_word(4) + number_word(8);
  GltfJson& metadata = gltf.json["extensions"]["EXT_structural_metadata"];
  metadata["schema"]["classes"]["building"]["properties"] = {
      {"name", {{"type", "STRING"}}},
      {"h", {{"type", "SCALAR"}, {"componentType", "FLOAT32"}, {"noData", 9}, {"default", 4}}},
      {"roof", {{"type", "ENUM"}, {"enumType", "roofs"}}},
      {"on", {{"type", "BOOLEAN"}}},
      {"at", {{"type", "VEC2"}, {"componentType", "INT16"}}},
      {"many", {{"type", "SCALAR"}, {"componentType", "UINT8"}, {"array", true}}},
      {"id64", {{"type", "SCALAR"}, {"componentType", "UINT64"}}},
      {"part",
       {{"type", "SCALAR"},
        {"componentType", "UINT8"},
        {"normalized", true},
        {"scale", 10},
        {"offset", 1}}}};
  metadata["propertyTables"][0]["properties"] = {
      {"name", {{"values", view("hallmill")}, {"stringOffsets", view(offsets)}}},
      {"h", {{"values", view(GltfBuilder::bytes_of(std::vector<float>{9, 2.5F}))}}},
      {"roof", {{"values", view(GltfBuilder::bytes_of(std::vector<std::uint16_t>{7, 3}))}}},
      {"on", {{"values", view(std::string(1, '\2'))}}},
      {"at", {{"values", view(GltfBuilder::bytes_of(std::vector<std::int16_t>{1, -2, 3, 4}))}}},
      {"many",
       {{"values", view(std::string("\1\2\3", 3))},
        {"arrayOffsets", view(number_word(0) + number_word(1) + number_word(3))}}},
      {"id64", {{"values", view(std::string(8, '\xff') + "\5" + std::string(7, '\0'))}}},
      {"part", {{"values", view(std::string("\xff\0", 2))}}}};
  const Imported mesh = import(gltf);
  EXPECT_THAT(rows_of(mesh), ElementsAre("hall: [1, -2] 4 18446744073709551615 [1] false 11 gabled",
                                         "mill: [3, 4] 2.5 5 [2, 3] true 1 3"));
  EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("mill", "hall"));
  EXPECT_EQ(mesh.properties[2].type, ObjectPropertyType::text);

  metadata["propertyTables"][0]["count"] = 3;
  EXPECT_THAT(failure(gltf), HasSubstr("too few for 3 rows"));
  metadata["propertyTables"][0]["count"] = 2;
  metadata["propertyTables"][0]["properties"]["name"]["stringOffsets"] =
      view(number_word(0) + number_word(6) + number_word(4));
  EXPECT_THAT(failure(gltf), HasSubstr("offsets that do not ascend"));
  metadata["propertyTables"][0]["properties"]["name"]["stringOffsets"] =
      view(number_word(0) + number_word(4) + number_word(4000));
  EXPECT_THAT(failure(gltf), HasSubstr("leads beyond its values"));
}

TEST_F(GltfObjectsTest, FeaturesWithoutNamesAreNumbered) {
  GltfBuilder gltf = with_table({}, {});
  const std::size_t view = gltf.view(GltfBuilder::bytes_of(std::vector<float>{1, 2}));
  GltfJson& metadata = gltf.json["extensions"]["EXT_structural_metadata"];
  metadata["schema"]["classes"]["building"]["properties"] = {
      {"h", {{"type", "SCALAR"}, {"componentType", "FLOAT32"}}}};
  metadata["propertyTables"][0]["properties"] = {{"h", {{"values", view}}}};
  EXPECT_THAT(rows_of(import(gltf)), ElementsAre("feature 0: 1", "feature 1: 2"));

  GltfBuilder bare = gltf;
  bare.json.erase("extensions");
  bare.json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"][0].erase(
      "propertyTable");
  EXPECT_THAT(import(bare).objects, IsEmpty()) << "ids without properties are labels alone";
  EXPECT_THAT(import(bare, ObjectSource::feature).names_of_triangles(),
              ElementsAre("feature 1", "feature 0"));
  bare.json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"][0]
           ["nullFeatureId"] = 0;
  EXPECT_THAT(import(bare, ObjectSource::feature).names_of_triangles(),
              ElementsAre("feature 1", ""));
}

TEST_F(GltfObjectsTest, MetadataThatIsNotReadIsTold) {
  GltfBuilder gltf;
  gltf.show({{"attributes", {{"POSITION", gltf.accessor(kPair, "VEC3")}}},
             {"extensions",
              {{"EXT_mesh_features",
                {{"featureIds", {{{"featureCount", 2}, {"texture", {{"index", 0}}}}}}}}}}});
  gltf.json["extensions"]["EXT_structural_metadata"] = {{"propertyTextures", {1}},
                                                        {"propertyAttributes", {1, 2}}};
  const Imported mesh = import(gltf);
  EXPECT_THAT(mesh.objects, IsEmpty());
  EXPECT_THAT(mesh.warnings,
              ElementsAre(HasSubstr("1 feature id set not read: only ids of vertices"),
                          HasSubstr("1 property texture not read"),
                          HasSubstr("2 property attributes not read")));
  EXPECT_EQ(mesh.count(std::string(kFeaturesInTextures)), 1U);
  EXPECT_THAT(failure(gltf), HasSubstr("has no features of a glTF or b3dm"));
}

TEST_F(GltfObjectsTest, ASecondSetOfIdsIsTold) {
  GltfBuilder gltf = with_table(GltfJson::object(), GltfJson::object());
  gltf.json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"]
      .push_back({{"featureCount", 6}});
  const Imported mesh = import(gltf, ObjectSource::feature);
  EXPECT_EQ(mesh.count(std::string(kFurtherFeatures)), 1U);
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("1 feature id set not read: the first one")));
}

TEST_F(GltfObjectsTest, IdsThatNothingSaysAreNumbersOfVertices) {
  GltfBuilder gltf = with_table(GltfJson::object(), GltfJson::object());
  GltfJson& ids =
      gltf.json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"][0];
  ids.erase("attribute");
  EXPECT_THAT(import(gltf, ObjectSource::feature).names_of_triangles(),
              ElementsAre("feature 0", "feature 3"));
}

TEST_F(GltfObjectsTest, ASchemaInAFileOfItsOwn) {
  GltfBuilder gltf = with_table({}, {});
  GltfJson& metadata = gltf.json["extensions"]["EXT_structural_metadata"];
  const std::size_t view = gltf.view(GltfBuilder::bytes_of(std::vector<float>{1, 2}));
  metadata["propertyTables"][0]["properties"] = {{"h", {{"values", view}}}};
  GltfJson schema = metadata["schema"];
  schema["classes"]["building"]["properties"] = {
      {"h", {{"type", "SCALAR"}, {"componentType", "FLOAT32"}}}};
  metadata.erase("schema");
  metadata["schemaUri"] = "my%20schema.json";
  EXPECT_EQ(import(gltf).count(std::string(kUnreadTables)), 1U);
  EXPECT_THAT(failure(gltf), HasSubstr("its schema: w/my schema.json is not there"));
  put("my schema.json", schema.dump());
  const Imported mesh = import(gltf);
  EXPECT_THAT(rows_of(mesh), ElementsAre("feature 0: 1", "feature 1: 2"));
  EXPECT_THAT(mesh.companions(), ElementsAre("w/my schema.json"));
  put("my schema.json", "{\"classes\": 7}");
  EXPECT_THAT(failure(gltf), HasSubstr("classes"));
}

/// A mesh of two triangles in three places, which are features of a table of two rows.
GltfBuilder with_copies(const std::vector<float>& features) {
  GltfBuilder gltf = with_table({}, {});
  gltf.json["meshes"][0]["primitives"][0].erase("extensions");
  const std::size_t view = gltf.view(GltfBuilder::bytes_of(std::vector<std::int8_t>{5, 6}));
  GltfJson& metadata = gltf.json["extensions"]["EXT_structural_metadata"];
  metadata["schema"]["classes"]["building"]["properties"] = {
      {"age", {{"type", "SCALAR"}, {"componentType", "INT8"}}}};
  metadata["propertyTables"][0]["properties"] = {{"age", {{"values", view}}}};
  const std::vector<float> places{0, 0, 0, 5, 0, 0, 9, 0, 0};
  GltfJson attributes{{"TRANSLATION", gltf.accessor(places, "VEC3")}};
  GltfJson ids{{"featureCount", 2}, {"propertyTable", 0}};
  if (!features.empty()) {
    attributes["_FEATURE_ID_0"] = gltf.accessor(features, "SCALAR");
    ids["attribute"] = 0;
  }
  gltf.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}},
                                         {"EXT_instance_features", {{"featureIds", {ids}}}}};
  return gltf;
}

TEST_F(GltfObjectsTest, EachCopyIsAFeature) {
  const Imported mesh = import(with_copies({1, 0, 1}));
  EXPECT_THAT(rows_of(mesh), ElementsAre("feature 0: 5", "feature 1: 6"));
  EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("feature 1", "feature 1", "feature 0",
                                                     "feature 0", "feature 1", "feature 1"));
  EXPECT_THAT(
      import(with_copies({})).names_of_triangles(),
      ElementsAre("feature 0", "feature 0", "feature 1", "feature 1", "feature 2", "feature 2"));
  EXPECT_THAT(failure(with_copies({1, 0})), HasSubstr("has 2 elements for the features of more"));
}

TEST_F(GltfObjectsTest, AColumnMaySayThatItIsAName) {
  GltfBuilder gltf = with_table({}, {});
  const std::string offsets = number_word(0) + number_word(4) + number_word(8);
  GltfJson& metadata = gltf.json["extensions"]["EXT_structural_metadata"];
  metadata["schema"]["classes"]["building"]["properties"] = {
      {"what", {{"type", "STRING"}, {"semantic", "NAME"}}},
      {"key", {{"type", "STRING"}, {"semantic", "ID"}}}};
  metadata["propertyTables"][0]["properties"] = {
      {"what", {{"values", gltf.view("hallmill")}, {"stringOffsets", gltf.view(offsets)}}},
      {"key", {{"values", gltf.view("DE_1DE_2")}, {"stringOffsets", gltf.view(offsets)}}}};
  EXPECT_THAT(rows_of(import(gltf)), ElementsAre("hall: DE_1", "mill: DE_2"));
}

TEST_F(GltfObjectsTest, BatchTablesOfTiles) {
  GltfBuilder gltf;
  gltf.show({{"attributes",
              {{"POSITION", gltf.accessor(kPair, "VEC3")},
               {"_BATCHID", gltf.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "SCALAR")}}}});
  const std::string heights = GltfBuilder::bytes_of(std::vector<float>{1.5F, 2});
  const Imported mesh = import_tiles(
      {batched_tile(gltf.glb(),
                    R"({"id":["x1","x2"],"h":{"byteOffset":0,"componentType":"FLOAT","type":)"
                    R"("SCALAR"},"use":["home",null],"HIERARCHY":{"classes":[]}})",
                    heights),
       batched_tile(gltf.glb(), R"({"id":["x2","x3"],"use":["shop","farm"]})")});
  EXPECT_THAT(rows_of(mesh), ElementsAre("x1: 1.5 home", "x2: 2 shop", "x3: - farm"));
  EXPECT_THAT(mesh.warnings,
              ElementsAre(HasSubstr("1 property of objects left out: \"HIERARCHY\"")));
  EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("x1", "x2", "x2", "x3"));

  GltfBuilder old;
  old.show({{"attributes",
             {{"POSITION", old.accessor(kPair, "VEC3")},
              {"BATCHID", old.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "SCALAR")}}}});
  const Imported early = import_tiles({batched_tile(old.glb(), R"({"id":["x1","x2"]})")});
  EXPECT_THAT(early.names_of_triangles(), ElementsAre("x1", "x2"));

  const Imported unnamed =
      import_tiles({batched_tile(gltf.glb(), R"({"id":[0,1],"use":["a","b"]})"),
                    batched_tile(gltf.glb(), R"({"id":[0,1],"use":["c","d"]})")});
  EXPECT_THAT(rows_of(unnamed), ElementsAre("0.b3dm/feature 0: 0 a", "0.b3dm/feature 1: 1 b",
                                            "1.b3dm/feature 0: 0 c", "1.b3dm/feature 1: 1 d"))
      << "numbers of rows say nothing in another tile";
}

TEST_F(GltfObjectsTest, AnIdSaysWhatIsTheSameThingInAllTiles) {
  GltfBuilder gltf;
  gltf.show({{"attributes",
              {{"POSITION", gltf.accessor(kPair, "VEC3")},
               {"_BATCHID", gltf.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "SCALAR")}}}});
  const Imported mesh = import_tiles(
      {batched_tile(gltf.glb(), R"({"gml:id":["DE_1","DE_2"],"name":["mill","hall"]})"),
       batched_tile(gltf.glb(), R"({"gml:id":["DE_2","DE_3"],"name":["shed","shed"],"h":[1,2]})"),
       batched_tile(gltf.glb(), R"({"gml:id":["DE_4",null],"name":["mill",""],"h":[3,4]})")});
  EXPECT_THAT(rows_of(mesh),
              ElementsAre("2.b3dm/feature 1: - 4 -", "DE_3: - 2 shed", "hall: DE_2 1 shed",
                          "mill: DE_1 - -", "mill (DE_4): DE_4 3 -"));
  EXPECT_THAT(mesh.names_of_triangles(),
              ElementsAre("mill", "hall", "hall", "DE_3", "mill (DE_4)", "2.b3dm/feature 1"));
}

TEST_F(GltfObjectsTest, TilesOfACompositeNumberTheirFeaturesApart) {
  GltfBuilder gltf;
  gltf.show({{"attributes",
              {{"POSITION", gltf.accessor(kPair, "VEC3")},
               {"_BATCHID", gltf.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "SCALAR")}}}});
  const auto composite = [&](const std::string& first, const std::string& second) {
    const std::string tiles = batched_tile(gltf.glb(), first) + batched_tile(gltf.glb(), second);
    return "cmpt" + number_word(1) + number_word(16 + tiles.size()) + number_word(2) + tiles;
  };
  EXPECT_THAT(rows_of(import_tiles({composite(R"({"h":[1,2]})", R"({"h":[3,4]})")})),
              ElementsAre("0.b3dm/1/feature 0: 1", "0.b3dm/1/feature 1: 2", "0.b3dm/2/feature 0: 3",
                          "0.b3dm/2/feature 1: 4"));
  EXPECT_THAT(rows_of(import_tiles(
                  {composite(R"({"id":["a","b"],"h":[1,2]})", R"({"id":["b","c"],"h":[3,4]})")})),
              ElementsAre("a: 1", "b: 2", "c: 4"));
}

TEST_F(GltfObjectsTest, BatchTablesThatLie) {
  GltfBuilder gltf;
  gltf.show({{"attributes",
              {{"POSITION", gltf.accessor(kPair, "VEC3")},
               {"_BATCHID", gltf.accessor(std::vector<float>{0, 0, 0, 9, 9, 9}, "SCALAR")}}}});
  const auto failure_of = [&](const std::string& json) -> std::string {
    return tests::error_message(ErrorCode::input, [&] {
      const std::string tile = batched_tile(gltf.glb(), json, "12345678");
      const Imported unasked = import_tiles({tile});
      EXPECT_EQ(unasked.count(std::string(kUnreadTables)), 1U) << "nobody asked for it";
      import_tiles({tile}, ObjectSource::feature);
    });
  };
  EXPECT_THAT(failure_of(R"({"h":{"byteOffset":9,"componentType":"FLOAT","type":"SCALAR"}})"),
              HasSubstr("byteOffset"));
  EXPECT_THAT(failure_of(R"({"h":{"byteOffset":0,"componentType":"HALF","type":"SCALAR"}})"),
              HasSubstr("unknown componentType or type"));
  EXPECT_THAT(failure_of("[1]"), HasSubstr("no object of JSON"));
  EXPECT_THAT(failure_of("{\"a\":"), HasSubstr("0.b3dm"));
  const Imported shorter = import_tiles({batched_tile(gltf.glb(), R"({"n":["a","b"],"m":["c"]})")});
  EXPECT_THAT(rows_of(shorter), ElementsAre("feature 0: c a", "feature 1: - b", "feature 9: - -"))
      << "a feature without a row";
}

}  // namespace
}  // namespace meshhier::importing
