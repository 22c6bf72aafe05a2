// Objects of triangles: where they come from, how they are numbered, what a table adds.
#include "import/import_test.h"
#include "import/object_names.h"
#include "import/property_types.h"
#include "import/row_sort.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

using mesh_io::ObjectChoice;
using mesh_io::ObjectSource;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::Imported;
using tests::ImportHow;

/// A strip of four triangles between six vertices.
constexpr const char* kStrip = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 2 0\nv 1 2 0\n";

ImportHow from(ObjectSource source, const std::string& label = {}) {
  ImportHow how;
  how.objects = {source, label};
  return how;
}

std::string text_of(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);
  if (const auto* flag = std::get_if<bool>(&value))
    return *flag ? "true" : "false";
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? '"' + *text + '"' : "-";
}

std::vector<std::string> rows_of(const Imported& mesh) {
  std::vector<std::string> rows;
  for (const ObjectRow& row : mesh.objects) {
    std::string text = row.name + ":";
    for (const ObjectValue& value : row.values)
      text += ' ' + text_of(value);
    rows.push_back(text);
  }
  return rows;
}

std::vector<std::string> types_of(const Imported& mesh) {
  std::vector<std::string> types;
  for (const ObjectProperty& property : mesh.properties)
    types.push_back(fmt::format("{} {}", property.name, name_of(property.type)));
  return types;
}

class ObjectsTest : public tests::ImportTest {
 protected:
  void put_obj(const std::string& faces) { put("a.obj", kStrip + faces); }
  Imported import(const ImportHow& how, const std::string& name = "a.obj") {
    return import_file(name, how);
  }
  std::string failure(const ImportHow& how, const std::string& name = "a.obj") {
    try {
      import(how, name);
    } catch (const Error& error) {
      EXPECT_TRUE(error.code() == ErrorCode::input || error.code() == ErrorCode::usage);
      return error.what();
    }
    return {};
  }
  Imported import_with_table(const std::string& table, ObjectSource source = ObjectSource::object,
                             const std::string& name = "t.csv") {
    put(name, table);
    ImportHow how = from(source);
    how.object_table = "w/" + name;
    return import(how);
  }
};

// ---- where they come from

TEST_F(ObjectsTest, StatementsOfAnObjAreNumberedByName) {
  put_obj("f 1 2 3\no roof\nf 2 4 3\no Wall\nf 3 4 5\no roof\nf 4 6 5\n");
  for (const auto& memory : {tests::kRoomy, tests::kTight}) {
    ImportHow how = from(ObjectSource::object);
    how.memory = memory;
    const Imported mesh = import(how);
    EXPECT_THAT(mesh.object_names(), ElementsAre("", "Wall", "roof"));
    EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("", "roof", "Wall", "roof"));
    EXPECT_THAT(mesh.layout.values,
                ElementsAre(ScalarAttribute{"object", ValueType::u32, true, true}));
    EXPECT_THAT(mesh.positions, SizeIs(6U + 5));
    EXPECT_EQ(mesh.count("split_vertices"), 5U);
  }
}

TEST_F(ObjectsTest, WhatIsEvidentNeedsTwoNames) {
  put_obj("o a\ng x\nf 1 2 3\ng y\nf 2 4 3\n");
  EXPECT_THAT(import(from(ObjectSource::evident)).object_names(), ElementsAre("x", "y"))
      << "the statements o have one name alone";
  put_obj("o a\ng x\nf 1 2 3\no b\ng y\nf 2 4 3\n");
  EXPECT_THAT(import(from(ObjectSource::evident)).object_names(), ElementsAre("a", "b"));
  put_obj("o a\ng x\nf 1 2 3\n");
  const Imported plain = import(from(ObjectSource::evident));
  EXPECT_THAT(plain.objects, IsEmpty());
  EXPECT_THAT(plain.layout.values, IsEmpty());
  EXPECT_THAT(import(from(ObjectSource::group)).object_names(), ElementsAre("x"));
  EXPECT_THAT(failure(from(ObjectSource::material)),
              HasSubstr("a.obj has no materials of an OBJ file or a glTF"));
}

