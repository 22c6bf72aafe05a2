// PLY files as scanners and segmentation write them: texture faces in lists of their own, colours
// of faces, and names that differ.
#include "import/import_test.h"
#include "mesh_io/ply_samples.h"
#include "tests/support/gzip.h"

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

using mesh_io::AttributeChoice;
using mesh_io::PlyEncoding;
using mesh_io::PlyType;
using mesh_io::tests::kEncodings;
using mesh_io::tests::PlyText;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::Imported;
using tests::ImportHow;

class PlyCornersTest : public tests::ImportTest {
 protected:
  Imported import(const std::string& name = "a.ply", const ImportHow& how = {}) {
    return import_file(name, how);
  }
  std::string failure_of(const std::string& content) {
    put("a.ply", content);
    return failure_of_file("a.ply");
  }
};

/// A square of two triangles as Artec Studio writes it; each row of texture faces: tx tn n i ....
std::string artec(PlyEncoding encoding, const std::vector<std::string>& comments,
                  const std::vector<std::vector<double>>& texture_faces) {
  PlyText ply(encoding);
  for (const std::string& comment : comments)
    ply.line("comment " + comment);
  for (const char* line :
       {"element vertex 4", "property float x", "property float y", "property float z",
        "element face 2", "property list uchar int vertex_indices",
        "element multi_texture_vertex 5", "property uchar tx", "property float u",
        "property float v"})
    ply.line(line);
  ply.line(fmt::format("element multi_texture_face {}", texture_faces.size()));
  for (const char* line :
       {"property uchar tx", "property uint tn", "property list uchar int texture_vertex_indices"})
    ply.line(line);
  ply.end_header();
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
    ply.row(PlyType::f32, {double(x), double(y), 0});
  ply.list(PlyType::u8, PlyType::i32, {0, 1, 2}).list(PlyType::u8, PlyType::i32, {0, 2, 3});
  for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}, {0.5, 0.25}})
    ply.value(PlyType::u8, 0).value(PlyType::f32, u).value(PlyType::f32, v).end_row();
  for (const std::vector<double>& face : texture_faces) {
    ply.value(PlyType::u8, face[0]).value(PlyType::u32, face[1]);
    ply.value(PlyType::u8, double(face.size()) - 2);
    for (std::size_t i = 2; i < face.size(); ++i)
      ply.value(PlyType::i32, face[i]);
    ply.end_row();
  }
  return ply.bytes();
}

TEST_F(PlyCornersTest, TextureFacesBelongToTheFacesTheyNumber) {
  put("a.png", "");
  put("b.png", "");
  for (const PlyEncoding encoding : kEncodings) {
    put("a.ply", artec(encoding, {"TextureFile a.png", "TextureFile b.png"},
                       {{1, 1, 0, 2, 4}, {0, 0, 0, 1, 2}}));
    const Imported mesh = import();
    EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0", "b.png 0 1, 1 0, 0.5 0.75"));
    EXPECT_EQ(mesh.count("split_vertices"), 2U);
    EXPECT_EQ(import("a.ply", {.memory = tests::kTight}).attributes, mesh.attributes);
    EXPECT_THAT(mesh.warnings, IsEmpty());
  }
}

TEST_F(PlyCornersTest, FacesWithoutATextureFaceShowNone) {
  put("a.png", "");
  for (const PlyEncoding encoding : kEncodings) {
    put("a.ply", artec(encoding, {"TextureFile a.png"}, {{0, 1, 0, 2, 3}}));
    EXPECT_THAT(import().all_shown(), ElementsAre("#ffffff", "a.png 0 1, 1 0, 0 0"));
  }
}

TEST_F(PlyCornersTest, PicturesOfArtecLieBesideUnderTheNameOfTheMesh) {
  put("Side table_0.jpg", "");
  put("Side table_1.PNG", "");
  const std::string content =
      artec(PlyEncoding::little_endian, {"File exported by Artec Group 3D Scanning Solutions"},
            {{0, 0, 0, 1, 2}, {1, 1, 0, 2, 3}});
  put("Side table.ply", content);
  put("Side table.ply.gz", tests::gzip(content));
  for (const char* name : {"Side table.ply", "Side table.ply.gz"}) {
    const Imported mesh = import(name);
    EXPECT_THAT(mesh.all_shown(),
                ElementsAre("Side table_0.jpg 0 1, 1 1, 1 0", "Side table_1.PNG 0 1, 1 0, 0 0"));
    EXPECT_THAT(mesh.companions(), ElementsAre("w/Side table_0.jpg", "w/Side table_1.PNG"));
    EXPECT_THAT(mesh.summary.unused, IsEmpty());
  }
}

