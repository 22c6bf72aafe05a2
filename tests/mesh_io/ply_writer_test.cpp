#include "mesh_io/ply_writer.h"

#include "base/error.h"
#include "mesh_io/ply_source.h"
#include "ply_samples.h"

#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// `count` vertices with exactly representable numbers, and a strip-like chain of triangles.
struct Sample {
  explicit Sample(std::uint32_t count, const AttributeLayout& layout) {
    const auto channels = static_cast<std::uint32_t>(layout.channels());
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto v = static_cast<float>(i);
      positions.push_back({v * 0.25F, -v, 1e10F + v});
      for (std::uint32_t c = 0; c < channels; ++c) {
        attributes.push_back(static_cast<float>((i * 7 + c) % 256));
      }
      if (i >= 2)
        triangles.push_back({i - 2, i - 1, i});
    }
  }
  std::vector<Vec3f> positions;
  std::vector<float> attributes;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

AttributeLayout everything(ColourType colour) {
  AttributeLayout layout;
  layout.normals = true;
  layout.colour = colour;
  layout.alpha = colour != ColourType::none;
  layout.texcoords = true;
  return layout;
}

TEST(PlyWriter, WhatIsWrittenIsReadBack) {
  for (const ColourType colour :
       {ColourType::none, ColourType::u8, ColourType::u16, ColourType::f32}) {
    PlyContent content;
    content.attributes = everything(colour);
    const Sample sample(100'000, content.attributes);  // several buffers
    content.vertex_count = sample.positions.size();
    content.triangle_count = sample.triangles.size();
    MemoryFiles files;
    PlyWriter writer(files.create("out.ply"), content);
    const auto channels = static_cast<std::size_t>(content.attributes.channels());
    const std::span<const Vec3f> positions(sample.positions);
    const std::span<const float> attributes(sample.attributes);
    writer.write_vertices(positions.first(1), attributes.first(channels));
    writer.write_vertices(positions.subspan(1), attributes.subspan(channels));
    writer.write_triangles(sample.triangles);
    writer.finish();
    const ReadMesh mesh = read_mesh(*open_mesh(files, "out.ply"));
    EXPECT_EQ(mesh.description.attributes, content.attributes);
    EXPECT_EQ(mesh.description.format, "PLY binary little endian");
    EXPECT_FALSE(mesh.description.wide_coordinates);
    EXPECT_EQ(mesh.attributes, sample.attributes);
    EXPECT_EQ(mesh.triangles, sample.triangles);
    ASSERT_EQ(mesh.positions.size(), sample.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_EQ(mesh.positions[i], to_double(sample.positions[i]));
    }
  }
}

TEST(PlyWriter, DoubleCoordinatesAreExact) {
  PlyContent content;
  content.vertex_count = 2;
  content.double_coordinates = true;
  MemoryFiles files;
  PlyWriter writer(files.create("out.ply"), content);
  const std::vector<Vec3d> exact{{1.0 / 3, 1e37, -4321987.123456789}};
  const std::vector<Vec3f> single{{0.1F, 2, 3}};
  writer.write_vertices(exact, {});
  writer.write_vertices(single, {});
  writer.finish();
  const ReadMesh mesh = read_mesh(*open_mesh(files, "out.ply"));
  EXPECT_TRUE(mesh.description.wide_coordinates);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{exact[0], to_double(single[0])}));
}

/// Any file may have a property of this name, whose numbers are those of no list of ours.
TEST(PlyWriter, MaterialsAreReadOnlyByWhoAsksForThem) {
  PlyContent content;
  content.vertex_count = 2;
  content.attributes = {.texcoords = true, .material = true};
  MemoryFiles files;
  PlyWriter writer(files.create("out.ply"), content);
  const std::vector<Vec3f> positions{{1, 2, 3}, {4, 5, 6}};
  const std::vector<float> attributes{0.5F, 0.25F, 7, 1, 0, 16777215};
  writer.write_vertices(positions, attributes);
  writer.finish();
  const ReadMesh asked =
      read_mesh(*make_ply_source(files.open("out.ply"), {.writer = PlyWrittenBy::import}));
  EXPECT_EQ(asked.description.attributes, content.attributes);
  EXPECT_EQ(asked.attributes, attributes);
  const ReadMesh other = read_mesh(*open_mesh(files, "out.ply"));
  EXPECT_EQ(other.description.attributes,
            (AttributeLayout{.texcoords = true, .values = {{"material", ValueType::f32}}}));
  EXPECT_EQ(other.attributes, (std::vector<float>{7, 0.5F, 0.25F, 16777215, 1, 0}));
}

