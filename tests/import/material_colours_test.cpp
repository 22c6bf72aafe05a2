// Materials without pictures: their colours are those of the vertices.
#include "base/error.h"
#include "import/imported.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/memory_files.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::GltfBuilder;
using tests::GltfJson;
using tests::Imported;
using tests::ImportHow;

constexpr AttributeLayout kColoured{.colour = ColourType::u8};
constexpr const char* kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
constexpr const char* kRedAndBlue = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 0.5\n";

class MaterialColoursTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) {
    files_.put(fs::path("w") / name, content);
  }
  Imported import_of(const std::vector<std::string>& names, const ImportHow& how = {}) {
    mesh_io::InputPaths paths;
    for (const std::string& name : names)
      paths.push_back(fs::path("w") / name);
    return tests::import_files(files_, paths, how);
  }
  /// A square, one triangle of each material.
  Imported import_square(const std::string& library, const ImportHow& how = {}) {
    put("a.mtl", library);
    put("a.obj",
        std::string("mtllib a.mtl\n") + kCorners + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n");
    return import_of({"a.obj"}, how);
  }

  tests::MemoryFiles files_;
};

/// Returns the colour of each corner of a triangle, "255 0 0".
std::vector<std::string> corner_colours(const Imported& mesh, std::size_t triangle) {
  std::vector<std::string> colours;
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    const float* c = mesh.attributes.data() +
                     vertex * static_cast<std::size_t>(mesh.layout.channels()) +
                     mesh.layout.part(AttributeKind::colours).first;
    colours.push_back(fmt::format("{} {} {}", c[0], c[1], c[2]));
  }
  return colours;
}

// ---- OBJ -----------------------------------------------------------------------------------