TEST_F(PlyCornersTest, MissingPicturesOfArtecAreTold) {
  put("a.ply", artec(PlyEncoding::ascii, {}, {{0, 0, 0, 1, 2}, {200, 1, 0, 2, 3}}));
  const Imported mesh = import();
  EXPECT_THAT(mesh.warnings,
              ElementsAre("2 pictures of the mesh are missing (the first is a_0.jpg of w/a.ply): "
                          "the mesh is read as one without textures"));
  EXPECT_EQ(mesh.layout, AttributeLayout());
  EXPECT_THAT(mesh.companions(), SizeIs(8));
  EXPECT_THAT(import("a.ply", {.textures = Textures::ignore}).companions(), IsEmpty());
}

TEST_F(PlyCornersTest, FailuresNameTheTextureFace) {
  put("a.png", "");
  for (const PlyEncoding encoding : kEncodings) {
    const auto with = [&](const std::vector<double>& face) {
      return failure_of(artec(encoding, {"TextureFile a.png"}, {{0, 0, 0, 1, 2}, face}));
    };
    EXPECT_EQ(with({0, 1, 0, 2, 3}), "");
    EXPECT_THAT(with({0, 1, 0, 2, 5}), HasSubstr("expected a vertex index below 5"));
    EXPECT_THAT(with({0, 1, 0, 2, -1}), HasSubstr("row 1 of 2 of element 'multi_texture_face'"));
    EXPECT_THAT(with({1, 1, 0, 2, 3}),
                HasSubstr("expected the number of one of 1 texture files, from 0 on, or -1 for "
                          "none, as 'tx' in row 1 of 2"));
    EXPECT_THAT(with({0, 2, 0, 2, 3}), HasSubstr("expected the number of one of 2 faces"));
    EXPECT_THAT(with({0, 1, 0, 2}), HasSubstr("a texture vertex for each of the 3 corners of face "
                                              "1, found 2"));
    EXPECT_THAT(with({0, 0, 0, 1, 2}), HasSubstr("3 corners of face 0, found 6"));
  }
}

/// A square of two triangles whose faces have `properties` and `rows` of numbers.
std::string coloured(PlyEncoding encoding, const std::vector<std::string>& properties, PlyType type,
                     const std::vector<std::vector<double>>& rows,
                     const std::string& comment = "none") {
  PlyText ply(encoding);
  ply.line("comment " + comment);
  for (const char* line :
       {"element vertex 4", "property float x", "property float y", "property float z"})
    ply.line(line);
  ply.line(fmt::format("element face {}", rows.size()));
  ply.line("property list uchar int vertex_indices");
  for (const std::string& property : properties)
    ply.line(fmt::format("property {} {}", name_of(type), property));
  ply.end_header();
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
    ply.row(PlyType::f32, {double(x), double(y), 0});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ply.value(PlyType::u8, 3).value(PlyType::i32, 0);
    ply.value(PlyType::i32, i % 2 == 0 ? 1 : 2).value(PlyType::i32, i % 2 == 0 ? 2 : 3);
    for (const double number : rows[i])
      ply.value(type, number);
    ply.end_row();
  }
  return ply.bytes();
}

/// The colour of the corners of a triangle, which must be one.
std::vector<float> colour_of(const Imported& mesh, std::size_t triangle) {
  const auto channels = static_cast<std::size_t>(mesh.layout.channels());
  const auto first = mesh.layout.part(AttributeKind::colours).first;
  const auto count = mesh.layout.part(AttributeKind::colours).count;
  std::vector<float> colour;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = mesh.attributes.begin() +
                    static_cast<std::ptrdiff_t>(mesh.triangles.at(triangle)[k] * channels + first);
    const std::vector<float> here(at, at + static_cast<std::ptrdiff_t>(count));
    EXPECT_TRUE(k == 0 || here == colour);
    colour = here;
  }
  return colour;
}

