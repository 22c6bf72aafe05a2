// Labels and quantities of PLY faces: what a face has, its corners have.
#include "import/import_test.h"
#include "mesh_io/ply_samples.h"

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
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
using testing::IsEmpty;
using testing::SizeIs;
using tests::Imported;
using tests::ImportHow;

struct Property {
  std::string name;
  PlyType type;
  std::vector<double> values;  ///< values of each face
};

/// A fan of triangles around the first vertex.
std::string fan(PlyEncoding encoding, const std::vector<Property>& properties) {
  const std::size_t faces = properties[0].values.size();
  PlyText ply(encoding);
  ply.line(fmt::format("element vertex {}", faces + 2));
  for (const char* axis : {"x", "y", "z"})
    ply.line(fmt::format("property float {}", axis));
  ply.line(fmt::format("element face {}", faces));
  ply.line(fmt::format("property {} {}", name_of(properties[0].type), properties[0].name));
  ply.line("property list uchar int vertex_indices");
  for (std::size_t i = 1; i < properties.size(); ++i)
    ply.line(fmt::format("property {} {}", name_of(properties[i].type), properties[i].name));
  ply.end_header();
  for (std::size_t i = 0; i < faces + 2; ++i)
    ply.row(PlyType::f32, {i == 0 ? 0.0 : 1.0, i == 0 ? 0.0 : double(i), 0});
  for (std::size_t i = 0; i < faces; ++i) {
    ply.value(properties[0].type, properties[0].values[i]);
    ply.value(PlyType::u8, 3);
    for (const std::size_t corner : {std::size_t{0}, i + 1, i + 2})
      ply.value(PlyType::i32, double(corner));
    for (std::size_t k = 1; k < properties.size(); ++k)
      ply.value(properties[k].type, properties[k].values[i]);
    ply.end_row();
  }
  return ply.bytes();
}

class FaceValuesTest : public tests::ImportTest {
 protected:
  Imported import(const ImportHow& how = {}) { return import_file("a.ply", how); }
  /// Returns for each triangle the value that its three corners have; they must be the same, bit
  /// for bit.
  static std::vector<double> of_triangles(const Imported& mesh, std::size_t attribute) {
    const std::vector<double> all = mesh.values(attribute);
    std::vector<double> found;
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t corner : t)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(all[corner]),
                  std::bit_cast<std::uint64_t>(all[t[0]]));
      found.push_back(all[t[0]]);
    }
    return found;
  }
};

TEST_F(FaceValuesTest, CornersHaveWhatTheirFaceHas) {
  for (const PlyEncoding encoding : kEncodings) {
    put("a.ply", fan(encoding, {{"object_id", PlyType::i32, {7, 7, -2147483648.0, 7}},
                                {"stress", PlyType::f64, {1e-310, 1e-310, 0.1, 1e-310}},
                                {"class", PlyType::u8, {255, 255, 0, 3}}}));
    const Imported mesh = import();
    EXPECT_THAT(mesh.layout.values, ElementsAre(ScalarAttribute{"object_id", ValueType::i32, true},
                                                ScalarAttribute{"stress", ValueType::f64, false},
                                                ScalarAttribute{"class", ValueType::u8, true}));
    EXPECT_THAT(of_triangles(mesh, 0), ElementsAre(7, 7, -2147483648.0, 7));
    EXPECT_THAT(of_triangles(mesh, 1), ElementsAre(1e-310, 1e-310, 0.1, 1e-310));
    EXPECT_THAT(of_triangles(mesh, 2), ElementsAre(255, 255, 0, 3));
    // The middle has three kinds of faces; on each side of the third face two vertices have two.
    EXPECT_EQ(mesh.count("split_vertices"), 4U);
    EXPECT_THAT(mesh.positions, SizeIs(10));
    EXPECT_THAT(mesh.summary.unused, IsEmpty());
    const Imported tight = import({.memory = tests::kTight});
    EXPECT_EQ(tight.attributes, mesh.attributes);
    EXPECT_EQ(tight.triangles, mesh.triangles);
  }
}

TEST_F(FaceValuesTest, FacesOfOneValueSplitNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  put("a.ply", fan(PlyEncoding::little_endian, {{"label", PlyType::u16, {5, 5, 5}},
                                                {"quality", PlyType::f32, {nan, nan, nan}}}));
  const Imported mesh = import();
  EXPECT_EQ(mesh.count("split_vertices"), 0U);
  EXPECT_THAT(mesh.warnings, IsEmpty());
  EXPECT_THAT(mesh.values(0), ElementsAre(5, 5, 5, 5, 5));
  EXPECT_THAT(mesh.values(1), testing::Each(testing::IsNan()));
}