TEST_F(ObjectsTest, MaterialsAndFilesAreObjectsIfOneAsks) {
  put_obj("usemtl brick\nf 1 2 3\nusemtl glass\nf 2 4 3\n");
  EXPECT_THAT(import(from(ObjectSource::material)).names_of_triangles(),
              ElementsAre("brick", "glass"));
  put("in/b.obj", std::string(kStrip) + "f 1 2 3\n");
  mesh_io::InputPaths paths;
  paths.push_back("w/a.obj");
  paths.push_back("w/in/b.obj");
  const Imported both = tests::import_files(files_, paths, from(ObjectSource::file));
  EXPECT_THAT(both.names_of_triangles(), ElementsAre("a.obj", "a.obj", "in/b.obj"));
}

TEST_F(ObjectsTest, FilesShareTheObjectsOfOneName) {
  put("a.obj", std::string(kStrip) + "o a\nf 1 2 3\no b\nf 2 4 3\n");
  put("b.obj", std::string(kStrip) + "f 1 2 3\no b\nf 2 4 3\n");
  put("c.stl",
      "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
      "vertex 0 1 0\nendloop\nendfacet\nendsolid x\n");
  mesh_io::InputPaths paths;
  for (const char* name : {"w/a.obj", "w/b.obj", "w/c.stl"})
    paths.push_back(name);
  const Imported mesh = tests::import_files(files_, paths, from(ObjectSource::evident));
  EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("a", "b", "", "b", "x"));
}

TEST_F(ObjectsTest, SolidsOfAnStl) {
  const auto facet = [](int x, int y = 1) {
    return fmt::format(
        "facet normal 0 0 1\nouter loop\nvertex {0} 0 0\nvertex {1} 0 0\nvertex {0} {2} 0\n"
        "endloop\nendfacet\n",
        x, x + 1, y);
  };
  const std::string flat = facet(0, 0);  // two of its corners are one
  put("a.stl", "solid left  part \n" + facet(0) + flat + "endsolid\nsolid right\n" + flat +
                   facet(1) + facet(2) + "endsolid right\nsolid left  part\n" + facet(3) +
                   "endsolid\n");
  for (const ObjectSource source : {ObjectSource::solid, ObjectSource::evident}) {
    const Imported mesh = import(from(source), "a.stl");
    EXPECT_THAT(mesh.names_of_triangles(),
                ElementsAre("left  part", "right", "right", "left  part"));
  }
  put("a.stl", "solid one\n" + facet(0) + "endsolid one\n");
  EXPECT_THAT(import(from(ObjectSource::evident), "a.stl").objects, IsEmpty());
}

TEST_F(ObjectsTest, LabelsOfFacesAndOfVertices) {
  put("a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 2\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 12\n3 0 2 3 7\n");
  const Imported faces = import(from(ObjectSource::label, "part"), "a.ply");
  EXPECT_THAT(faces.object_names(), ElementsAre("12", "7"));
  EXPECT_THAT(faces.names_of_triangles(), ElementsAre("12", "7"));
  EXPECT_EQ(faces.layout.values[0].name, "part");
  EXPECT_THAT(faces.values(0), ElementsAre(12, 7, 12, 12, 7, 7)) << "the label stays as it is";

  put("b.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty uchar part\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 3\n1 0 0 5\n1 1 0 5\n0 1 0 8\n2 2 0 8\n3 0 1 2\n3 0 2 3\n3 3 2 4\n");
  const Imported vertices = import(from(ObjectSource::label, "part"), "b.ply");
  EXPECT_THAT(vertices.names_of_triangles(), ElementsAre("5", "3", "8"))
      << "of three different ones the first corner's";
  EXPECT_THAT(failure(from(ObjectSource::label, "parts"), "b.ply"),
              HasSubstr("the input has no label \"parts\"; there is part"));
}

TEST_F(ObjectsTest, TheValueHasANameOfItsOwn) {
  put("a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty uchar object\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 1\n1 0 0 1\n1 1 0 1\n3 0 1 2\n");
  const Imported mesh = import(from(ObjectSource::label, "object"), "a.ply");
  EXPECT_EQ(mesh.layout.values[1].name, "object_2");
}