TEST_F(PlyCornersTest, ColoursOfFacesBecomeThoseOfTheirCorners) {
  struct Case {
    std::vector<std::string> properties;
    PlyType type;
    std::vector<double> first, second;
    ColourType colour;
    std::size_t channels;
  };
  const std::vector<Case> cases{
      {{"red", "green", "blue"}, PlyType::u8, {255, 0, 7}, {0, 0, 0}, ColourType::u8, 3},
      {{"red", "green", "blue", "alpha"},
       PlyType::u8,
       {1, 2, 3, 4},
       {1, 2, 3, 5},
       ColourType::u8,
       4},
      {{"r", "g", "b"}, PlyType::u16, {65535, 1, 256}, {0, 0, 65535}, ColourType::u16, 3},
      {{"diffuse_red", "diffuse_green", "diffuse_blue"},
       PlyType::i32,
       {9, 8, 7},
       {6, 5, 4},
       ColourType::u8,
       3},
      {{"Red", "Green", "Blue", "Alpha"},
       PlyType::u16,
       {1, 2, 3, 65535},
       {3, 2, 1, 0},
       ColourType::u16,
       4},
      {{"red", "green", "blue", "alpha"},
       PlyType::f32,
       {0.25, -0.5, 1, 0.5},
       {1, 1, 0, 0.5},
       ColourType::f32,
       3},
      {{"red", "green", "blue"}, PlyType::f64, {0, 0.5, 1}, {1, 0.5, 0}, ColourType::f32, 3}};
  for (const Case& one : cases) {
    for (const PlyEncoding encoding : kEncodings) {
      put("a.ply", coloured(encoding, one.properties, one.type, {one.first, one.second}));
      const Imported mesh = import();
      EXPECT_EQ(mesh.layout.colour, one.colour);
      for (const std::size_t i : {0U, 1U}) {
        const std::vector<double>& wanted = i == 0 ? one.first : one.second;
        EXPECT_EQ(
            colour_of(mesh, i),
            std::vector<float>(wanted.begin(), wanted.begin() + std::ptrdiff_t(one.channels)));
      }
      EXPECT_EQ(mesh.count("split_vertices"), 2U);
      EXPECT_THAT(mesh.positions, SizeIs(6));
      EXPECT_EQ(import("a.ply", {.memory = tests::kTight}).attributes, mesh.attributes);
      EXPECT_EQ(import("a.ply", {.textures = Textures::ignore}).attributes, mesh.attributes);
    }
  }
}

TEST_F(PlyCornersTest, FacesOfOneColourSplitNothing) {
  put("a.ply", coloured(PlyEncoding::ascii, {"red", "green", "blue"}, PlyType::u8,
                        {{5, 6, 7}, {5, 6, 7}, {5, 6, 7}, {5, 6, 7}}));
  const Imported mesh = import();
  EXPECT_EQ(mesh.count("split_vertices"), 0U);
  EXPECT_THAT(mesh.positions, SizeIs(4));
  EXPECT_EQ(colour_of(mesh, 3), (std::vector<float>{5, 6, 7}));
}

TEST_F(PlyCornersTest, StripsBesideColouredFacesAreWhite) {
  put("a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 1\n3 0 1 2 250 1 2\n4 0 1 2 3\n");
  const Imported mesh = import();
  EXPECT_EQ(colour_of(mesh, 0), (std::vector<float>{250, 1, 2}));
  EXPECT_EQ(colour_of(mesh, 1), (std::vector<float>{255, 255, 255}));
  EXPECT_EQ(colour_of(mesh, 2), (std::vector<float>{255, 255, 255}));
}

TEST_F(PlyCornersTest, ColoursOfFacesMustBeNumbersOfTheirRange) {
  const auto with = [&](PlyType type, double red) {
    return failure_of(
        coloured(PlyEncoding::ascii, {"red", "green", "blue"}, type, {{1, 1, 1}, {red, 0, 0}}));
  };
  EXPECT_EQ(with(PlyType::i32, 255), "");
  EXPECT_THAT(with(PlyType::i32, 256), HasSubstr("expected an integer from 0 to 255 as 'red' in "
                                                 "row 1 of 2 of element 'face', found 256"));
  EXPECT_THAT(with(PlyType::i16, -1), HasSubstr("found -1"));
  EXPECT_THAT(with(PlyType::f32, std::numeric_limits<double>::quiet_NaN()),
              HasSubstr("expected a finite number as 'red'"));
}