TEST_F(MaterialColoursTest, VerticesAtABorderHaveBothColours) {
  const Imported mesh = import_square(kRedAndBlue);
  EXPECT_EQ(mesh.layout, kColoured);
  EXPECT_THAT(mesh.positions, SizeIs(6));
  EXPECT_THAT(corner_colours(mesh, 0), Each("255 0 0"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 0 128"));
  EXPECT_EQ(mesh.count("material_colours"), 2U);
  EXPECT_EQ(mesh.count("split_vertices"), 2U);
  EXPECT_THAT(mesh.companions(), ElementsAre("w/a.mtl"));
  EXPECT_TRUE(mesh.materials.empty());
  EXPECT_FALSE(mesh.summary.textures);
}

TEST_F(MaterialColoursTest, ANameMeansTheLastLibraryBeforeIt) {
  put("a.mtl", "newmtl m\nKd 1 0 0\nnewmtl own\nKd 0.5 0 0\n");
  put("b.mtl", "newmtl m\nKd 0 0 1\nnewmtl late\nKd 0 1 0\n");
  put("a.obj", std::string("usemtl m\n") + kCorners +
                   "f 1 2 3\nmtllib a.mtl\nusemtl m\nf 1 2 3\nusemtl late\nf 1 2 3\n"
                   "mtllib b.mtl\nusemtl m\nf 1 2 3\nusemtl own\nf 1 2 3\n"
                   "mtllib a.mtl\nusemtl m\nf 1 2 3\n");
  const Imported mesh = import_of({"a.obj"});
  std::vector<std::string> colours;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    colours.push_back(corner_colours(mesh, i)[0]);
  EXPECT_THAT(colours,
              ElementsAre("255 0 0", "255 0 0", "0 255 0", "0 0 255", "128 0 0", "255 0 0"));
  EXPECT_EQ(mesh.count("undefined_materials"), 0U);
}

TEST_F(MaterialColoursTest, ColoursUpTo255AreBytesAndTold) {
  const Imported mesh = import_square("newmtl red\nKd 200 40 41\nnewmtl blue\nKd 1 0 40\n");
  EXPECT_THAT(corner_colours(mesh, 0), Each("200 40 41"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("1 0 40"));
  EXPECT_EQ(mesh.count("libraries_with_colours_of_bytes"), 1U);
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("whole numbers up to 255")));
  EXPECT_THAT(import_square("newmtl red\nKd 1.5 0 0\nnewmtl blue\nKd 0 0 1\n").warnings, IsEmpty());
}

TEST_F(MaterialColoursTest, MaterialsOfOneColourSplitNothing) {
  const Imported mesh = import_square("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 1 0 0\n");
  EXPECT_EQ(mesh.layout, kColoured);
  EXPECT_THAT(mesh.positions, SizeIs(4));
  EXPECT_EQ(mesh.count("material_colours"), 1U);
}

TEST_F(MaterialColoursTest, OneShadeOfGreyIsNoColour) {
  for (const char* grey : {"0.8 0.8 0.8", "1 1 1", "0"}) {
    const Imported mesh =
        import_square(fmt::format("newmtl red\nKd {0}\nnewmtl blue\nKd {0}\n", grey));
    EXPECT_EQ(mesh.layout, AttributeLayout());
    EXPECT_THAT(mesh.positions, SizeIs(4));
  }
  EXPECT_EQ(import_square("newmtl red\nKd 0.8 0.8 0.8\nnewmtl blue\nKd 0.2 0.2 0.2\n").layout,
            kColoured)
      << "two shades are";
}

TEST_F(MaterialColoursTest, TrianglesWithoutAMaterialAreWhite) {
  put("a.mtl", kRedAndBlue);
  put("a.obj", std::string("mtllib a.mtl\n") + kCorners +
                   "v 9 9 9\nf 1 2 3\nusemtl red\nf 1 3 4\nusemtl none\nf 2 3 4\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_THAT(corner_colours(mesh, 0), Each("255 255 255"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("255 0 0"));
  EXPECT_THAT(corner_colours(mesh, 2), Each("255 255 255"));
  EXPECT_EQ(mesh.count("undefined_materials"), 1U);
  EXPECT_EQ(mesh.positions.back(), (Vec3d{9, 9, 9}));
  EXPECT_EQ(mesh.attributes.back(), 255) << "a vertex of no triangle has a colour, too";
}

TEST_F(MaterialColoursTest, OtherAttributesStay) {
  put("a.mtl", kRedAndBlue);
  put("a.obj", std::string("mtllib a.mtl\n") + kCorners +
                   "vt 0.25 0.5\nvn 0 0 1\nusemtl red\nf 1/1/1 2/1/1 3/1/1\n"
                   "usemtl blue\nf 1/1/1 3/1/1 4/1/1\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_EQ(mesh.layout,
            (AttributeLayout{.normals = true, .colour = ColourType::u8, .texcoords = true}));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 0 128"));
  EXPECT_THAT(std::vector(mesh.attributes.begin(), mesh.attributes.begin() + 8),
              ElementsAre(0, 0, 1, 0, 0, 128, 0.25F, 0.5F));
}

TEST_F(MaterialColoursTest, ColoursOfVerticesComeFirst) {
  put("a.mtl", kRedAndBlue);
  put("a.obj", "mtllib a.mtl\nv 0 0 0 0 1 0\nv 1 0 0 0 1 0\nv 1 1 0 0 1 0\nusemtl red\nf 1 2 3\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_EQ(mesh.layout, AttributeLayout{.colour = ColourType::f32});
  EXPECT_THAT(corner_colours(mesh, 0), Each("0 1 0"));
  EXPECT_THAT(mesh.companions(), IsEmpty()) << "nobody needs the library";
}

TEST_F(MaterialColoursTest, CanBeIgnored) {
  const Imported mesh = import_square(kRedAndBlue, {.textures = Textures::ignore});
  EXPECT_EQ(mesh.layout, AttributeLayout());
  EXPECT_THAT(mesh.companions(), IsEmpty());
}

TEST_F(MaterialColoursTest, AMissingLibraryLeavesThePlainMesh) {
  put("a.obj", std::string("mtllib a.mtl\n") + kCorners + "usemtl red\nf 1 2 3\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_EQ(mesh.layout, AttributeLayout());
  EXPECT_EQ(mesh.count("missing_material_libraries"), 1U);
  EXPECT_THAT(mesh.companions(), ElementsAre("no w/a.mtl"));
  ASSERT_THAT(mesh.warnings, SizeIs(1));
  EXPECT_EQ(
      mesh.warnings[0],
      "1 material library of the mesh is missing (a.mtl of w/a.obj): the colours and pictures "
      "of its materials are not shown");
}

TEST_F(MaterialColoursTest, NamesOfSeveralLibrariesMayHaveSpaces) {
  put("my red one.mtl", "newmtl red\nKd 1 0 0\n");
  put("my  blue.mtl", "newmtl blue\nKd 0 0 1\n");
  put("b.mtl", "newmtl green\nKd 0 1 0\n");
  put("a.obj", std::string("mtllib b.mtl my red one.mtl none my  blue.mtl\n") + kCorners +
                   "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl green\nf 2 3 4\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_EQ(mesh.count("material_colours"), 3U);
  EXPECT_EQ(mesh.count("missing_material_libraries"), 1U);
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 0 255"));
}

TEST_F(MaterialColoursTest, ALibraryThatNobodyNeedsMayBeMissing) {
  put("a.mtl", kRedAndBlue);
  put("a.obj", std::string("mtllib a.mtl other.mtl\n") + kCorners + "usemtl red\nf 1 2 3\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_EQ(mesh.count("missing_material_libraries"), 1U);
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST_F(MaterialColoursTest, ResultsDoNotDependOnTheMemory) {
  std::string library, mesh = "mtllib a.mtl\n";
  for (int i = 0; i < 9; ++i)
    library += fmt::format("newmtl m{0}\nKd 0.{0} 0 0.5\n", i);
  put("a.mtl", library);
  for (int i = 0; i < 3000; ++i)
    mesh += fmt::format("v {} {} {}\nvn 0 {} 1\n", i, i % 7, i % 11, i);
  for (int i = 0; i < 20'000; ++i) {
    if (i % 100 == 0)
      mesh += fmt::format("usemtl m{}\n", i / 100 % 9);
    const int a = i * 7 % 2998 + 1;
    mesh += fmt::format("f {0}//{0} {1}//{0} {2}//{1}\n", a, a + 1, a + 2);
  }
  put("a.obj", mesh);
  const Imported roomy = import_of({"a.obj"});
  const Imported tight = import_of({"a.obj"}, {.memory = tests::kTight});
  EXPECT_EQ(roomy.attributes, tight.attributes);
  EXPECT_EQ(roomy.triangles, tight.triangles);
  EXPECT_EQ(roomy.count("material_colours"), 9U);
}

// ---- beside colours of vertices ------------------------------------------------------------

constexpr const char* kOwnColours = "v 0 0 0 0 1 0\nv 1 0 0 0 1 0\nv 1 1 0 0 1 0\n";

TEST_F(MaterialColoursTest, ObjectsWithoutColoursOfVerticesShowTheirMaterials) {
  put("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kOwnColours +
                   "usemtl red\nf 1 2 3\nv 0 0 1\nv 1 0 1\nv 1 1 1\nf 4 5 6\n"
                   "usemtl blue\nv 0 0 2\nv 1 0 2\nv 1 1 2\nf 7 8 9\n");
  for (const ImportHow& how : {ImportHow{}, ImportHow{.memory = tests::kTight}}) {
    const Imported mesh = import_of({"a.obj"}, how);
    EXPECT_EQ(mesh.layout, AttributeLayout{.colour = ColourType::f32});
    EXPECT_THAT(corner_colours(mesh, 0), Each("0 1 0"));
    EXPECT_THAT(corner_colours(mesh, 1), Each("1 0 0"));
    EXPECT_THAT(corner_colours(mesh, 2), Each("0 0 1"));
    EXPECT_THAT(mesh.positions, SizeIs(9));
    EXPECT_EQ(mesh.count("vertices_made_white"), 0U);
  }
}

// A part without a picture, beside one that has one, shows its colours, whatever its material.
TEST_F(MaterialColoursTest, ColoursOfVerticesAreSeenBesideAPictureThatHasNone) {
  put("b.png", "a picture");
  put("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl scan\nmap_Kd b.png\n");
  const std::string textured = "v 0 0 9\nv 1 0 9\nv 1 1 9\nvt 0 0\nusemtl scan\nf 4/1 5/1 6/1\n";
  const std::string rest = "usemtl red\nf 1 2 3\nv 0 0 5\nv 1 0 5\nv 1 1 5\nf 7 8 9\nf 1 2 9\n";
  put("a.obj", std::string("mtllib a.mtl\n") + kOwnColours + textured + rest);
  for (const ImportHow& how : {ImportHow{}, ImportHow{.memory = tests::kTight}}) {
    const Imported mesh = import_of({"a.obj"}, how);
    EXPECT_TRUE(mesh.layout.tints);
    EXPECT_THAT(corner_colours(mesh, 0), Each("1 1 1")) << "the picture stays as it is";
    EXPECT_THAT(mesh.all_shown(),
                ElementsAre("b.png 0 1, 0 1, 0 1", "#ffffff", "#ff0000", "#ff0000"));
    EXPECT_THAT(corner_colours(mesh, 1), Each("0 1 0"));
    EXPECT_THAT(corner_colours(mesh, 2), Each("1 1 1"));
    EXPECT_EQ(mesh.count("vertices_made_white"), 0U);
    EXPECT_EQ(mesh.count("vertices_with_hidden_colours"), 0U);
  }
}

TEST_F(MaterialColoursTest, ColoursThatPicturesHaveTooAreHidden) {
  put("b.png", "a picture");
  put("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl scan\nmap_Kd b.png\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kOwnColours +
                   "v 0 0 9 1 0 1\nv 1 0 9 1 1 0\nv 1 1 9 0 1 1\nvt 0 0\nusemtl scan\n"
                   "f 4/1 5/1 6/1\nusemtl red\nf 1 2 3\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_FALSE(mesh.layout.tints);
  EXPECT_THAT(mesh.all_shown(), ElementsAre("b.png 0 1, 0 1, 0 1", "#ff0000"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 1 0")) << "nothing is lost";
  EXPECT_EQ(mesh.count("vertices_with_hidden_colours"), 3U);
}

TEST_F(MaterialColoursTest, OneMaterialBesideColoursOfVerticesIsShownThoughItIsGrey) {
  put("a.mtl", "newmtl grey\nKd 0.2 0.2 0.2\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kOwnColours +
                   "usemtl grey\nf 1 2 3\nv 0 0 1\nv 1 0 1\nv 1 1 1\nf 4 5 6\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_THAT(corner_colours(mesh, 0), Each("0 1 0"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0.2 0.2 0.2"));
}

TEST_F(MaterialColoursTest, WhatHasNeitherColourNorMaterialIsWhiteAndCounted) {
  put("a.mtl", "newmtl red\nKd 1 0 0\n");
  put("a.obj", std::string("mtllib a.mtl\n") + kOwnColours +
                   "f 1 2 3\nv 0 0 1\nv 1 0 1\nv 1 1 1\nf 4 5 6\n"
                   "v 0 0 2\nv 1 0 2\nv 1 1 2\nusemtl red\nf 7 8 9\nusemtl nobody\nv 0 0 3\n"
                   "v 1 0 3\nv 1 1 3\nf 10 11 12\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_THAT(corner_colours(mesh, 1), Each("1 1 1"));
  EXPECT_THAT(corner_colours(mesh, 2), Each("1 0 0"));
  EXPECT_THAT(corner_colours(mesh, 3), Each("1 1 1"));
  EXPECT_EQ(mesh.count("vertices_made_white"), 6U);
}

TEST_F(MaterialColoursTest, AVertexOfTwoMaterialsIsSplitOnlyWhereItHasNoColour) {
  put("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  put("a.obj",
      "mtllib a.mtl\nv 0 0 0 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
      "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n");
  const Imported mesh = import_of({"a.obj"});
  EXPECT_THAT(corner_colours(mesh, 0), ElementsAre("0 1 0", "1 0 0", "1 0 0"));
  EXPECT_THAT(corner_colours(mesh, 1), ElementsAre("0 1 0", "0 0 1", "0 0 1"));
  EXPECT_THAT(mesh.positions, SizeIs(5));
}

// ---- lists ---------------------------------------------------------------------------------

TEST_F(MaterialColoursTest, PlainFilesBesideColouredOnesAreWhite) {
  import_square(kRedAndBlue);
  put("bare.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  for (const ImportHow& how : {ImportHow{}, ImportHow{.memory = tests::kTight}}) {
    const Imported mesh = import_of({"bare.obj", "a.obj", "bare.obj"}, how);
    EXPECT_EQ(mesh.layout, kColoured);
    EXPECT_THAT(mesh.positions, SizeIs(3 + 6 + 3));
    EXPECT_THAT(corner_colours(mesh, 0), Each("255 255 255"));
    EXPECT_THAT(corner_colours(mesh, 1), Each("255 0 0"));
    EXPECT_THAT(corner_colours(mesh, 3), Each("255 255 255"));
    EXPECT_EQ(mesh.count("untextured_files"), 0U);
  }
}

TEST_F(MaterialColoursTest, AreJoinedWithColoursOfVertices) {
  import_square(kRedAndBlue);
  put("own.obj", "v 0 0 0 0 1 0\nv 1 0 0 0 1 0\nv 1 1 0 0 1 0\nf 1 2 3\n");
  const Imported mesh = import_of({"a.obj", "own.obj"});
  EXPECT_EQ(mesh.layout.colour, ColourType::f32);
  EXPECT_THAT(corner_colours(mesh, 0), Each("1 0 0"));
  EXPECT_THAT(corner_colours(mesh, 2), Each("0 1 0"));
  EXPECT_EQ(mesh.count("converted_colours"), 6U);
}

TEST_F(MaterialColoursTest, BesideTexturesTheyAreMaterials) {
  put("b.png", "a picture");
  put("b.mtl", "newmtl m\nmap_Kd b.png\n");
  put("b.obj", std::string("mtllib b.mtl\nusemtl m\nvt 0 0\n") + kCorners + "f 1/1 2/1 3/1\n");
  import_square(kRedAndBlue);
  const Imported mesh = import_of({"a.obj", "b.obj", "a.obj"});
  EXPECT_EQ(mesh.layout, (AttributeLayout{.texcoords = true, .material = true}));
  EXPECT_THAT(mesh.all_shown(),
              ElementsAre("#ff0000", "#000080", "b.png 0 1, 0 1, 0 1", "#ff0000", "#000080"));
  EXPECT_THAT(mesh.materials.materials, SizeIs(3)) << "one for each colour";
  EXPECT_EQ(mesh.count("untextured_files"), 2U);
}

// ---- OFF -----------------------------------------------------------------------------------

constexpr const char* kPyramid = "OFF\n5 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.5 1\n";

TEST_F(MaterialColoursTest, FacesOfAnOffHaveColours) {
  put("a.off",
      std::string(kPyramid) +
          "4 3 2 1 0 10 20 30\n3 0 1 4 255 0 0\n3 1 2 4 255 0 0\n3 2 3 4\n3 3 0 4 1 2 3 4\n");
  for (const ImportHow& how : {ImportHow{}, ImportHow{.memory = tests::kTight}}) {
    const Imported mesh = import_of({"a.off"}, how);
    EXPECT_EQ(mesh.layout, (AttributeLayout{.colour = ColourType::u8, .alpha = true}));
    EXPECT_THAT(corner_colours(mesh, 0), Each("10 20 30"));
    EXPECT_THAT(corner_colours(mesh, 1), Each("10 20 30"));
    EXPECT_THAT(corner_colours(mesh, 2), Each("255 0 0"));
    EXPECT_THAT(corner_colours(mesh, 4), Each("255 255 255"));
    EXPECT_THAT(corner_colours(mesh, 5), Each("1 2 3"));
    EXPECT_EQ(mesh.triangles[2][2], mesh.triangles[3][2]) << "one vertex for both red faces";
    EXPECT_EQ(mesh.count("faces_made_white"), 1U);
    EXPECT_THAT(mesh.positions, SizeIs(3 + 2 + 3 + 3 + 3));
  }
}

TEST_F(MaterialColoursTest, ColoursOfFacesOfAnOffAreFloatsIfOneIs) {
  put("a.off", std::string(kPyramid) +
                   "4 3 2 1 0\n3 0 1 4 1 0 0\n3 1 2 4 0.5 0 0 0.5\n3 2 3 4 9\n3 3 0 4\n");
  const Imported mesh = import_of({"a.off"});
  EXPECT_EQ(mesh.layout, AttributeLayout{.colour = ColourType::f32});
  EXPECT_THAT(corner_colours(mesh, 0), Each("1 1 1"));
  EXPECT_THAT(corner_colours(mesh, 2), Each("1 0 0"));
  EXPECT_THAT(corner_colours(mesh, 3), Each("0.5 0 0"));
  EXPECT_EQ(mesh.count("faces_made_white"), 3U);
  EXPECT_EQ(mesh.count("ignored_face_colours"), 1U);
}

TEST_F(MaterialColoursTest, ColoursOfVerticesOfAnOffCountBeforeThoseOfFaces) {
  put("a.off",
      "CNOFF\n3 1 0\n0 0 0 0 0 1 9 8 7\n1 0 0 0 0 1 9 8 7\n0 1 0 0 0 1 9 8 7\n3 0 1 2 255 0 0\n");
  put("b.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 1 0\n0 1 0 1 0 0\n3 0 1 2 255 0 0\n");
  const Imported mesh = import_of({"a.off"});
  EXPECT_THAT(corner_colours(mesh, 0), Each("9 8 7"));
  EXPECT_EQ(mesh.count("ignored_face_colours"), 1U);
  const Imported other = import_of({"b.off"});
  EXPECT_EQ(other.layout, (AttributeLayout{.normals = true, .colour = ColourType::u8}));
  EXPECT_THAT(other.attributes,
              ElementsAre(0, 0, 1, 255, 0, 0, 0, 1, 0, 255, 0, 0, 1, 0, 0, 255, 0, 0));
  const Imported both = import_of({"b.off", "a.off"});
  EXPECT_THAT(corner_colours(both, 0), Each("255 0 0"));
  EXPECT_THAT(corner_colours(both, 1), Each("9 8 7"));
}

// ---- glTF ----------------------------------------------------------------------------------

GltfJson primitive(GltfBuilder& gltf, std::optional<std::size_t> material) {
  GltfJson made{
      {"attributes", {{"POSITION", gltf.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0}, "VEC3")}}}};
  if (material)
    made["material"] = *material;
  return made;
}

std::size_t material(GltfBuilder& gltf, const GltfJson& factor) {
  return gltf.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", factor}}}});
}

TEST_F(MaterialColoursTest, BaseColoursAreThoseOfAScreen) {
  GltfBuilder gltf;
  gltf.show(primitive(gltf, material(gltf, {0.5, 0, 1, 0.25})));
  gltf.show(primitive(gltf, std::nullopt));
  put("a.glb", gltf.glb());
  const Imported mesh = import_of({"a.glb"});
  EXPECT_EQ(mesh.layout, kColoured);
  EXPECT_THAT(corner_colours(mesh, 0), Each("188 0 255"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("255 255 255"));
  EXPECT_EQ(mesh.count("material_colours"), 2U);
  EXPECT_EQ(mesh.count("vertices_made_white"), 0U);
  EXPECT_EQ(import_of({"a.glb"}, {.textures = Textures::ignore}).layout, AttributeLayout());
}

TEST_F(MaterialColoursTest, TheGreyOfProgramsIsNoBaseColour) {
  GltfBuilder gltf;
  gltf.show(primitive(gltf, material(gltf, {0.8, 0.8, 0.8, 1})));
  put("a.glb", gltf.glb());
  EXPECT_EQ(import_of({"a.glb"}).layout, AttributeLayout());
}

/// A triangle with colours of its own, all the same.
template <class Number>
GltfJson coloured(GltfBuilder& gltf, std::array<Number, 3> colour,
                  std::optional<std::size_t> material) {
  GltfJson made = primitive(gltf, material);
  std::vector<Number> values;
  for (int corner = 0; corner < 3; ++corner)
    values.insert(values.end(), colour.begin(), colour.end());
  made["attributes"]["COLOR_0"] = gltf.accessor(
      values, "VEC3",
      std::is_integral_v<Number> ? GltfJson{{"normalized", true}} : GltfJson::object());
  return made;
}

TEST_F(MaterialColoursTest, EachPartShowsItsBaseColourThoughAnotherHasColoursOfVertices) {
  GltfBuilder gltf;
  gltf.show(primitive(gltf, material(gltf, {1, 0, 0, 1})));
  gltf.show(primitive(gltf, material(gltf, {0, 0, 1, 1})));
  gltf.show(coloured<std::uint8_t>(gltf, {10, 200, 30}, std::nullopt));
  gltf.show(primitive(gltf, std::nullopt));
  put("a.glb", gltf.glb());
  const Imported mesh = import_of({"a.glb"});
  EXPECT_EQ(mesh.layout,
            (AttributeLayout{.colour = ColourType::u16, .space = ColourSpace::linear}));
  EXPECT_THAT(corner_colours(mesh, 0), Each("65535 0 0"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 0 65535"));
  EXPECT_THAT(corner_colours(mesh, 2), Each("2570 51400 7710"));
  EXPECT_THAT(corner_colours(mesh, 3), Each("65535 65535 65535"));
  EXPECT_EQ(mesh.count("material_colours"), 3U);
  EXPECT_EQ(mesh.count("vertices_made_white"), 0U) << "the part without either is white in glTF";
}

TEST_F(MaterialColoursTest, BaseColoursAreFactorsOfColoursOfVertices) {
  GltfBuilder gltf;
  gltf.show(coloured<std::uint8_t>(gltf, {255, 255, 255}, material(gltf, {1, 0, 0, 1})));
  gltf.show(coloured<std::uint8_t>(gltf, {255, 255, 255}, material(gltf, {0, 0.5, 1, 1})));
  gltf.show(coloured<std::uint8_t>(gltf, {100, 100, 100}, material(gltf, {0.5, 1, 0, 1})));
  put("a.glb", gltf.glb());
  const Imported mesh = import_of({"a.glb"});
  EXPECT_THAT(corner_colours(mesh, 0), Each("65535 0 0"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 32768 65535"));
  EXPECT_THAT(corner_colours(mesh, 2), Each("12850 25700 0"));
  EXPECT_EQ(mesh.count("vertices_made_white"), 0U);
  const Imported plain = import_of({"a.glb"}, {.textures = Textures::ignore});
  EXPECT_THAT(corner_colours(plain, 0), Each("255 255 255"));
}

TEST_F(MaterialColoursTest, FactorsKeepTypesThatProductsOfLightFit) {
  GltfBuilder gltf;
  gltf.show(coloured<std::uint16_t>(gltf, {65535, 1000, 3}, material(gltf, {0.5, 1, 0, 1})));
  gltf.show(primitive(gltf, material(gltf, {1, 0, 0, 1})));
  put("a.glb", gltf.glb());
  const Imported shorts = import_of({"a.glb"});
  EXPECT_EQ(shorts.layout.colour, ColourType::u16);
  EXPECT_THAT(corner_colours(shorts, 0), Each("32768 1000 0"));
  EXPECT_THAT(corner_colours(shorts, 1), Each("65535 0 0"));
  GltfBuilder floats;
  floats.show(coloured<float>(floats, {0.25F, 0.5F, 1}, material(floats, {1, 0, 1, 1})));
  floats.show(primitive(floats, material(floats, {0, 1, 0, 1})));
  put("b.glb", floats.glb());
  const Imported mesh = import_of({"b.glb"});
  EXPECT_EQ(mesh.layout.colour, ColourType::f32);
  EXPECT_THAT(corner_colours(mesh, 0), Each("0.25 0 1"));
  EXPECT_THAT(corner_colours(mesh, 1), Each("0 1 0"));
}

}  // namespace
}  // namespace meshhier::importing