TEST_F(ObjectsTest, WeldingAndCroppingKeepThem) {
  std::string text;
  for (const int x : {0, 1, 2}) {
    text +=
        fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} 1 0\nv {1} 0 0\nv {1} 1 0\nv {0} 1 0\n", x, x + 1);
  }
  for (int i = 0; i < 3; ++i)
    text += fmt::format("o {}\nf {} {} {}\nf {} {} {}\n", i % 2 == 0 ? "even" : "odd", 6 * i + 1,
                        6 * i + 2, 6 * i + 3, 6 * i + 4, 6 * i + 5, 6 * i + 6);
  put("a.obj", text);
  ImportHow how = from(ObjectSource::object);
  how.weld = true;
  const Imported welded = import(how);
  EXPECT_THAT(welded.names_of_triangles(),
              ElementsAre("even", "even", "odd", "odd", "even", "even"));
  EXPECT_THAT(welded.positions, SizeIs(12)) << "four at each square, none shared with others";
  how.crop = BoundsD{{0, 0, 0}, {0.2, 0.2, 0}};
  EXPECT_THAT(import(how).names_of_triangles(), Each("even"));
}

TEST_F(ObjectsTest, PolygonsAndPicturesKeepThem) {
  put("a.png", "");
  put("a.mtl", "newmtl m\nmap_Kd a.png\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kStrip +
                   "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl m\no b\nf 1/1/1 2/2/1 4/3/1 3/1/1\n"
                   "o a\nf 3/2/1 4/3/1 6/1/1 5/1/1\n");
  const Imported mesh = import(from(ObjectSource::object));
  EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("b", "b", "a", "a"));
  EXPECT_TRUE(mesh.layout.material);
}

// ---- names

TEST_F(ObjectsTest, NamesOfAnyKind) {
  const std::string longest(70000, 'n');
  put_obj("o " + longest + "\nf 1 2 3\no " + longest + "x\nf 2 4 3\no bell\a\x1b[31m\nf 3 4 5\n" +
          "o \xff\xfe bad\nf 4 6 5\n");
  const Imported mesh = import(from(ObjectSource::object));
  EXPECT_THAT(mesh.object_names(),
              ElementsAre("bell\a\x1b[31m", longest, longest + "x", "\xC3\xBF\xC3\xBE bad"));
  put_obj("o " + std::string(600000, 'n') + "\nf 1 2 3\n");
  EXPECT_THAT(failure(from(ObjectSource::object)), HasSubstr("line 7: found a line of more than"));
}

TEST_F(ObjectsTest, ManyNamesThatComeAgainAndAgain) {
  std::string text = kStrip;
  const int kNames = 9000;  // more than are remembered
  for (int i = 0; i < 2 * kNames; ++i)
    text += fmt::format("g part number {}\nf 1 2 3\n", (i * 7) % kNames);
  put("a.obj", text);
  ImportHow how = from(ObjectSource::group);
  const Imported mesh = import(how);
  EXPECT_THAT(mesh.objects, SizeIs(kNames));
  EXPECT_TRUE(std::ranges::is_sorted(mesh.object_names()));
  const std::vector<std::string> names = mesh.names_of_triangles();
  for (int i = 0; i < 2 * kNames; ++i)
    ASSERT_EQ(names[static_cast<std::size_t>(i)], fmt::format("part number {}", (i * 7) % kNames));
  how.memory = tests::kTight;
  EXPECT_EQ(import(how).attributes, mesh.attributes);
}

// ---- tables

TEST_F(ObjectsTest, ATableGivesPropertiesOfGuessedTypes) {
  put_obj("o mill\nf 1 2 3\no hall\nf 2 4 3\no barn\nf 3 4 5\n");
  const Imported mesh = import_with_table(
      "\xEF\xBB\xBFname,height,built,listed,note,zip\r\n"
      "mill,12.5,1850-03-01,true,\"tall, \"\"round\"\"\nold\",01234\r\n"
      "hall,-8,1911-12-24T08:30:00Z,FALSE,,99999\r\n"
      "tower,1e3,,,,1\r\n");
  EXPECT_THAT(types_of(mesh), ElementsAre("height number", "built date", "listed boolean",
                                          "note text", "zip text"));
  EXPECT_THAT(rows_of(mesh),
              ElementsAre("barn: - - - - -", "hall: -8 \"1911-12-24T08:30:00Z\" false - \"99999\"",
                          "mill: 12.5 \"1850-03-01\" true \"tall, \"round\"\nold\" \"01234\""));
  EXPECT_EQ(mesh.count("table_rows"), 3U);
  EXPECT_EQ(mesh.count("unmatched_rows"), 1U);
  EXPECT_EQ(mesh.count("objects_without_row"), 1U);
  EXPECT_THAT(mesh.warnings,
              ElementsAre("w/t.csv: 1 row belongs to no object",
                          "w/t.csv: has no row for 1 object; the first is \"barn\""));
  EXPECT_THAT(mesh.companions(), ElementsAre("w/t.csv"));
}

