// PLY files that name pictures.
#include "import/import_test.h"
#include "mesh_io/ply_samples.h"
#include "tests/support/gzip.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

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

std::string text_of(const PlyText& ply) {
  return {reinterpret_cast<const char*>(ply.bytes().data()), ply.bytes().size()};
}

/// The header of a square of four vertices, with `vertex` and `face` lines of further properties.
PlyText square(PlyEncoding encoding, const std::vector<std::string>& files,
               const std::string& faces, const std::vector<std::string>& properties) {
  PlyText ply(encoding);
  for (const std::string& file : files)
    ply.line("comment TextureFile " + file);
  ply.line("element vertex 4").line("property float x").line("property float y");
  ply.line("property float z").line("element face " + faces);
  for (const std::string& property : properties)
    ply.line("property " + property);
  ply.end_header();
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
    ply.row(PlyType::f32, {double(x), double(y), 0});
  return ply;
}

class TexturedPlyTest : public tests::ImportTest {
 protected:
  Imported import(const ImportHow& how = {}, const std::string& name = "a.ply") {
    return import_file(name, how);
  }
  std::string failure_of(const std::string& content) {
    put("a.ply", content);
    return failure_of_file("a.ply");
  }
};

/// A text with coordinates of vertices, and faces of the numbers given.
std::string with_vertex_texcoords(const std::string& names, const std::string& faces,
                                  std::size_t count) {
  return fmt::format(
      "ply\nformat ascii 1.0\n{}element vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty float {}\nproperty float {}\nelement face {}\n"
      "property list uchar int vertex_indices\nproperty int texnumber\nend_header\n"
      "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n{}",
      "comment TextureFile a.png\ncomment TEXTUREfile  b c.png \n",
      names.substr(0, names.find(' ')), names.substr(names.find(' ') + 1), count, faces);
}

TEST_F(TexturedPlyTest, FacesHaveCoordinatesOfTheirOwn) {
  put("a.png", "");
  put("b c.png", "");
  for (const PlyEncoding encoding : kEncodings) {
    for (const PlyType number : {PlyType::i8, PlyType::u16, PlyType::i32, PlyType::u32}) {
      PlyText ply =
          square(encoding, {"a.png", "b c.png"}, "3",
                 {"list uchar float texcoord", fmt::format("{} texnumber", name_of(number)),
                  "list uchar int vertex_indices"});
      const auto face = [&](std::initializer_list<double> texcoords, double texture,
                            std::initializer_list<double> corners) {
        ply.value(PlyType::u8, double(texcoords.size()));
        for (const double value : texcoords)
          ply.value(PlyType::f32, value);
        ply.value(number, texture);
        ply.value(PlyType::u8, double(corners.size()));
        for (const double corner : corners)
          ply.value(PlyType::i32, corner);
        ply.end_row();
      };
      face({0, 0, 1, 0, 1, 1, 0, 1}, 1, {0, 1, 2, 3});
      face({0, 0, 0.5, 0, 0.5, 0.25}, 0, {0, 1, 2});
      face({}, 0, {1, 2, 3});
      put("a.ply", text_of(ply));
      const Imported mesh = import();
      EXPECT_THAT(mesh.all_shown(), ElementsAre("b c.png 0 1, 1 1, 1 0", "b c.png 0 1, 1 0, 0 0",
                                                "a.png 0 1, 0.5 1, 0.5 0.75", "#ffffff"));
      EXPECT_EQ(mesh.layout, (AttributeLayout{.texcoords = true, .material = true}));
      EXPECT_EQ(mesh.summary.textures, (SourceTextures{.materials = 3, .images = 2}));
      EXPECT_EQ(mesh.summary.faces, 3U);
      EXPECT_EQ(mesh.count("split_vertices"), mesh.positions.size() - 4);
      EXPECT_EQ(import({.memory = tests::kTight}).attributes, mesh.attributes);
    }
  }
}

