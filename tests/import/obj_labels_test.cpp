// Groups, objects and materials of OBJ files as labels, if one asks for them.
#include "import/import_test.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

using mesh_io::AttributeChoice;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::Imported;
using tests::ImportHow;

/// A strip of four triangles between six vertices.
constexpr const char* kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 2 0\nv 1 2 0\n";

class ObjLabelsTest : public tests::ImportTest {
 protected:
  static ImportHow asking(std::vector<std::string> names) {
    return {.attributes = {.which = AttributeChoice::Which::named, .names = std::move(names)}};
  }
  Imported import(const ImportHow& how) { return import_file("a.obj", how); }
  /// The label that all corners of each triangle have.
  static std::vector<double> of_triangles(const Imported& mesh, std::size_t attribute) {
    const std::vector<double> all = mesh.values(attribute);
    std::vector<double> found;
    for (const auto& [a, b, c] : mesh.triangles) {
      EXPECT_EQ(all[a], all[b]);
      EXPECT_EQ(all[a], all[c]);
      found.push_back(all[a]);
    }
    return found;
  }
  static std::vector<std::string> names_of(const Imported& mesh, std::size_t attribute) {
    std::vector<std::string> names;
    for (const ValueStatistics::LabelCount& one : mesh.summary.values[attribute].labels)
      names.push_back(fmt::format("{} {}", one.label, one.name));
    return names;
  }
};

TEST_F(ObjLabelsTest, TheyAreThereIfOneAsksForThem) {
  put("a.obj", std::string(kVertices) +
                   "f 1 2 3\no house\ng left wall\nf 2 4 3\nusemtl brick\nf 3 4 5\n"
                   "g roof\nf 4 6 5\n");
  const Imported mesh = import(asking({"material", "group", "object"}));
  const auto label = [](const char* name) { return ScalarAttribute{name, ValueType::u16, true}; };
  EXPECT_THAT(mesh.layout.values, ElementsAre(label("group"), label("object"), label("material")));
  EXPECT_THAT(of_triangles(mesh, 0), ElementsAre(0, 1, 1, 2));
  EXPECT_THAT(of_triangles(mesh, 1), ElementsAre(0, 1, 1, 1));
  EXPECT_THAT(of_triangles(mesh, 2), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(names_of(mesh, 0), ElementsAre("0 ", "1 left wall", "2 roof"));
  EXPECT_THAT(names_of(mesh, 2), ElementsAre("0 ", "1 brick"));
  EXPECT_EQ(mesh.count("split_vertices"), 6U);
  EXPECT_EQ(mesh.count("groups"), 2U);
  ImportHow tight = asking({"material", "group", "object"});
  tight.memory = tests::kTight;
  EXPECT_EQ(import(tight).attributes, mesh.attributes);

  EXPECT_THAT(import(asking({"object"})).layout.values, ElementsAre(label("object")));
  EXPECT_EQ(import(asking({"object"})).count("split_vertices"), 2U);
  EXPECT_THAT(import({}).layout.values, IsEmpty());
  EXPECT_THAT(import(asking({"o", "g"})).layout.values, IsEmpty());
}

TEST_F(ObjLabelsTest, WithoutStatementsThereIsNone) {
  put("a.obj", std::string(kVertices) + "g a\nf 1 2 3\n");
  const Imported mesh = import(asking({"object", "group"}));
  EXPECT_THAT(mesh.layout.values, ElementsAre(ScalarAttribute{"group", ValueType::u16, true}));
}

TEST_F(ObjLabelsTest, AnotherTimeTheNameIsTheSameLabel) {
  put("a.obj", std::string(kVertices) + "g a\nf 1 2 3\ng b\nf 2 4 3\ng a\nf 3 4 5\ng\nf 4 6 5\n");
  const Imported mesh = import(asking({"group"}));
  EXPECT_THAT(of_triangles(mesh, 0), ElementsAre(1, 2, 1, 3)) << "the last has an empty name";
  EXPECT_THAT(names_of(mesh, 0), ElementsAre("1 a", "2 b", "3 "));
}

TEST_F(ObjLabelsTest, FilesTogetherHaveTheSameNames) {
  put("a.obj", std::string(kVertices) + "o a\nf 1 2 3\no b\nf 2 4 3\n");
  put("b.obj", std::string(kVertices) + "o b\nf 1 2 3\no c\nf 2 4 3\n");
  mesh_io::InputPaths paths;
  paths.push_back("w/a.obj");
  paths.push_back("w/b.obj");
  const Imported mesh = tests::import_files(files_, paths, asking({"object"}));
  EXPECT_THAT(of_triangles(mesh, 0), ElementsAre(1, 2, 2, 3));
  EXPECT_THAT(names_of(mesh, 0), ElementsAre("0 ", "1 a", "2 b", "3 c"))
      << "0: of the vertices that no triangle has";
}

TEST_F(ObjLabelsTest, PicturesColoursAndNormalsStay) {
  put("a.png", "");
  put("a.mtl", "newmtl m\nmap_Kd a.png\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kVertices +
                   "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl m\ng a\nf 1/1/1 2/2/1 3/3/1\n"
                   "g b\nf 2/2/1 4/3/1 3/1/1\n");
  const Imported mesh = import(asking({"group"}));
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0", "a.png 1 1, 1 0, 0 1"));
  EXPECT_TRUE(mesh.layout.normals);
  EXPECT_THAT(of_triangles(mesh, 0), ElementsAre(1, 2));
}

TEST_F(ObjLabelsTest, LongNamesAreCut) {
  put("a.obj", std::string(kVertices) + "g " + std::string(300, 'x') + "\nf 1 2 3\n");
  EXPECT_LE(names_of(import(asking({"group"})), 0)[1].size(), 105U);
}

TEST_F(ObjLabelsTest, TooManyNamesAreRefused) {
  std::string text = kVertices;
  for (int i = 0; i < 65536; ++i)
    text += fmt::format("g {}\nf 1 2 3\n", i);
  put("a.obj", text);
  EXPECT_THAT(import({}).triangles, SizeIs(65536));
  EXPECT_THROW(
      try { import(asking({"group"})); } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("more than 65535 names of a label"));
        throw;
      },
      Error);
}

}  // namespace
}  // namespace meshhier::importing
