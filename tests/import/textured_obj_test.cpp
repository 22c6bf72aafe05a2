// OBJ files with material libraries and pictures.
#include "base/error.h"
#include "import/import_test.h"
#include "tests/support/memory_files.h"

#include <array>
#include <filesystem>
#include <string>
#include <utility>
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
using testing::SizeIs;
using tests::Imported;
using tests::ImportHow;

/// Four positions and texture coordinates of a square.
constexpr const char* kSquare =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

class TexturedObjTest : public tests::ImportTest {
 protected:
  void put_pictures(std::initializer_list<std::string> names) {
    for (const std::string& name : names)
      put(name, "a picture");
  }
  Imported import(const ImportHow& how = {}) { return import_of({"a.obj"}, how); }
  Imported import_of(const std::vector<std::string>& names, const ImportHow& how = {}) {
    mesh_io::InputPaths paths;
    for (const std::string& name : names)
      paths.push_back(fs::path("w") / name);
    return tests::import_files(files_, paths, how);
  }
  /// Imports a triangle of the material m, which is `definition`.
  Imported import_with(const std::string& definition) {
    put("a.mtl", "newmtl m\n" + definition + '\n');
    put("a.obj", std::string("mtllib a.mtl\nusemtl m\n") + kSquare + "f 1/1 2/2 3/3\n");
    return import();
  }
  std::string shown_with(const std::string& definition) { return import_with(definition).shown(0); }
  std::string failure() { return failure_of_file("a.obj"); }
};

TEST_F(TexturedObjTest, CornersNameTheirMaterialAndCoordinatesFromTheTop) {
  put_pictures({"a.png", "b.png"});
  put("a.mtl", "newmtl one\nmap_Kd a.png\nnewmtl two\nmap_Kd b.png\nnewmtl unused\nmap_Kd c.png\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kSquare +
                   "usemtl two\nf 1/1 2/2 3/3\nusemtl one\nf 1/1 3/3 4/4\n");
  const Imported mesh = import();
  EXPECT_EQ(mesh.layout, (AttributeLayout{.texcoords = true, .material = true}));
  EXPECT_THAT(mesh.all_shown(), ElementsAre("b.png 0 1, 1 1, 1 0", "a.png 0 1, 1 0, 0 0"));
  EXPECT_THAT(mesh.positions, SizeIs(6)) << "two lie at the border of the materials";
  ASSERT_THAT(mesh.materials.materials, SizeIs(2)) << "in the order of first use";
  EXPECT_EQ(mesh.materials.materials[0].name, "two");
  EXPECT_EQ(mesh.materials.images[0].name, "b.png");
  EXPECT_EQ(mesh.summary.textures, (SourceTextures{.materials = 2, .images = 2}));
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST_F(TexturedObjTest, WithoutAnyPictureAllIsAsIfThereWereNoMaterials) {
  const std::string faces = "usemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 3/3 4/4\n";
  put("a.obj", std::string(kSquare) + faces);
  const Imported plain = import();
  put("a.mtl", "newmtl one\nmap_Kd a.png\nnewmtl two\nmap_Kd b.png\n");
  put("a.obj", "mtllib a.mtl\n" + std::string(kSquare) + faces);
  const Imported missing = import();
  EXPECT_EQ(missing.layout, AttributeLayout{.texcoords = true});
  EXPECT_EQ(missing.attributes, plain.attributes);
  EXPECT_EQ(missing.triangles, plain.triangles);
  EXPECT_TRUE(missing.materials.empty());
  EXPECT_FALSE(missing.summary.textures);
  EXPECT_EQ(missing.count("missing_images"), 2U);
  ASSERT_THAT(missing.warnings, SizeIs(1));
  EXPECT_EQ(missing.warnings[0],
            "2 pictures of the mesh are missing (the first is a.png of w/a.mtl): "
            "the mesh is read as one without textures");
}

TEST_F(TexturedObjTest, TexturesCanBeIgnored) {
  put_pictures({"a.png"});
  import_with("map_Kd a.png");
  const Imported mesh = import({.textures = Textures::ignore});
  EXPECT_EQ(mesh.layout, AttributeLayout{.texcoords = true});
  EXPECT_THAT(mesh.all_shown(), ElementsAre("0 0, 1 0, 1 1"));
  EXPECT_TRUE(mesh.materials.empty());
}

TEST_F(TexturedObjTest, AMissingPictureShowsTheColourOfItsMaterial) {
  put_pictures({"a.png"});
  put("a.mtl", "newmtl one\nmap_Kd a.png\nnewmtl two\nKd 1 0 0.5\nmap_Kd b.png\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kSquare +
                   "usemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 3/3 4/4\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0", "#ff0080"));
  EXPECT_EQ(mesh.summary.textures,
            (SourceTextures{.materials = 2, .images = 2, .missing_images = 1}));
  ASSERT_THAT(mesh.warnings, SizeIs(1));
  EXPECT_EQ(mesh.warnings[0],
            "1 picture of the mesh is missing (b.png of w/a.mtl): triangles show "
            "the colour of their material instead");
}