TEST_F(TexturedPlyTest, VerticesHaveCoordinatesAndFacesNumbers) {
  put("a.png", "");
  put("b c.png", "");
  for (const char* names : {"s t", "u v", "texture_u texture_v", "texture_s texture_t"}) {
    put("a.ply", with_vertex_texcoords(
                     names, "4 0 1 2 3 1\n3 0 1 2 0\n3 1 2 3 -1\n3 0 0 1 1\n2 0 1 1\n", 5));
    const Imported mesh = import();
    EXPECT_THAT(mesh.all_shown(), ElementsAre("b c.png 0 1, 1 1, 1 0", "b c.png 0 1, 1 0, 0 0",
                                              "a.png 0 1, 1 1, 1 0", "#ffffff"));
    EXPECT_EQ(mesh.summary.degenerate_triangles, 2U);
    EXPECT_THAT(mesh.companions(), ElementsAre("w/b c.png", "w/a.png"));
  }
}

TEST_F(TexturedPlyTest, PicturesBelongToTheInput) {
  put("a.ply", with_vertex_texcoords("s t", "3 0 1 2 0\n3 0 1 2 1\n", 2));
  put("a.png", "one");
  const Imported before = import();
  EXPECT_THAT(before.companions(), ElementsAre("w/a.png", "no w/b c.png"));
  put("a.png", "two");
  EXPECT_NE(import().summary.checksum, before.summary.checksum);
}