/// Against a plain table: what each triangle has, whatever the memory.
TEST_F(FaceValuesTest, ManyFacesOfManyValues) {
  std::mt19937 random(44);
  std::vector<double> labels, bytes;
  for (int i = 0; i < 20000; ++i) {
    labels.push_back(double(random() % 300) - 150);
    bytes.push_back(double(random() % 3));
  }
  put("a.ply",
      fan(PlyEncoding::big_endian, {{"a", PlyType::i16, labels}, {"b", PlyType::u8, bytes}}));
  const Imported roomy = import(), tight = import({.memory = tests::kTight});
  EXPECT_EQ(of_triangles(roomy, 0), labels);
  EXPECT_EQ(of_triangles(roomy, 1), bytes);
  EXPECT_EQ(tight.attributes, roomy.attributes);
  EXPECT_EQ(tight.triangles, roomy.triangles);
  EXPECT_LE(tight.disk_bytes, tight.predicted_bytes);
  ASSERT_THAT(roomy.warnings, SizeIs(1));
  EXPECT_THAT(roomy.warnings[0], testing::HasSubstr("values of faces make "));
}

TEST_F(FaceValuesTest, TheyAreChosenByName) {
  put("a.ply", fan(PlyEncoding::ascii, {{"label", PlyType::u8, {1, 2}},
                                        {"flags", PlyType::i32, {4, 5}},
                                        {"quality", PlyType::f32, {0.5, 0.25}}}));
  const Imported all = import();
  EXPECT_THAT(all.layout.values, SizeIs(2));
  EXPECT_THAT(all.summary.unused, ElementsAre("face.flags"));
  const Imported named =
      import({.attributes = {.which = AttributeChoice::Which::named, .names = {"quality"}}});
  EXPECT_THAT(named.layout.values, ElementsAre(ScalarAttribute{"quality", ValueType::f32, false}));
  const Imported none = import({.attributes = {.which = AttributeChoice::Which::none}});
  EXPECT_THAT(none.summary.files, IsEmpty()) << "read where it lies";
  EXPECT_THAT(none.summary.unused, ElementsAre("face.label", "face.flags", "face.quality"));
}

TEST_F(FaceValuesTest, ANormalInTwoSpellingsIsNoValue) {
  std::vector<Property> properties{{"heat", PlyType::f32, {0.5, 0.25}}};
  for (const char* name : {"nx", "ny", "nz", "normal_x", "normal_y", "normal_z"})
    properties.push_back({name, PlyType::f32, {0, 1}});
  put("a.ply", fan(PlyEncoding::ascii, properties));
  EXPECT_THAT(import().layout.values, ElementsAre(ScalarAttribute{"heat", ValueType::f32, false}));
}

TEST_F(FaceValuesTest, VerticesComeFirst) {
  put("a.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "property uchar label\nproperty float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty int label\nproperty int part\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n"
      "0 0 0 0 0 1 11 0.5 0.75\n1 0 0 0 0 1 12 0 0\n1 1 0 0 0 1 13 0 0\n0 1 1 0 0 1 14 0 0\n"
      "9 9 9 0 0 1 15 0 0\n3 0 1 2 99 70000 1 2 3 250 1 2\n3 1 2 3\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.layout.values, ElementsAre(ScalarAttribute{"label", ValueType::u8, true},
                                              ScalarAttribute{"part", ValueType::i32, true}));
  EXPECT_THAT(mesh.summary.unused, ElementsAre("face.label", "face.nx", "face.ny", "face.nz"));
  EXPECT_THAT(of_triangles(mesh, 1), ElementsAre(70000, 0)) << "of a strip";
  EXPECT_THAT(mesh.values(0), ElementsAre(11, 12, 12, 13, 13, 14, 15)) << "all in their order";
  EXPECT_EQ(mesh.values(1).back(), 0) << "of no triangle";
  const std::vector<float> first(mesh.attributes.begin(), mesh.attributes.begin() + 11);
  const std::vector<float> start{0, 0, 1, 250, 1, 2, 11};
  EXPECT_EQ(std::vector<float>(first.begin(), first.begin() + 7), start);
  EXPECT_EQ(first[9], 0.5F);
  EXPECT_EQ(first[10], 0.75F);
}

TEST_F(FaceValuesTest, PicturesAndValuesAreBothThere) {
  put("a.png", "");
  put("a.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property short part\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
      "3 0 1 2 6 0 0 1 0 1 1 -7\n3 0 2 3 6 0 0 1 1 0 1 8\n");
  const Imported mesh = import();
  EXPECT_THAT(mesh.all_shown(), ElementsAre("a.png 0 1, 1 1, 1 0", "a.png 0 1, 1 0, 0 0"));
  EXPECT_THAT(of_triangles(mesh, 0), ElementsAre(-7, 8));
  EXPECT_EQ(mesh.count("split_vertices"), 2U) << "at one place of the picture";
}

}  // namespace
}  // namespace meshhier::importing