TEST_F(ObjectsTest, RaggedRowsDuplicatesAndOtherSeparators) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  const Imported mesh = import_with_table("ID;h;w\na;1\nb;2;3;4\n\na;9;9\n;5;5\n");
  EXPECT_THAT(rows_of(mesh), ElementsAre("a: 1 -", "b: 2 3"));
  EXPECT_EQ(mesh.count("ragged_rows"), 2U);
  EXPECT_EQ(mesh.count("duplicate_rows"), 1U);
  EXPECT_EQ(mesh.count("unmatched_rows"), 1U);
  EXPECT_THAT(mesh.warnings[0], HasSubstr("2 rows with more or fewer fields"));
  EXPECT_THAT(mesh.warnings[0], HasSubstr("line 2 is the first"));
  EXPECT_THAT(rows_of(import_with_table("h\tname\n1\tb\n")), ElementsAre("a: -", "b: 1"));
}

TEST_F(ObjectsTest, LinesOfJson) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  const Imported mesh = import_with_table(
      "{\"name\": \"b\", \"h\": 2.5, \"on\": true, \"list\": [1, {\"x\": null}], \"s\": \"7\"}\n\n"
      "{\"h\": null, \"name\": \"a\", \"big\": 12345678901234567890, \"s\": \"2031-05-17\"}\n",
      ObjectSource::object, "t.jsonl");
  EXPECT_THAT(types_of(mesh),
              ElementsAre("h number", "list text", "on boolean", "s text", "big text"));
  EXPECT_THAT(rows_of(mesh), ElementsAre("a: - - - \"2031-05-17\" \"12345678901234567890\"",
                                         "b: 2.5 \"[1,{\"x\":null}]\" true \"7\" -"));
}

TEST_F(ObjectsTest, KeysInTheirOwnLettersComeFirst) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  const Imported mesh = import_with_table("NAME,name,h\nb,a,1\na,b,2\n");
  EXPECT_THAT(rows_of(mesh), ElementsAre("a: \"b\" 1", "b: \"a\" 2"));
}

TEST_F(ObjectsTest, LabelsAreKnownByIdAndNamedByTheTable) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 4\nproperty list uchar int vertex_indices\nproperty int bone\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 3\n3 0 2 3 10\n3 0 1 3 2\n3 1 2 3 5\n";
  put("a.ply", text);
  put("t.csv", "name,id,side\nfemur,3,left\ntibia,10,left\nfemur,2,right\n");
  ImportHow how = from(ObjectSource::label, "bone");
  how.object_table = "w/t.csv";
  const Imported mesh = import(how, "a.ply");
  EXPECT_THAT(rows_of(mesh), ElementsAre("5: - -", "femur: 2 \"right\"", "femur (3): 3 \"left\"",
                                         "tibia: 10 \"left\""));
  EXPECT_THAT(mesh.names_of_triangles(), ElementsAre("femur (3)", "tibia", "femur", "5"));
}

TEST_F(ObjectsTest, NamedObjectsAreKnownByIdOrByName) {
  put_obj("o b-1\nf 1 2 3\no mill\nf 2 4 3\n");
  const Imported mesh = import_with_table("id,name,h\nb-1,hall,3\nb-2,mill,4\n");
  EXPECT_THAT(rows_of(mesh), ElementsAre("b-1: \"hall\" 3", "mill: \"mill\" 4"));
  EXPECT_EQ(mesh.count("unmatched_rows"), 0U);
}

TEST_F(ObjectsTest, TablesThatAreWrong) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  const auto failure_of = [&](const std::string& table) {
    put("t.csv", table);
    ImportHow how = from(ObjectSource::object);
    how.object_table = "w/t.csv";
    return failure(how);
  };
  EXPECT_THAT(failure_of("height\n1\n"), HasSubstr("w/t.csv: has no column \"id\" or \"name\""));
  EXPECT_THAT(failure_of("id,\"h\n1,2\n"), HasSubstr("line 1: a field in quotes begins here"));
  EXPECT_THAT(failure_of("id,h\na,\"2\n3"), HasSubstr("line 2: a field in quotes begins here"));
  EXPECT_THAT(failure_of("id,h,h\na,1,2\n"), HasSubstr("two columns have the name 'h'"));
  EXPECT_THAT(failure_of("{\"id\": 1}\n[1]\n"), HasSubstr("line 2: expected an object of JSON"));
  EXPECT_THAT(failure_of("{\"id\": " + std::string(100, '[') + "\n"), HasSubstr("line 1"));
  EXPECT_THAT(failure_of(""), HasSubstr("found an empty file"));
  EXPECT_THAT(failure_of("PK\3\4"), HasSubstr("w/t.csv: expected a table as text"));
  put_obj("f 1 2 3\n");
  put("t.csv", "id\na\n");
  ImportHow how = from(ObjectSource::evident);
  how.object_table = "w/t.csv";
  EXPECT_THAT(failure(how), HasSubstr("has no objects that are evident"));
}