TEST_F(TexturedPlyTest, PackedFilesAreTextured) {
  put("a.png", "");
  put("a.ply.gz", tests::gzip(with_vertex_texcoords("s t", "3 0 1 2 0\n", 1)));
  EXPECT_THAT(import({}, "a.ply.gz").all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0"));
}

TEST_F(TexturedPlyTest, WithoutNumbersTheFirstPictureIsShown) {
  put("a.png", "");
  PlyText ply = square(PlyEncoding::ascii, {"a.png"}, "1",
                       {"list uchar int vertex_indices", "list uchar float texcoord"});
  put("a.ply", text_of(ply) + "3 0 1 2 6 0 0 1 0 1 1\n");
  EXPECT_THAT(import().all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0"));
}

TEST_F(TexturedPlyTest, OtherAttributesStay) {
  put("a.png", "");
  put("a.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty double x\n"
      "property double y\nproperty double z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0.1 0 0 0 0 1 1 2 3 0 0\n7 7 7 1 0 0 4 5 6 0.5 0.5\n1 0 0 0 0 1 1 2 3 1 0\n"
      "1 1 0 0 0 1 1 2 3 1 1\n3 0 2 3\n");
  const Imported mesh = import();
  EXPECT_EQ(mesh.layout, (AttributeLayout{true, ColourType::u8, false, true, true}));
  EXPECT_EQ(mesh.positions[0].x, 0.1);
  const std::vector<float> lone(mesh.attributes.begin() + 9, mesh.attributes.begin() + 18);
  EXPECT_THAT(lone, ElementsAre(1, 0, 0, 4, 5, 6, 0, 0, 0)) << "of no triangle";
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0"));
}

TEST_F(TexturedPlyTest, WithoutPicturesTheMeshIsAsItWas) {
  const std::string faces = "4 0 1 2 3 0\n3 0 1 2 1\n";
  put("a.ply", with_vertex_texcoords("s t", faces, 2));
  const Imported missing = import();
  EXPECT_THAT(missing.warnings,
              ElementsAre("2 pictures of the mesh are missing (the first is a.png "
                          "of w/a.ply): the mesh is read as one without textures"));
  const Imported ignored = import({.textures = Textures::ignore});
  EXPECT_THAT(ignored.warnings, IsEmpty());
  EXPECT_THAT(ignored.summary.files, IsEmpty()) << "read where it lies";
  for (const Imported& mesh : {missing, ignored}) {
    EXPECT_EQ(mesh.layout, AttributeLayout{.texcoords = true});
    EXPECT_THAT(mesh.attributes, ElementsAre(0, 0, 1, 0, 1, 1, 0, 1));
    EXPECT_THAT(mesh.triangles, SizeIs(3));
    EXPECT_FALSE(mesh.summary.textures);
  }
}

TEST_F(TexturedPlyTest, NobodysPropertyIsTakenForOurMaterials) {
  put("a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float s\nproperty float t\nproperty float material\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0 0 5\n1 0 0 1 0 5\n1 1 0 1 1 5\n3 0 1 2\n");
  put("a.ply.gz", tests::gzip(files_.content("w/a.ply")));
  for (const char* name : {"a.ply", "a.ply.gz"}) {
    for (const bool weld : {false, true}) {
      const Imported mesh = import({.weld = weld}, name);
      EXPECT_FALSE(mesh.layout.material);
      EXPECT_THAT(mesh.layout.values,
                  ElementsAre(ScalarAttribute{"material", ValueType::f32, false}));
      EXPECT_THAT(mesh.attributes, ElementsAre(5, 0, 0, 5, 1, 0, 5, 1, 1));
    }
  }
}

TEST_F(TexturedPlyTest, FailuresNameTheFace) {
  put("a.png", "");
  const auto with_face = [&](const std::string& face) {
    return failure_of(with_vertex_texcoords("s t", "3 0 1 2 0\n" + face + "\n", 2));
  };
  EXPECT_EQ(with_face("3 0 1 2 2"),
            "w/a.ply: line 20: expected the number of one of 2 texture files, from 0 on, or -1 for "
            "none, as 'texnumber' in row 1 of 2 of element 'face', found 2");
  EXPECT_THAT(with_face("3 0 1 2 -2"), HasSubstr("row 1 of 2 of element 'face', found -2"));
  EXPECT_THAT(with_face("3 0 1 4 0"), HasSubstr("expected a vertex index below 4"));
  EXPECT_THAT(with_face("3 0 1 -1 0"), HasSubstr("expected a vertex index below 4"));
  EXPECT_THAT(with_face("3 0 1 2 0.5"), HasSubstr("expected an integer"));
  for (const PlyEncoding encoding : kEncodings) {
    const auto with_texcoords = [&](std::initializer_list<double> texcoords) {
      PlyText ply = square(encoding, {"a.png"}, "1",
                           {"list uchar uint vertex_indices", "list uchar float texcoord"});
      for (const double corner : {0, 1, 2})
        corner == 0 ? ply.value(PlyType::u8, 3).value(PlyType::u32, corner)
                    : ply.value(PlyType::u32, corner);
      ply.list(PlyType::u8, PlyType::f32, texcoords);
      return failure_of(text_of(ply));
    };
    EXPECT_EQ(with_texcoords({0, 0, 1, 0, 1, 1}), "");
    EXPECT_THAT(
        with_texcoords({0, 0, 1, 0, 1}),
        HasSubstr("expected 6 numbers or none, two a corner, in list 'texcoord' of row 0 of "
                  "1 of element 'face', found 5"));
    EXPECT_EQ(with_texcoords({0, 0, 1, 0, 1, std::nan("")}), "");
  }
}

TEST_F(TexturedPlyTest, AFaceIsOfALimitedSize) {
  put("a.png", "");
  PlyText ply = square(PlyEncoding::little_endian, {"a.png"}, "1",
                       {"list uint uint vertex_indices", "list uchar float texcoord"});
  ply.value(PlyType::u32, 65'537);
  for (int i = 0; i < 65'537; ++i)
    ply.value(PlyType::u32, 0);
  ply.list(PlyType::u8, PlyType::f32, {});
  EXPECT_THAT(failure_of(text_of(ply)), HasSubstr("expected at most 65536 corners with texture"));
}

TEST_F(TexturedPlyTest, StripsShowTheFirstPicture) {
  put("a.png", "");
  put("a.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nproperty float s\nproperty float t\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n1 1 0 1 1\n7 0 1 2 3 -1 0 0\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 0 0", "a.png 0 0, 1 1, 1 0"));
  EXPECT_EQ(mesh.summary.faces, 1U);
}

}  // namespace
}  // namespace meshhier::importing