TEST_F(TexturedObjTest, LibrariesAndPicturesBelongToTheInput) {
  put_pictures({"a.png", "tex/b.png"});
  put("a.mtl",
      "newmtl one\nmap_Kd a.png\nnewmtl two\nmap_Kd tex\\b.png\nnewmtl three\n"
      "map_Kd C:\\x\\c.png\nnewmtl unused\nmap_Kd d.png\n");
  put("a.obj", std::string("mtllib a.mtl other.mtl\n") + kSquare +
                   "usemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 3/3 4/4\n"
                   "usemtl three\nf 1/1 3/3 4/4\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.companions(),
              ElementsAre("w/a.mtl", "w/a.png", "w/tex/b.png", "no w/a.mtl other.mtl",
                          "no w/other.mtl", "no w/C:/x/c.png", "no w/c.png"));
  const std::vector<SourceFile>& files = mesh.summary.files;
  ASSERT_THAT(files, SizeIs(3));
  EXPECT_EQ(files[0].name, "a.obj");
  EXPECT_EQ(files[1].name + ", " + files[1].format, "a.mtl, material library");
  EXPECT_EQ(files[2].name + ", " + files[2].format, "a.png and 1 more, picture");
  EXPECT_EQ(files[2].bytes, 2 * std::string("a picture").size());
  put("tex/b.png", "b picture");
  EXPECT_EQ(import().summary.files[1].checksum, files[1].checksum);
  EXPECT_NE(import().summary.files[2].checksum, files[2].checksum);
  EXPECT_NE(import().summary.checksum, mesh.summary.checksum);
  EXPECT_THAT(import({.textures = Textures::ignore}).companions(), IsEmpty());
}

TEST_F(TexturedObjTest, FacesWithoutCoordinatesShowTheColour) {
  put_pictures({"a.png"});
  put("a.mtl", "newmtl m\nKd 0 1 0\nmap_Kd a.png\n");
  put("a.obj", std::string("mtllib a.mtl\nusemtl m\n") + kSquare +
                   "f 1/1 2/2 3/3\nf 1 3 4\nf 1/1 2/2 4\nv 9 9 9\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0", "#00ff00", "#00ff00"));
  ASSERT_THAT(mesh.materials.materials, SizeIs(2));
  EXPECT_EQ(mesh.positions.back(), (Vec3d{9, 9, 9}));
  EXPECT_EQ(mesh.attributes.back(), 0.0F) << "a vertex of no triangle has a material, too";
}