TEST_F(ObjectsTest, APropertyTooManyIsCounted) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  std::string head = "name", row = "a";
  for (int i = 0; i < 70; ++i) {
    head += fmt::format(",p{}", i);
    row += ",1";
  }
  const Imported mesh = import_with_table(head + '\n' + row + '\n');
  EXPECT_THAT(mesh.properties, SizeIs(kMostObjectProperties));
  EXPECT_EQ(mesh.count("dropped_properties"), 6U);
  EXPECT_THAT(mesh.warnings,
              ElementsAre("w/t.csv: has no row for 1 object; the first is \"b\"",
                          HasSubstr("a.obj: 6 properties of objects left out: \"p64\", \"p65\", "
                                    "\"p66\", \"p67\", \"p68\" and 1 more; up to 64 are kept")));
}

TEST_F(ObjectsTest, TablesOfSpreadsheetsInEurope) {
  put_obj(
      "o Stra\xDF"
      "e\nf 1 2 3\no b\nf 2 4 3\n");
  const Imported mesh = import_with_table(
      "sep=;\r\nname;h;rooms;when\r\nStra\xDF"
      "e;12,5;1,2;17.05.2031\r\nb;-1000;1.2;\r\n");
  EXPECT_THAT(types_of(mesh), ElementsAre("h number", "rooms text", "when text"));
  EXPECT_THAT(rows_of(mesh), ElementsAre("Stra\xC3\x9F"
                                         "e: 12.5 \"1,2\" \"17.05.2031\"",
                                         "b: -1000 \"1.2\" -"));
  EXPECT_EQ(mesh.count("fields_not_utf8"), 1U);
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("1 field with no UTF-8")));
  EXPECT_THAT(types_of(import_with_table("name,h\nb,\"1,5\"\n")), ElementsAre("h text"))
      << "commas stand between fields";
}

TEST_F(ObjectsTest, WordsForNothing) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  const Imported mesh =
      import_with_table("name\th\twhen\tt\na\tNA\tNULL\tNA\nb\t1,5\t2031-05-17\tx\n");
  EXPECT_THAT(types_of(mesh), ElementsAre("h number", "when date", "t text"));
  EXPECT_THAT(rows_of(mesh), ElementsAre("a: - - \"NA\"", "b: 1.5 \"2031-05-17\" \"x\""));
}

TEST_F(ObjectsTest, AFeatureOfGeoJsonIsItsProperties) {
  put_obj("o a\nf 1 2 3\no b\nf 2 4 3\n");
  const Imported mesh = import_with_table(
      "\x1E{\"type\": \"Feature\", \"id\": \"a\", \"geometry\": {\"type\": \"Point\", "
      "\"coordinates\": [1, 2]}, \"properties\": {\"h\": 3}}\n\x1E"
      "{\"type\": \"Feature\", \"properties\": {\"id\": \"b\", \"type\": \"mill\"}}\n",
      ObjectSource::object, "t.geojsonl");
  EXPECT_THAT(rows_of(mesh), ElementsAre("a: 3 -", "b: - \"mill\""));
  put("t.csv", "{\"type\": \"FeatureCollection\", \"features\": []}");
  ImportHow how = from(ObjectSource::object);
  how.object_table = "w/t.csv";
  EXPECT_THAT(failure(how), HasSubstr("jq -c '.features[]'"));
}