TEST(PlyWriter, LightIsReadOnlyOfWhatTheImportWrote) {
  for (const bool alpha : {false, true}) {
    for (const ColourType type : {ColourType::u8, ColourType::u16, ColourType::f32}) {
      PlyContent content;
      content.vertex_count = 1;
      content.attributes = {.colour = type, .alpha = alpha, .space = ColourSpace::linear};
      MemoryFiles files;
      PlyWriter writer(files.create("out.ply"), content);
      const std::vector<Vec3f> positions{{1, 2, 3}};
      const std::vector<float> attributes{0, 1, 0, 1};
      writer.write_vertices(positions, std::span(attributes).first(alpha ? 4 : 3));
      writer.finish();
      const ReadMesh ours =
          read_mesh(*make_ply_source(files.open("out.ply"), {.writer = PlyWrittenBy::import}));
      EXPECT_EQ(ours.description.attributes, content.attributes);
      const ReadMesh other = read_mesh(*open_mesh(files, "out.ply"));
      EXPECT_EQ(other.description.attributes.colour, ColourType::none);
    }
  }
}

/// Names of properties that the writer has itself.
TEST(PlyWriter, ValuesKeepTheirNamesUnlessTheseAreTaken) {
  PlyContent content;
  content.vertex_count = 1;
  content.attributes = {.normals = true,
                        .texcoords = true,
                        .values = {{"s", ValueType::u8},
                                   {"nx", ValueType::f64},
                                   {"nx_2", ValueType::i32},
                                   {"red", ValueType::f32}}};
  MemoryFiles files;
  PlyWriter writer(files.create("out.ply"), content);
  std::vector<float> attributes(static_cast<std::size_t>(content.attributes.channels()), 7);
  put_value(ValueType::f64, 1.0 / 3, &attributes[4]);
  put_value(ValueType::i32, -5, &attributes[6]);
  writer.write_vertices(std::vector<Vec3f>{{1, 2, 3}}, attributes);
  writer.finish();
  const ReadMesh mesh = read_mesh(*open_mesh(files, "out.ply"));
  EXPECT_EQ(mesh.attributes, attributes);
  std::vector<std::string> names;
  for (const ScalarAttribute& value : mesh.description.attributes.values)
    names.push_back(value.name);
  EXPECT_EQ(names, (std::vector<std::string>{"s_2", "nx_2", "nx_2_2", "red"}));
}

TEST(PlyWriter, HeaderAndBytes) {
  PlyContent content;
  content.vertex_count = 1;
  content.edge_count = 1;
  content.comments = {"one", "two\nelement vertex 9\rx"};
  content.attributes.colour = ColourType::u8;
  MemoryFiles files;
  PlyWriter writer(files.create("out.ply"), content);
  const std::vector<Vec3f> positions{{1, 2, 3}};
  const std::vector<float> colours{0, 127.5F, 300};
  const std::vector<std::array<std::uint32_t, 2>> edges{{0, 258}};
  writer.write_vertices(positions, colours);
  writer.write_triangles({});
  writer.write_edges(edges);
  writer.finish();
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment one\ncomment two element vertex 9 x\n"
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 0\nproperty list uchar int vertex_indices\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  const std::string data("\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40\0\x80\xff\0\0\0\0\x02\x01\0\0", 23);
  EXPECT_EQ(files.content("out.ply"), header + data);
}

TEST(PlyWriter, ManyVerticesNeedUnsignedIndices) {
  PlyContent content;
  content.vertex_count = (std::uint64_t{1} << 31) - 1;
  MemoryFiles files;
  { PlyWriter writer(files.create("int.ply"), content); }
  EXPECT_THAT(files.content("int.ply"), HasSubstr("property list uchar int vertex_indices"));
  content.vertex_count += 1;
  { PlyWriter writer(files.create("uint.ply"), content); }
  EXPECT_THAT(files.content("uint.ply"), HasSubstr("property list uchar uint vertex_indices"));
}

TEST(PlyWriter, AFullDiskIsAnIoError) {
  class FullFile final : public storage::File {
   public:
    FullFile() : File("full.ply") {}
    std::uint64_t size() const override { return 0; }
    void sync() override {}

   protected:
    std::size_t read_some(std::uint64_t, std::span<std::byte>) const override { return 0; }
    std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
      if (offset + bytes.size() > 4096)
        throw Error(ErrorCode::io, "disk full");
      return bytes.size();
    }
  };
  PlyContent content;
  content.vertex_count = 1000;
  PlyWriter writer(std::make_shared<FullFile>(), content);
  writer.write_vertices(std::vector<Vec3f>(1000), {});
  writer.write_triangles({});
  try {
    writer.finish();
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
  }
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