TEST_F(TexturedObjTest, MaterialsThatNobodyDefinesAreWhite) {
  put_pictures({"a.png"});
  put("a.mtl", "newmtl m\nmap_Kd a.png\n");
  put("a.obj", std::string("mtllib a.mtl\nmtllib gone.mtl\n") + kSquare +
                   "f 1/1 2/2 4/4\nusemtl nobody\nf 1/1 2/2 3/3\nusemtl m\nf 1/1 3/3 4/4\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.all_shown(), ElementsAre("#ffffff", "#ffffff", "a.png 0 1, 1 0, 0 0"));
  EXPECT_EQ(mesh.count("undefined_materials"), 1U);
  EXPECT_EQ(mesh.count("missing_material_libraries"), 1U);
}

TEST_F(TexturedObjTest, AMaterialIsFoundThoughItsNameHasOtherCases) {
  put_pictures({"a.png", "b.png"});
  const std::string faces = std::string(kSquare) + "usemtl Wall\nf 1/1 2/2 3/3\n";
  put("a.obj", "mtllib a.mtl\n" + faces);
  for (const char* name : {"wall", "WALL", "wAll"}) {
    put("a.mtl", std::string("newmtl ") + name + "\nmap_Kd a.png\nnewmtl other\nmap_Kd b.png\n");
    EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0")) << name;
  }
  put("a.mtl", "newmtl wall\nmap_Kd b.png\nnewmtl Wall\nmap_Kd a.png\n");
  EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0")) << "as it is written";
  put("a.mtl", "newmtl wall\nmap_Kd b.png\nnewmtl WALL\nmap_Kd a.png\n");
  const Imported unclear = import();
  EXPECT_FALSE(unclear.layout.material);
  ASSERT_THAT(unclear.warnings, SizeIs(1));
  EXPECT_THAT(unclear.warnings[0], HasSubstr("defines 1 material of the mesh (Wall of w/a.obj)"));
}

TEST_F(TexturedObjTest, TheLibraryOfTheMeshsNameIsFoundThoughNobodyNamesIt) {
  put_pictures({"a.png"});
  put("a.mtl", "newmtl m\nmap_Kd a.png\n");
  const std::string faces = std::string(kSquare) + "usemtl m\nf 1/1 2/2 3/3\n";
  for (const char* start : {"", "mtllib gone.mtl\n", "mtllib empty.mtl\n"}) {
    put("empty.mtl", "# nothing\n");
    put("a.obj", start + faces);
    const Imported mesh = import();
    EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0")) << start;
    EXPECT_THAT(mesh.warnings, IsEmpty()) << start;
  }
  put("other.mtl", "newmtl m\nmap_Kd none.png\n");
  put("a.obj", "mtllib other.mtl\n" + faces);
  EXPECT_FALSE(import().layout.material) << "what is defined stays so";
  put("b.obj", faces);
  const Imported mesh = tests::import_files(files_, fs::path("w/b.obj"));
  EXPECT_FALSE(mesh.layout.material);
  ASSERT_THAT(mesh.warnings, SizeIs(1));
  EXPECT_THAT(mesh.warnings[0], HasSubstr("put it beside the mesh under the mesh's name"));
  EXPECT_THAT(mesh.companions(), ElementsAre("no w/b.mtl"));
}

TEST_F(TexturedObjTest, TheOnlyMaterialIsThatOfFacesWithoutAny) {
  put_pictures({"a.png"});
  const std::string faces = std::string(kSquare) + "f 1/1 2/2 3/3\n";
  put("a.obj", "mtllib a.mtl\n" + faces);
  put("a.mtl", "newmtl m\nmap_Kd a.png\n");
  EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0"));
  put("a.mtl", "newmtl m\nmap_Kd a.png\nnewmtl m\nmap_Kd b.png\n");
  EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0")) << "one name";
  put("a.mtl", "newmtl m\nmap_Kd a.png\nnewmtl n\nmap_Kd a.png\n");
  const Imported unclear = import();
  EXPECT_FALSE(unclear.layout.material);
  ASSERT_THAT(unclear.warnings, SizeIs(1));
  EXPECT_THAT(unclear.warnings[0], HasSubstr("w/a.obj names libraries with several materials"));
  put("a.mtl", "newmtl m\nKd 1 0 0\n");
  put("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  const Imported red = import();
  EXPECT_EQ(red.layout.colour, ColourType::u8);
  EXPECT_EQ(red.attributes[0], 255);
  EXPECT_EQ(red.attributes[1], 0);
}

TEST_F(TexturedObjTest, LibrariesMayBeInUtf16) {
  put_pictures({"a.png"});
  const std::string name = "W\xc3\xa4nde \xf0\x9f\xa7\xb1";  // a letter of two bytes, a brick
  put("a.obj", "mtllib a.mtl\n" + std::string(kSquare) + "usemtl " + name + "\nf 1/1 2/2 3/3\n");
  const std::u16string text = u"newmtl W\u00e4nde \U0001F9F1\r\nmap_Kd a.png\r\n";
  for (const bool is_big : {false, true}) {
    std::string bytes = is_big ? "\xfe\xff" : "\xff\xfe";
    for (const char16_t unit : text) {
      const std::array halves{static_cast<char>(unit >> 8), static_cast<char>(unit & 255)};
      bytes += is_big ? halves[0] : halves[1];
      bytes += is_big ? halves[1] : halves[0];
    }
    put("a.mtl", bytes);
    EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0")) << is_big;
    put("a.mtl", bytes + "x");
    EXPECT_THAT(failure(), HasSubstr("a.mtl: is a text in UTF-16, but ends within a character"));
  }
  put("a.mtl", std::string("\xff\xfe\x00\xd8n\x00", 6));  // half a character
  EXPECT_FALSE(import().layout.material);
}

TEST_F(TexturedObjTest, OtherMapsAreThePictureWhereNoneIsNamed) {
  put_pictures({"a.png", "b.png", "c.png"});
  put("a.obj", "mtllib a.mtl\n" + std::string(kSquare) + "usemtl m\nf 1/1 2/2 3/3\n");
  const std::vector<std::pair<const char*, const char*>> cases{
      {"map_Ke a.png", "a.png"},
      {"map_Ka b.png", "b.png"},
      {"map_Ka b.png\nmap_Ke a.png", "a.png"},
      {"map_Ke a.png\nmap_Ka b.png\nmap_Kd c.png", "c.png"},
      {"MAP_KE -clamp on a.png\nKe 1 1 1\nKd 0 0 0", "a.png"}};
  for (const auto& [maps, picture] : cases) {
    put("a.mtl", std::string("newmtl m\n") + maps + "\n");
    EXPECT_THAT(import().all_shown(), ElementsAre(HasSubstr(picture))) << maps;
  }
}

TEST_F(TexturedObjTest, PolypaintOfZBrushIsColoursOfVertices) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const auto colours_of = [&](const std::string& text) {
    put("a.obj", text);
    return import();
  };
  for (const char* paint : {"#MRGB ffc05028ff00ff0000000000ffffffff\n",
                            "#MRGB ffc05028ff00ff00\n#MRGB 00000000FFFFFFFF\n",
                            "#MRGB ffc05028ff00ff0000000000ffffffff\r\n# End of MRGB block\n",
                            "# Auto scale\n#MRGB ffc05028ff00ff0000000000\n#MRGB ffffffff"}) {
    for (const std::string& text : {square + paint, "g x\n" + square + paint}) {
      const Imported mesh = colours_of(text);
      ASSERT_EQ(mesh.layout, AttributeLayout{.colour = ColourType::f32}) << paint;
      EXPECT_EQ(mesh.attributes, (std::vector<float>{0xc0 / 255.0F, 0x50 / 255.0F, 0x28 / 255.0F, 0,
                                                     1, 0, 0, 0, 0, 1, 1, 1}));
    }
  }
  for (const char* paint : {"#MRGB ffc05028\n", "#MRGB zzzzzzzz\n", "#MRGB\n", "#MRGBffffffff\n"}) {
    const Imported mesh = colours_of(square + paint);
    EXPECT_EQ(mesh.layout, AttributeLayout{}) << paint;
    EXPECT_EQ(mesh.count("ignored_polypaint"), std::string(paint) == "#MRGB ffc05028\n" ? 1U : 0U);
  }
  const Imported own = colours_of(
      "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nf 1 2 3\n#MRGB 000000000000000000000000\n");
  EXPECT_EQ(own.attributes[0], 1) << "colours of v are what all programs read";
}

TEST_F(TexturedObjTest, LibrariesAreNamedInManyWays) {
  put_pictures({"a.png"});
  const std::string mtl = "newmtl m\nmap_Kd a.png\n";
  const auto shows = [&](const std::string& statement) {
    put("a.obj", statement + "\nusemtl m\n" + kSquare + "f 1/1 2/2 3/3\n");
    return import().layout.material;
  };
  put("with space.mtl", mtl);
  EXPECT_TRUE(shows("mtllib with space.mtl"));
  put("b.mtl", mtl);
  EXPECT_TRUE(shows("mtllib x.mtl b.mtl"));
  EXPECT_TRUE(shows("mtllib B.MTL"));
  EXPECT_TRUE(shows("mtllib b.mtl # comment"));
  EXPECT_TRUE(shows("mtllib \\\n b.mtl\r"));
  EXPECT_FALSE(shows("mtllib c.mtl"));
  put("sub/c.mtl", "newmtl m\nmap_Kd ..\\a.png\n");
  EXPECT_TRUE(shows("mtllib sub\\c.mtl"));
  EXPECT_TRUE(shows("mtllib .\\sub\\\\c.mtl"));
  EXPECT_TRUE(shows("\xEF\xBB\xBFmtllib Sub/C.Mtl"));
}

TEST_F(TexturedObjTest, TheFirstDefinitionCountsAndStatementsMayComeLater) {
  put_pictures({"a.png", "b.png"});
  put("a.mtl", "newmtl m\nmap_Kd a.png\nnewmtl m\nmap_Kd b.png\n");
  put("b.mtl", "newmtl m\nmap_Kd b.png\n");
  put("a.obj", std::string("usemtl m\n") + kSquare + "f 1/1 2/2 3/3\nmtllib a.mtl b.mtl\n");
  EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0"));
}

TEST_F(TexturedObjTest, NamesOfMaterialsMayHaveSpacesAndBeEmpty) {
  put_pictures({"a.png", "b.png", "c.png"});
  put("a.mtl",
      "newmtl  red wall #1 \r\nmap_Kd a.png\r\nnewmtl\r\nmap_Kd b.png\r\n"
      "newmtl plain\nmap_Kd c.png\n");
  put("a.obj", std::string("mtllib a.mtl\r\n") + kSquare +
                   "usemtl red wall #1\t\nf 1/1 2/2 3/3\nusemtl\nf 1/1 2/2 3/3\n"
                   "usemtl plain # it is\nf 1/1 2/2 3/3\n");
  EXPECT_THAT(import().all_shown(),
              ElementsAre("a.png 0 1, 1 1, 1 0", "b.png 0 1, 1 1, 1 0", "c.png 0 1, 1 1, 1 0"));
}

TEST_F(TexturedObjTest, PicturesAreFoundAsTheyWereMeant) {
  put_pictures({"a b.png", "sub/Deep/c.png", "Twice.png", "twice.PNG", "d.png"});
  const auto finds = [&](const std::string& name) {
    return import_with("map_Kd " + name).layout.material;
  };
  EXPECT_TRUE(finds("a b.png"));
  EXPECT_TRUE(finds("\"a b.png\""));
  EXPECT_TRUE(finds("a b.png  # the wall"));
  EXPECT_TRUE(finds("A B.PNG"));
  EXPECT_TRUE(finds("sub\\Deep\\c.png"));
  EXPECT_TRUE(finds("./SUB//deep/./C.png"));
  EXPECT_TRUE(finds("sub/../d.png"));
  EXPECT_TRUE(finds("C:\\maps\\d.png")) << "by its last part";
  EXPECT_TRUE(finds("/home/else/d.png"));
  EXPECT_TRUE(finds("gone/d.png"));
  EXPECT_TRUE(finds("Twice.png"));
  EXPECT_FALSE(finds("TWICE.png")) << "two could be meant";
  EXPECT_FALSE(finds("sub")) << "a folder";
  EXPECT_FALSE(finds("b.png"));
  EXPECT_FALSE(finds(std::string(3000, 'x')));
}

TEST_F(TexturedObjTest, OptionsOfMapsAreUnderstood) {
  put_pictures({"a.png", "1 2.png"});
  EXPECT_EQ(shown_with("map_Kd -o 0.5 0.25 -s 2 4 1 a.png"), "a.png 0.5 0.75, 2.5 0.75, 2.5 -3.25");
  EXPECT_EQ(shown_with("map_Kd -s 2 a.png"), "a.png 0 1, 2 1, 2 0");
  EXPECT_EQ(shown_with("map_kd -blendu on -blendv off -mm 0 1 -t 1 1 -bm 0.5 -cc on -boost 1 "
                       "-texres 9 -imfchan l -type sphere 1 2.png"),
            "1 2.png 0 1, 1 1, 1 0");
  EXPECT_EQ(shown_with("map_Kd -o 1 1 1 1 2.png"), "1 2.png 1 0, 2 0, 2 -1");
  EXPECT_EQ(import_with("map_Kd a.png").materials.materials[0].wrap_u, Wrap::repeat);
  const Imported clamped = import_with("map_Kd -clamp on a.png");
  EXPECT_EQ(clamped.materials.materials[0].wrap_u, Wrap::clamp);
  EXPECT_EQ(clamped.materials.materials[0].wrap_v, Wrap::clamp);
  EXPECT_EQ(import_with("map_Kd -clamp off a.png").materials.materials[0].wrap_v, Wrap::repeat);
}

TEST_F(TexturedObjTest, AlphaComesFromTheOpacityOrThePicture) {
  put_pictures({"a.png", "b.png"});
  const auto alpha = [&](const std::string& definition) {
    return import_with("map_Kd a.png\n" + definition).materials.materials.at(0).alpha;
  };
  EXPECT_EQ(alpha(""), AlphaMode::opaque);
  EXPECT_EQ(alpha("d 1\nTr 0"), AlphaMode::opaque);
  EXPECT_EQ(alpha("d 0.5"), AlphaMode::blend);
  EXPECT_EQ(alpha("Tr 0.25"), AlphaMode::blend);
  EXPECT_EQ(alpha("d 1\nTr 1"), AlphaMode::opaque) << "d counts";
  EXPECT_EQ(alpha("map_d a.png"), AlphaMode::mask);
  EXPECT_EQ(alpha("map_d b.png"), AlphaMode::opaque);
  EXPECT_EQ(import_with("map_Kd a.png\nmap_d b.png").count("ignored_alpha_images"), 1U);
}

TEST_F(TexturedObjTest, TheOpacityIsThatOfThePictureToo) {
  put_pictures({"a.png"});
  const images::Material half = import_with("map_Kd a.png\nd 0.5").materials.materials.at(0);
  EXPECT_THAT(half.factor, ElementsAre(1, 1, 1, 0.5F));
}

TEST_F(TexturedObjTest, WhatBlendsBesideOthersBecomesAMask) {
  put_pictures({"a.png"});
  const auto import_pair = [&](const std::string& one, const std::string& two) {
    put("a.mtl", "newmtl one\nmap_Kd a.png\n" + one + "\nnewmtl two\n" + two + '\n');
    put("a.obj", std::string("mtllib a.mtl\nusemtl one\n") + kSquare +
                     "f 1/1 2/2 3/3\nusemtl two\nf 1/1 3/3 4/4\n");
    return import();
  };
  const Imported mixed = import_pair("d 0.5", "map_Kd a.png");
  EXPECT_EQ(mixed.materials.materials.at(0).alpha, AlphaMode::mask);
  EXPECT_EQ(mixed.materials.materials.at(0).alpha_cutoff, 0.25F);
  EXPECT_EQ(mixed.materials.materials.at(1).alpha, AlphaMode::opaque);
  EXPECT_EQ(mixed.count("masked_materials"), 1U);
  const Imported plain = import_pair("", "d 0.125");
  EXPECT_EQ(plain.materials.materials.at(1).alpha, AlphaMode::mask);
  EXPECT_EQ(plain.materials.materials.at(1).alpha_cutoff, 0.0625F) << "of a material's colour";
  const Imported clear = import_pair("", "d 0");
  EXPECT_EQ(clear.materials.materials.at(1).alpha_cutoff, 0.5F) << "nothing of it is visible";
  const Imported both = import_pair("d 0.5", "d 0.25");
  EXPECT_EQ(both.materials.materials.at(0).alpha, AlphaMode::blend);
  EXPECT_EQ(both.materials.materials.at(1).alpha, AlphaMode::blend);
  EXPECT_EQ(both.count("masked_materials"), 0U);
}

TEST_F(TexturedObjTest, TheColourIsKeptForAPictureThatProvesBroken) {
  put_pictures({"a.png"});
  const images::Material red = import_with("map_Kd a.png\nKd 1 0 0").materials.materials.at(0);
  EXPECT_TRUE(red.image);
  EXPECT_THAT(red.colour, ElementsAre(1, 0, 0, 1));
}

TEST_F(TexturedObjTest, EachSquareOfCoordinatesMayHaveItsPicture) {
  put_pictures({"t.1001.png", "t.1012.png"});
  put("a.mtl", "newmtl m\nKd 0 0 1\nmap_Kd t.<UDIM>.png\n");
  put("a.obj",
      "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
      "vt 1.25 1\nvt 2 1\nvt 1.5 1.5\nvt 5 5\nvt -1 0\n"
      "f 1/1 2/2 3/3\nf 1/4 2/5 3/6\nf 1/7 2/7 3/7\nf 1/8 2/2 3/3\nf 1 2 3\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.all_shown(),
              ElementsAre("t.1001.png 0 1, 1 1, 0 0", "t.1012.png 0.25 1, 1 1, 0.5 0.5", "#0000ff",
                          "t.1001.png -1 1, 1 1, 0 0", "#0000ff"));
  EXPECT_EQ(mesh.count("missing_images"), 1U);
  EXPECT_THAT(mesh.warnings[0], HasSubstr("t.1056.png"));
  EXPECT_EQ(import({.memory = tests::kTight}).attributes, mesh.attributes);
}

TEST_F(TexturedObjTest, CornersBesideASquareMayBeRounded) {
  put_pictures({"t.1001.png", "t.1002.png"});
  put("a.mtl", "newmtl m\nmap_Kd t.<UDIM>.png\n");
  put("a.obj",
      "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt -1e-7 -1e-7\nvt 1 0\nvt 0 1\n"
      "vt 0.9999999 0\nvt 2 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/4 2/5 3/6\n");
  const Imported mesh = import();
  EXPECT_EQ(mesh.count("missing_images"), 0U);
  ASSERT_THAT(mesh.all_shown(), SizeIs(2));
  EXPECT_THAT(mesh.all_shown()[0], HasSubstr("t.1001.png"));
  EXPECT_THAT(mesh.all_shown()[1], HasSubstr("t.1002.png"));
}

TEST_F(TexturedObjTest, SeveralFilesShareTheNumbers) {
  put_pictures({"a.png", "b.png"});
  for (const std::string name : {"a", "b"}) {
    put(name + ".mtl", "newmtl m\nmap_Kd " + name + ".png\nnewmtl also\nmap_Kd a.png\n");
    put(name + ".obj", "mtllib " + name + ".mtl\nusemtl m\n" + kSquare +
                           "f 1/1 2/2 3/3\nusemtl also\nf 1/1 3/3 4/4\n");
  }
  const Imported mesh = import_of({"a.obj", "b.obj"});
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0", "a.png 0 1, 1 0, 0 0",
                                            "b.png 0 1, 1 1, 1 0", "a.png 0 1, 1 0, 0 0"));
  EXPECT_THAT(mesh.materials.materials, SizeIs(4));
  EXPECT_THAT(mesh.materials.images, SizeIs(2)) << "a file is one picture";
}