TEST_F(ObjectsTest, ColumnsThatAreIdsByAnotherName) {
  put_obj("o DE_1\nf 1 2 3\no DE_2\nf 2 4 3\n");
  EXPECT_THAT(rows_of(import_with_table("h,GML_ID\n1,DE_2\n2,DE_1\n")),
              ElementsAre("DE_1: 2", "DE_2: 1"));
  EXPECT_THAT(rows_of(import_with_table("gml_id,h,id\nDE_1,1,DE_2\n")),
              ElementsAre("DE_1: - -", "DE_2: \"DE_1\" 1"))
      << "a column \"id\" is the id";
  EXPECT_THAT(rows_of(import_with_table(",name,h\n0,DE_1,1\n")), ElementsAre("DE_1: 1", "DE_2: -"))
      << "pandas numbers the rows";
  const Imported none = import_with_table("id,h\n");
  EXPECT_THAT(rows_of(none), ElementsAre("DE_1:", "DE_2:"));
  EXPECT_THAT(none.warnings,
              ElementsAre("w/t.csv: has no rows", HasSubstr("no row for 2 objects")));
}

/// Faces of labels 7, 12 and none.
std::string labelled(const std::string& type, const std::string& last) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
         "float z\nelement face 3\nproperty list uchar int vertex_indices\nproperty " +
         type + " bone\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 7\n3 0 2 3 12\n3 0 1 3 " +
         last + "\n";
}

TEST_F(ObjectsTest, NumbersOfLabelsMayBeWrittenInOtherWays) {
  put("a.ply", labelled("int", "-3"));
  put("t.csv", "id,h\n007,1\n12.0,2\n -3,3\n");
  ImportHow how = from(ObjectSource::label, "bone");
  how.object_table = "w/t.csv";
  EXPECT_THAT(rows_of(import(how, "a.ply")), ElementsAre("-3: -", "12: 2", "7: 1"));
}

TEST_F(ObjectsTest, ALabelThatIsNoNumberIsNone) {
  put("a.ply", labelled("float", "nan"));
  ImportHow how = from(ObjectSource::label, "bone");
  how.attributes.labels = {{"bone"}};
  EXPECT_THAT(import(how, "a.ply").names_of_triangles(), ElementsAre("7", "12", ""));
}

// ---- the parts

TEST(PropertyTypesTest, NumbersAndDates) {
  EXPECT_EQ(number_of_text(" -12.5e2 "), -1250);
  EXPECT_EQ(number_of_text("0"), 0);
  EXPECT_EQ(number_of_text("0.5"), 0.5);
  for (const char* text : {"", "007", "nan", "inf", "1,5", "+3", "12 m", "12345678901234567890"})
    EXPECT_FALSE(number_of_text(text)) << text;
  for (const char* text : {"2031-05-17", "2031-05-17T08:30", "2031-05-17 08:30:59.25+02:00"})
    EXPECT_TRUE(is_date(text)) << text;
  for (const char* text : {"", "2031-13-01", "2031-5-1", "17.05.2031", "2031-05-17T", "2031-05-17Z",
                           "2031-05-17T08:30:00Zx"})
    EXPECT_FALSE(is_date(text)) << text;
}

class RowSortTest : public testing::Test {
 protected:
  std::vector<std::string> sorted(const std::vector<std::string>& keys, std::uint64_t memory) {
    storage::MemoryPool pool(0);
    storage::ScratchFile scratch(files_, "scratch", pool);
    const execution::CancelToken cancel;
    const ImportRoom room{scratch, 0, cancel};
    RowSort sort(room, memory);
    for (std::size_t i = 0; i < keys.size(); ++i)
      sort.add({keys[i], fmt::format("{}", i)});
    sort.sort();
    std::vector<std::string> rows;
    while (sort.next())
      rows.push_back(fmt::format("{} {}", sort.row().key, sort.row().bytes));
    return rows;
  }
  tests::MemoryFiles files_;
};

TEST_F(RowSortTest, EqualKeysStayInTheirOrderWhateverTheMemory) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < 40000; ++i)
    keys.push_back(i % 1000 == 999 ? std::string(9000, 'k') + std::to_string(i % 7)
                                   : std::to_string(i * 7919 % 5000));
  const std::vector<std::string> roomy = sorted(keys, std::uint64_t{1} << 30);
  EXPECT_EQ(roomy, sorted(keys, 1)) << "hundreds of runs, merged twice";
  std::vector<std::size_t> order(keys.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return keys[i]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    ASSERT_EQ(roomy[i], fmt::format("{} {}", keys[order[i]], order[i]));
  EXPECT_THAT(sorted({}, 1), IsEmpty());
  EXPECT_THAT(sorted({"b", "", "a"}, 1), ElementsAre(" 1", "a 2", "b 0"));
}

}  // namespace
}  // namespace meshhier::importing