TEST_F(PlyCornersTest, ColoursOfVerticesCountInsteadOfThoseOfFaces) {
  put("a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property list uchar float quality\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 1\n"
      "property int vertex1\nproperty int vertex2\nend_header\n"
      "0 0 0 1 2 3 1 0.5\n1 0 0 1 2 3 1 0.5\n1 1 0 1 2 3 0\n3 0 1 2 9 9 9\n0 1\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.summary.files, IsEmpty()) << "read where it lies";
  EXPECT_EQ(colour_of(mesh, 0), (std::vector<float>{1, 2, 3}));
  EXPECT_THAT(mesh.summary.unused,
              ElementsAre("vertex.quality", "face.red", "face.green", "face.blue", "edge"));
}

TEST_F(PlyCornersTest, ColoursOfFacesAreShownWherePicturesAreMissing) {
  const auto content = [](const char* vertex) {
    return fmt::format(
        "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nproperty float {}\nproperty float {}\n"
        "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2 9 8 7\n",
        vertex[0], vertex[1]);
  };
  put("a.ply", content("st"));
  EXPECT_EQ(colour_of(import(), 0), (std::vector<float>{9, 8, 7}));
  EXPECT_TRUE(import().layout.texcoords) << "the vertices keep theirs";
  put("a.png", "");
  EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0"));
}

TEST_F(PlyCornersTest, TextureCoordinatesHaveManyNames) {
  put("a.png", "");
  for (const char* name : {"texcoord", "texcoords", "texture_coordinates", "texture_coords", "uv",
                           "texture_coord", "tex_coords", "tex_coord", "TexCoord"}) {
    put("a.ply",
        fmt::format("ply\nformat ascii 1.0\ncomment texturefile a.png\nelement vertex 3\n"
                    "property float x\nproperty float y\nproperty float z\nelement face 1\n"
                    "property list uchar int vertex_indices\nproperty list uchar double {}\n"
                    "end_header\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2 6 0 0 1 0 1 1\n",
                    name));
    EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0")) << name;
  }
}

/// A triangle whose vertices have texture coordinates or not.
std::string triangle(const std::string& comments, const std::string& properties,
                     const std::string& numbers) {
  return fmt::format(
      "ply\nformat ascii 1.0\n{}element vertex 3\nproperty float x\nproperty float y\n"
      "property float z\n{}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0{}\n1 0 0{}\n1 1 0{}\n3 0 1 2\n",
      comments, properties, numbers, numbers, numbers);
}

TEST_F(PlyCornersTest, PicturesThatAreNotUsedAreTold) {
  const std::string st = "property float s\nproperty float t\n";
  put("a.png", "");
  put("a.ply", triangle("comment TextureFile a.png\n", "", ""));
  EXPECT_THAT(import().warnings,
              ElementsAre("w/a.ply names the picture a.png, but has no texture coordinates: it is "
                          "not used"));
  EXPECT_THAT(import("a.ply", {.textures = Textures::ignore}).warnings, IsEmpty());
  put("a.ply", triangle("comment TextureFile a.png\ncomment TextureFile b.png\n", st, " 0 0"));
  EXPECT_THAT(
      import().warnings,
      ElementsAre("w/a.ply names the picture b.png, but no face of it can show it: it is not "
                  "used"));
  put("a.ply", triangle("", st, " 0 0"));
  EXPECT_THAT(import().warnings,
              ElementsAre(HasSubstr("w/a.ply has texture coordinates but names no picture: a.png "
                                    "beside it is not used; if it is its texture, add the line "
                                    "'comment TextureFile a.png' to the header")));
  put("a.ply", triangle("", "", ""));
  EXPECT_THAT(import().warnings, IsEmpty()) << "a picture of anything";
  put("c.ply", triangle("", st, " 0 0"));
  EXPECT_THAT(import("c.ply").warnings, IsEmpty()) << "no picture beside";
}

TEST_F(PlyCornersTest, WhatIsNotUsedIsListed) {
  put("a.ply", triangle("", "property float confidence\nproperty uchar flags\n", " 1 2"));
  EXPECT_THAT(import().summary.unused, ElementsAre("vertex.flags"));
  EXPECT_THAT(
      import("a.ply", {.attributes = {.which = AttributeChoice::Which::none}}).summary.unused,
      ElementsAre("vertex.confidence", "vertex.flags"));
  EXPECT_THAT(
      import("a.ply", {.attributes = {.which = AttributeChoice::Which::named, .names = {"flags"}}})
          .summary.unused,
      ElementsAre("vertex.confidence"));
  put("a.ply", triangle("",
                        "property float normalx\nproperty float normaly\n"
                        "property float normalz\n",
                        " 0 0 1"));
  const Imported normals = import();
  EXPECT_TRUE(normals.layout.normals);
  EXPECT_THAT(normals.summary.unused, IsEmpty());
  put("a.ply", triangle("", "property float NX\nproperty float Ny\nproperty float nz\n", " 0 0 1"));
  EXPECT_TRUE(import().layout.normals);
  std::string many, numbers;
  for (int i = 0; i < 150; ++i) {
    many += fmt::format("property float p{}\n", i);
    numbers += " 0";
  }
  put("a.ply", triangle("", many, numbers));
  const Imported mesh = import("a.ply", {.attributes = {.which = AttributeChoice::Which::none}});
  EXPECT_THAT(mesh.summary.unused, SizeIs(101));
  EXPECT_EQ(mesh.summary.unused.back(), "50 more");
  EXPECT_THAT(import().layout.values, SizeIs(kMaxValueChannels)) << "and no more";
}

}  // namespace
}  // namespace meshhier::importing