TEST_F(TexturedObjTest, UntexturedFilesOfAListShowTheirColoursOrAreWhite) {
  put_pictures({"a.png"});
  put("a.mtl", "newmtl m\nmap_Kd a.png\nnewmtl red\nKd 1 0 0\n");
  put("a.obj", std::string("mtllib a.mtl\nusemtl m\n") + kSquare + "f 1/1 2/2 3/3\n");
  put("red.obj", std::string("mtllib a.mtl\nusemtl red\n") + kSquare + "f 1/1 2/2 3/3\n");
  put("bare.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  put("normals.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  const std::string textured = "a.png 0 1, 1 1, 1 0";
  Imported mesh = import_of({"bare.obj", "a.obj", "red.obj"});
  EXPECT_THAT(mesh.all_shown(), ElementsAre("#ffffff", textured, "#ff0000"));
  EXPECT_EQ(mesh.count("untextured_files"), 2U);
  EXPECT_THAT(mesh.materials.materials, SizeIs(3));
  mesh = import_of({"a.obj", "bare.obj"}, {.memory = tests::kTight});
  EXPECT_THAT(mesh.all_shown(), ElementsAre(textured, "#ffffff"));
  EXPECT_EQ(mesh.positions.size(), 4U + 3U);
  mesh = import_of({"bare.obj", "a.obj", "bare.obj"}, {.weld = true});
  EXPECT_THAT(mesh.all_shown(), ElementsAre("#ffffff", textured, "#ffffff"));
  mesh = import_of({"a.obj", "normals.obj"});
  EXPECT_THAT(mesh.all_shown(), ElementsAre(textured, "#ffffff"));
  EXPECT_EQ(mesh.count("dropped_normals"), 3U);
  mesh = import_of({"bare.obj", "red.obj"});
  EXPECT_EQ(mesh.layout.texcoords, false);
  EXPECT_EQ(mesh.count("dropped_texcoords"), 4U);
}

TEST_F(TexturedObjTest, ResultsDoNotDependOnTheMemory) {
  put_pictures({"0.png", "1.png", "2.png"});
  std::string mtl, obj = "mtllib a.mtl\n";
  for (int i = 0; i < 4; ++i)
    mtl += fmt::format("newmtl m{}\nKd 0.{} 0 0\nmap_Kd {}.png\n", i, i, i);
  put("a.mtl", mtl);
  for (int i = 0; i < 3000; ++i)
    obj += fmt::format("v {} {} {}\nvt 0.{} 0.{}\nvn 0 {} 1\n", i, i % 7, i % 11, i, i % 13, i);
  for (int i = 0; i < 20'000; ++i) {
    if (i % 100 == 0)
      obj += fmt::format("usemtl m{}\n", i / 100 % 5);
    const int a = i * 7 % 2998 + 1;
    obj += fmt::format("f {0}/{3}/{0} {1}/{0}/{1} {2}/{1}/{2}\n", a, a + 1, a + 2, i % 3000 + 1);
  }
  put("a.obj", obj);
  const Imported roomy = import();
  const Imported tight = import({.memory = tests::kTight});
  EXPECT_EQ(roomy.attributes, tight.attributes);
  EXPECT_EQ(roomy.triangles, tight.triangles);
  EXPECT_EQ(roomy.materials, tight.materials);
  EXPECT_THAT(import({.weld = true}).materials.materials, SizeIs(5));
}

TEST_F(TexturedObjTest, FailuresNameFileAndLine) {
  put_pictures({"a.png"});
  put("a.obj", std::string("mtllib a.mtl\nusemtl m\n") + kSquare + "f 1/1 2/2 3/3\n");
  const auto failure_of = [&](const std::string& line) {
    put("a.mtl", "newmtl m\n" + line);
    return failure();
  };
  EXPECT_EQ(failure_of("Kd 1 x 0\n"),
            "w/a.mtl: line 2: expected a finite number for a colour, found 'x'");
  EXPECT_EQ(failure_of("Kd\n"), "w/a.mtl: line 2: expected a finite number for a colour, found ''");
  EXPECT_EQ(failure_of("Kd 1 2\n"),
            "w/a.mtl: line 2: expected a finite number for a colour, found ''");
  EXPECT_EQ(failure_of("\nd nan\n"),
            "w/a.mtl: line 3: expected a finite number for an opacity, found 'nan'");
  EXPECT_EQ(failure_of("Tr inf\n"),
            "w/a.mtl: line 2: expected a finite number for a transparency, found 'inf'");
  EXPECT_THAT(failure_of("map_Kd -s x.png\n"), HasSubstr("w/a.mtl: line 2: expected numbers"));
  EXPECT_THAT(failure_of("map_Kd " + std::string(5000, 'x')), HasSubstr("more than 4096 bytes"));
  EXPECT_EQ(failure_of("Kd 1e300 -2 0.5\nnonsense\nmap_Kd\nPr 0.5"), "");
}

}  // namespace
}  // namespace meshhier::importing
