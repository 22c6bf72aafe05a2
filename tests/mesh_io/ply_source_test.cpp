// Tests that PLY files give the same mesh in every encoding, type and order.
#include "mesh_io/ply_source.h"

#include "hierarchy/scalar_value.h"
#include "mesh_io/polygon_cut.h"
#include "ply_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using Corners = std::array<std::uint32_t, 3>;

const std::vector<Vec3d> kPositions{{1, 2, 3}, {10, 2, 3}, {1, 20, 3}, {1, 2, 30}};
const std::vector<Corners> kTriangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

void expect_tetrahedron(const Bytes& bytes) {
  const ReadMesh mesh = read_bytes(bytes);
  EXPECT_EQ(mesh.positions, kPositions);
  EXPECT_EQ(mesh.triangles, kTriangles);
  EXPECT_EQ(mesh.counts.faces, 4U);
  EXPECT_EQ(mesh.counts.degenerate_triangles, 0U);
}

TEST(PlySource, EveryCoordinateCountAndIndexTypeInEveryEncoding) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const PlyType coordinate : kTypes) {
      for (const PlyType count : kTypes) {
        for (const PlyType index : kTypes) {
          if (!is_integer(count) || !is_integer(index))
            continue;
          SCOPED_TRACE(fmt::format("{} {} {} {}", name_of(encoding), name_of(coordinate),
                                   name_of(count), name_of(index)));
          expect_tetrahedron(tetrahedron(encoding, coordinate, count, index));
        }
      }
    }
  }
}

/// Arrows whose first corner is behind their tip: the second diagonal cuts them.
TEST(PlySource, PolygonsAreCutByTheirShapeInEveryEncoding) {
  constexpr int kArrows = 300;  // more vertices than are looked up at once
  for (const PlyEncoding encoding : kEncodings) {
    for (const bool has_lists : {false, true}) {
      PlyText ply(encoding);
      ply.line(fmt::format("element vertex {}", 4 * kArrows));
      for (const char* axis : {"x", "y", "z"})
        ply.line(fmt::format("property double {}", axis));
      if (has_lists)
        ply.line("property list uchar uchar more");
      ply.line(fmt::format("element face {}", kArrows));
      ply.line("property list uchar int vertex_indices").end_header();
      for (int arrow = 0; arrow < kArrows; ++arrow) {
        for (const auto& [x, y] :
             std::vector<std::array<double, 2>>{{0, 0}, {2, 1}, {0, 2}, {0.5, 1}}) {
          for (const double value : {x + arrow, y, 0.0})
            ply.value(PlyType::f64, value);
          if (has_lists)
            ply.value(PlyType::u8, 0);
          ply.end_row();
        }
      }
      std::vector<Corners> expected;
      for (int i = 0; i < kArrows; ++i) {
        const int arrow = i * 7 % kArrows;  // not in their order
        const double a = 4.0 * arrow;
        ply.list(PlyType::u8, PlyType::i32, {a, a + 1, a + 2, a + 3});
        const auto corner = [&](int k) { return static_cast<std::uint32_t>(4 * arrow + k); };
        expected.push_back({corner(3), corner(0), corner(1)});
        expected.push_back({corner(1), corner(2), corner(3)});
      }
      const ReadMesh mesh = read_bytes(ply.bytes());
      EXPECT_EQ(mesh.counts.polygons.concave, static_cast<std::uint64_t>(kArrows));
      ASSERT_EQ(mesh.triangles.size(), expected.size());
      const auto sorted = [](std::vector<Corners> all) {
        for (Corners& t : all)
          std::ranges::rotate(t, std::ranges::min_element(t));
        std::ranges::sort(all);
        return all;
      };
      EXPECT_EQ(sorted(mesh.triangles), sorted(expected)) << name_of(encoding) << has_lists;
    }
  }
}

TEST(PlySource, PolygonsOfVerticesThatCannotBeReadFailAgainAndAgain) {
  MemoryFiles files;
  files.put("a.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "end_header\n0 0 0\n2 1 0\n0 x 0\n1 1 0\n4 0 1 2 3\n");
  const auto source = open_mesh(files, "a.ply");
  for (int time = 0; time < 3; ++time)
    EXPECT_THROW(source->read_triangles([](std::span<const Triangle<VertexId>>) {}), Error);
}

TEST(PlySource, Description) {
  const ReadMesh text = read_bytes(tetrahedron(PlyEncoding::ascii));
  EXPECT_EQ(text.description.format, "PLY ASCII");
  EXPECT_FALSE(text.description.vertices_in_place);
  const Bytes bytes = tetrahedron(PlyEncoding::big_endian);
  const ReadMesh big = read_bytes(bytes);
  EXPECT_EQ(big.description.format, "PLY binary big endian");
  EXPECT_EQ(big.description.file_bytes, bytes.size());
  EXPECT_EQ(big.description.vertex_count, 4U);
  EXPECT_EQ(big.description.face_count, 4U);
  EXPECT_TRUE(big.description.vertices_in_place);
  EXPECT_EQ(big.description.attributes, AttributeLayout{});
  for (const PlyType type : kTypes) {
    const bool wide = type == PlyType::f64 || type == PlyType::i32 || type == PlyType::u32;
    const ReadMesh mesh = read_bytes(tetrahedron(PlyEncoding::little_endian, type));
    EXPECT_EQ(mesh.description.wide_coordinates, wide) << name_of(type);
  }
}

TEST(PlySource, LargeAndPreciseCoordinatesAreExact) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply(encoding);
    ply.line("element vertex 2").line("property double x").line("property uint y");
    ply.line("property int z").end_header();
    for (const double sign : {1.0, -1.0}) {
      ply.value(PlyType::f64, sign * 4321987.123456789).value(PlyType::u32, 4294967295.0);
      ply.value(PlyType::i32, sign * 2147483647.0).end_row();
    }
    const ReadMesh mesh = read_bytes(ply.bytes());
    EXPECT_EQ(mesh.positions,
              (std::vector<Vec3d>{{4321987.123456789, 4294967295.0, 2147483647.0},
                                  {-4321987.123456789, 4294967295.0, -2147483647.0}}));
  }
}

/// Extra scalars and lists before, between and behind what is read, extra elements around it.
Bytes decorated(PlyEncoding encoding, bool faces_first) {
  constexpr auto kByte = PlyType::u8;
  constexpr auto kFloat = PlyType::f32;
  PlyText ply(encoding);
  const auto declare_faces = [&] {
    ply.line("element face 4").line("property uchar material");
    ply.line("property list ushort double weights");
    ply.line("property list uchar int vertex_index").line("property list char short extra");
    ply.line("property double area");
  };
  ply.line("comment made by a test").line("element camera 2").line("property float focal");
  ply.line("property list uchar uchar name");
  if (faces_first)
    declare_faces();
  ply.line("obj_info anything").line("element vertex 4").line("property list uchar float before");
  ply.line("property float z").line("property ushort flags").line("property float x");
  ply.line("property float y").line("property list int double behind");
  if (!faces_first)
    declare_faces();
  ply.line("element edge 1").line("property int vertex1").line("property int vertex2");
  ply.line("comment the end").end_header();
  const auto write_faces = [&] {
    for (const Corners& t : kTriangles) {
      ply.value(kByte, 9).value(PlyType::u16, 2).value(PlyType::f64, 0.5).value(PlyType::f64, 1.5);
      ply.value(kByte, 3);
      for (const std::uint32_t corner : t)
        ply.value(PlyType::i32, corner);
      ply.value(PlyType::i8, 1).value(PlyType::i16, -7).value(PlyType::f64, 0.25).end_row();
    }
  };
  ply.value(kFloat, 1).value(kByte, 0).end_row();
  ply.value(kFloat, 2).value(kByte, 2).value(kByte, 65).value(kByte, 66).end_row();
  if (faces_first)
    write_faces();
  for (std::size_t i = 0; i < kPositions.size(); ++i) {
    const Vec3d p = kPositions[i];
    ply.value(kByte, static_cast<double>(i));
    for (std::size_t k = 0; k < i; ++k)
      ply.value(kFloat, 0.5);
    ply.value(kFloat, p.z).value(PlyType::u16, 1).value(kFloat, p.x).value(kFloat, p.y);
    ply.value(PlyType::i32, 1).value(PlyType::f64, -1).end_row();
  }
  if (!faces_first)
    write_faces();
  return ply.row(PlyType::i32, {0, 1}).bytes();
}

TEST(PlySource, WhatIsNotKnownIsSkippedAndElementsComeInAnyOrder) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const bool faces_first : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", name_of(encoding), faces_first));
      expect_tetrahedron(decorated(encoding, faces_first));
    }
  }
}

TEST(PlySource, ScalarsAroundTriangleListsKeepTheFastPathRight) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply(encoding);
    ply.line("element face 5").line("property short group");
    ply.line("property list uchar uint vertex_indices").line("property uchar red");
    ply.line("element vertex 6").line("property float x").line("property float y");
    ply.line("property float z").end_header();
    const std::vector<std::vector<double>> faces{
        {0, 1, 2}, {3, 4, 5, 0}, {1, 2, 3}, {4, 4, 5}, {5, 0, 1}};
    for (const auto& face : faces) {
      ply.value(PlyType::i16, -3).value(PlyType::u8, static_cast<double>(face.size()));
      for (const double corner : face)
        ply.value(PlyType::u32, corner);
      ply.value(PlyType::u8, 255).end_row();
    }
    for (int i = 0; i < 6; ++i)
      ply.row(PlyType::f32, {0.5 * i, 0, 0});
    const ReadMesh mesh = read_bytes(ply.bytes());
    EXPECT_EQ(mesh.triangles,
              (std::vector<Corners>{{0, 1, 2}, {3, 4, 5}, {3, 5, 0}, {1, 2, 3}, {5, 0, 1}}));
    EXPECT_EQ(mesh.counts.faces, 5U);
    EXPECT_EQ(mesh.counts.degenerate_triangles, 1U);
    EXPECT_FALSE(mesh.description.vertices_in_place);
  }
}

TEST(PlySource, TriangleStripsWithRestartsOfEverySignedType) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const PlyType index : {PlyType::i8, PlyType::i16, PlyType::i32, PlyType::u32}) {
      PlyText ply(encoding);
      ply.line("element vertex 5").line("property float x").line("property float y");
      ply.line("property float z").line("element tristrips 1");
      ply.line(fmt::format("property list int {} vertex_indices", name_of(index))).end_header();
      for (int i = 0; i < 5; ++i)
        ply.row(PlyType::f32, {1.0 * i, 0, 0});
      const double restart = index == PlyType::u32 ? 4294967295.0 : -1;
      ply.list(PlyType::i32, index, {0, 1, 2, 3, restart, 4, 3, 2, restart});
      const ReadMesh mesh = read_bytes(ply.bytes());
      EXPECT_EQ(mesh.triangles, (std::vector<Corners>{{0, 1, 2}, {2, 1, 3}, {4, 3, 2}}));
      EXPECT_EQ(mesh.description.face_count, 1U);
    }
  }
}

TEST(PlySource, FacesAndStripsTogetherComeInFileOrder) {
  PlyText ply(PlyEncoding::ascii);
  ply.line("element tristrips 1").line("property list int int vertex_indices");
  ply.line("element vertex 4").line("property float x").line("property float y");
  ply.line("property float z").line("element face 1");
  ply.line("property list uchar int vertex_indices").end_header();
  ply.line("4 0 1 2 3").line("0 0 0").line("1 0 0").line("0 1 0").line("0 0 1").line("3 3 2 1");
  const ReadMesh mesh = read_bytes(ply.bytes());
  EXPECT_EQ(mesh.triangles, (std::vector<Corners>{{0, 1, 2}, {2, 1, 3}, {3, 2, 1}}));
  EXPECT_EQ(mesh.counts.faces, 2U);
}

struct AttributeCase {
  std::vector<std::string> properties;  ///< behind x y z
  std::vector<PlyType> types;
  std::vector<double> values;
  AttributeLayout layout;
  std::vector<float> expected;
};

AttributeLayout layout_of(bool normals, ColourType colour, bool alpha, bool texcoords) {
  AttributeLayout layout;
  layout.normals = normals;
  layout.colour = colour;
  layout.alpha = alpha;
  layout.texcoords = texcoords;
  return layout;
}

std::vector<AttributeCase> attribute_cases() {
  using enum PlyType;
  const auto none = ColourType::none;
  return {
      {{"nx", "ny", "nz"},
       {f32, f32, f32},
       {0, -1, 0.5},
       layout_of(true, none, false, false),
       {0, -1, 0.5}},
      {{"nz", "nx", "ny"},
       {f64, f64, f64},
       {3, 1, 2},
       layout_of(true, none, false, false),
       {1, 2, 3}},
      {{"nx", "ny"}, {f32, f32}, {1, 2}, {}, {}},
      {{"red", "green", "blue"},
       {u8, u8, u8},
       {0, 128, 255},
       layout_of(false, ColourType::u8, false, false),
       {0, 128, 255}},
      {{"alpha", "blue", "green", "red"},
       {u8, u8, u8, u8},
       {4, 3, 2, 1},
       layout_of(false, ColourType::u8, true, false),
       {1, 2, 3, 4}},
      {{"red", "green", "blue", "alpha"},
       {u16, u16, u16, u16},
       {0, 1, 65535, 9},
       layout_of(false, ColourType::u16, true, false),
       {0, 1, 65535, 9}},
      {{"r", "g", "b", "a"},
       {f32, f32, f32, f32},
       {0.25, 0.5, 1, 0},
       layout_of(false, ColourType::f32, true, false),
       {0.25, 0.5, 1, 0}},
      {{"red", "green", "blue"},
       {f64, f64, f64},
       {0.1, 0.5, 1},
       layout_of(false, ColourType::f32, false, false),
       {0.1F, 0.5, 1}},
      {{"red", "green", "blue"},
       {i32, i32, i32},
       {0, 128, 255},
       layout_of(false, ColourType::u8, false, false),
       {0, 128, 255}},
      {{"diffuse_red", "diffuse_green", "diffuse_blue", "alpha"},
       {u8, u8, u8, u8},
       {1, 2, 3, 4},
       layout_of(false, ColourType::u8, true, false),
       {1, 2, 3, 4}},
      {{"red", "green", "blue", "alpha"},
       {u8, u8, u8, f32},
       {1, 2, 3, 0.5},
       layout_of(false, ColourType::u8, false, false),
       {1, 2, 3}},
      {{"red", "green", "blue"}, {u8, u8, f32}, {1, 2, 0.5}, {}, {}},
      {{"red", "green", "alpha"}, {u8, u8, u8}, {1, 2, 3}, {}, {}},
      {{"s", "t"}, {f32, f32}, {0.25, -3}, layout_of(false, none, false, true), {0.25, -3}},
      {{"v", "u"}, {f64, f64}, {1, 2}, layout_of(false, none, false, true), {2, 1}},
      {{"texture_u", "texture_v"}, {f32, f32}, {1, 2}, layout_of(false, none, false, true), {1, 2}},
      {{"texture_s", "texture_t"}, {f32, f32}, {1, 2}, layout_of(false, none, false, true), {1, 2}},
      {{"s", "v"}, {f32, f32}, {1, 2}, {}, {}},
      {{"s", "t", "blue", "quality", "nx", "green", "ny", "red", "nz"},
       {f32, f32, u8, f32, f32, u8, f32, u8, f32},
       {8, 9, 7, 99, 1, 6, 2, 5, 3},
       layout_of(true, ColourType::u8, false, true),
       {1, 2, 3, 5, 6, 7, 8, 9}},
  };
}

TEST(PlySource, AttributesInEveryEncoding) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const AttributeCase& c : attribute_cases()) {
      SCOPED_TRACE(fmt::format("{} {}", name_of(encoding), fmt::join(c.properties, " ")));
      PlyText ply(encoding);
      ply.line("element vertex 2").line("property float x").line("property float y");
      ply.line("property float z");
      for (std::size_t i = 0; i < c.types.size(); ++i) {
        ply.line(fmt::format("property {} {}", name_of(c.types[i]), c.properties[i]));
      }
      ply.end_header();
      for (int row = 0; row < 2; ++row) {
        for (int axis = 0; axis < 3; ++axis)
          ply.value(PlyType::f32, row);
        for (std::size_t i = 0; i < c.types.size(); ++i)
          ply.value(c.types[i], c.values[i]);
        ply.end_row();
      }
      const ReadMesh mesh = read_bytes(ply.bytes(), {.which = AttributeChoice::Which::none});
      EXPECT_EQ(mesh.description.attributes, c.layout);
      std::vector<float> twice = c.expected;
      twice.insert(twice.end(), c.expected.begin(), c.expected.end());
      EXPECT_EQ(mesh.attributes, twice);
    }
  }
}

// As programs write them for vertices of faces without an area.
TEST(PlySource, NormalsAndTextureCoordinatesThatAreNoNumbersAreZero) {
  const double none = std::nan("");
  for (const PlyEncoding encoding : kEncodings) {
    // A list behind the vertex takes another path than rows of one length.
    for (const bool has_list : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", name_of(encoding), has_list));
      PlyText ply(encoding);
      ply.line("element vertex 3");
      for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "s", "t"})
        ply.line(fmt::format("property float {}", name));
      if (has_list)
        ply.line("property list uchar uchar more");
      ply.end_header();
      for (const std::vector<double>& row : std::vector<std::vector<double>>{
               {1, 2, 3, 0, none, 1, 0.5, 0.25},
               {1, 2, 3, 0, 0, 1, -std::numeric_limits<double>::infinity(), 0.25},
               {1, 2, 3, none, none, none, none, none}}) {
        for (const double value : row)
          ply.value(PlyType::f32, value);
        if (has_list)
          ply.list(PlyType::u8, PlyType::u8, {});
        ply.end_row();
      }
      EXPECT_EQ(read_bytes(ply.bytes()).attributes,
                (std::vector<float>{0, 0, 0, 0.5, 0.25, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}));
    }
  }
}

TEST(PlySource, HeadersWithEveryLineEnd) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const std::string line_end : {"\n", "\r\n", "\r"}) {
      PlyText ply(encoding, line_end);
      ply.line("element vertex 1").line("property uchar x").line("property uchar y");
      ply.line("property uchar z").end_header();
      ply.row(PlyType::u8, {10, 13, 10});  // in binary: LF, CR, LF right behind the header
      EXPECT_EQ(read_bytes(ply.bytes()).positions, (std::vector<Vec3d>{{10, 13, 10}}));
    }
  }
}

TEST(PlySource, TextWithTabsBlankLinesSignsAndExponents) {
  const Bytes header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty double y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const ReadMesh mesh = read_bytes(
      header + "\n\t+1e0  -2.5E+1\t.5 \r\n\r\n   0 7. 1e-50\n1\t1\t1\n\n  +3 0\t+1 2  \n\n \t\r\n");
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{1, -25, 0.5}, {0, 7, 0}, {1, 1, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Corners>{{0, 1, 2}}));
}

TEST(PlySource, WhatMayFollowTheData) {
  expect_tetrahedron(tetrahedron(PlyEncoding::ascii) + "\n \t\r\n\r\n");
  for (const PlyEncoding encoding : {PlyEncoding::little_endian, PlyEncoding::big_endian}) {
    for (const Bytes& end : {Bytes("\n"), Bytes("\r\n"), Bytes("\0\n", 2), Bytes("\0\0\n", 3)}) {
      expect_tetrahedron(tetrahedron(encoding) + end);
    }
  }
}

OddSyntax odd_of(const Bytes& bytes) {
  MemoryFiles files;
  files.put("m", bytes);
  const auto source = open_mesh(files, "m");
  read_mesh(*source);  // several times
  return source->odd_syntax();
}

TEST(PlySource, SmallSinsOfATextAreReadAndCounted) {
  const Bytes whole = tetrahedron(PlyEncoding::ascii);
  EXPECT_EQ(odd_of(whole), OddSyntax());
  EXPECT_EQ(odd_of(whole + Bytes(1, '\0')), OddSyntax{.bytes_behind = 1});
  expect_tetrahedron(whole.substr(0, whole.size() - 1) + Bytes(5000, '\0'));
  EXPECT_EQ(odd_of(whole + "end of file\n\n{}\n"), OddSyntax{.lines_behind = 2});
  EXPECT_EQ(odd_of(whole + "0\n"), OddSyntax{.lines_behind = 1});
  expect_tetrahedron(whole + "end of file");
  EXPECT_EQ(odd_of("\n\n" + whole), OddSyntax{.header_lines = 1});
  expect_tetrahedron("\xEF\xBB\xBF" + whole);
}

TEST(PlySource, IntegersMayBeWrittenAsFloats) {
  const Bytes header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const Bytes rows = "0 0 0 200.0 1e2 0\n1 0 0 1 2 3\n0 1 0 1 2 3.000\n3.0 0 1.0 2\n";
  const ReadMesh mesh = read_bytes(header + rows);
  EXPECT_EQ(mesh.attributes, (std::vector<float>{200, 100, 0, 1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(mesh.triangles, (std::vector<Corners>{{0, 1, 2}}));
  EXPECT_EQ(odd_of(header + rows), OddSyntax{.integers = 5});
  EXPECT_THAT(error_of(header + "0 0 0 200.5 1 1\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n"),
              ::testing::HasSubstr("expected an integer from 0 to 255"));
}

TEST(PlySource, RowsMayGoOnInTheNextLine) {
  const Bytes header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property int tag\nend_header\n";
  for (const char* rows : {"0 0\n0\n1\n0\n\n0\n0 1 0\n3\n0 1\n2 7\n",
                           "0\r\n0 0\r\n1 0 \r\n 0\r\n0 1 0\r\n3 0 1\r\n2\r\n7"}) {
    const ReadMesh mesh = read_bytes(header + rows, {.which = AttributeChoice::Which::none});
    EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << rows;
    EXPECT_EQ(mesh.triangles, (std::vector<Corners>{{0, 1, 2}})) << rows;
    EXPECT_EQ(odd_of(header + rows), OddSyntax{.broken_rows = 3}) << rows;
  }
  EXPECT_THAT(error_of(header + "0 0\n1 0 0\n0 1 0\n3 0 1 2 7\n"),
              ::testing::HasSubstr("line 11: expected a number for 'z' in row 0"))
      << "a number is missing";
}

TEST(PlySource, IntegersOf64BitsInEveryEncoding) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const PlyType type : {PlyType::i64, PlyType::u64}) {
      PlyText ply(encoding);
      ply.line("element vertex 3").line("property " + std::string(name_of(type)) + " x");
      ply.line("property float y").line("property float z");
      ply.line("property " + std::string(name_of(type)) + " id").line("element face 1");
      ply.line("property list " + std::string(name_of(type)) + " " + std::string(name_of(type)) +
               " vertex_indices");
      ply.end_header();
      for (const double x : {0.0, 1.0, 9007199254740994.0}) {
        ply.value(type, x).value(PlyType::f32, x == 1 ? 1 : 0).value(PlyType::f32, 0);
        ply.value(type, x == 0 ? 9007199254740996.0 : 7).end_row();
      }
      ply.list(type, type, {0, 1, 2});
      const ReadMesh mesh = read_bytes(ply.bytes());
      EXPECT_EQ(mesh.positions[2].x, 9007199254740994.0);
      EXPECT_EQ(mesh.triangles, (std::vector<Corners>{{0, 1, 2}}));
      ASSERT_EQ(mesh.description.attributes.values.size(), 1U);
      EXPECT_EQ(mesh.description.attributes.values[0].type, ValueType::f64);
      EXPECT_TRUE(mesh.description.attributes.values[0].is_label);
      EXPECT_EQ(value_in(ValueType::f64, mesh.attributes.data()), 9007199254740996.0);
      MemoryFiles files;
      files.put("m", ply.bytes());
      const auto source = open_mesh(files, "m");
      std::uint64_t rounded = 0;
      source->read_vertices([&](const VertexBlock& block) { rounded += block.zeroed.rounded; });
      EXPECT_EQ(rounded + source->odd_syntax().rounded, 2U) << name_of(encoding);
    }
  }
}

TEST(PlySource, CornersMayBeScalarsInEveryEncoding) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply(encoding);
    ply.line("element vertex 4").line("property uchar x").line("property uchar y");
    ply.line("property uchar z").line("element face 2").line("property uchar tag");
    ply.line("property int v1").line("property int v2").line("property int v3").end_header();
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      ply.value(PlyType::u8, x).value(PlyType::u8, y).value(PlyType::u8, 0).end_row();
    for (const auto& [a, b, c] : {std::tuple{0, 1, 2}, {0, 2, 3}}) {
      ply.value(PlyType::u8, 9).value(PlyType::i32, a).value(PlyType::i32, b);
      ply.value(PlyType::i32, c).end_row();
    }
    const AttributeChoice none{.which = AttributeChoice::Which::none};
    EXPECT_EQ(read_bytes(ply.bytes(), none).triangles,
              (std::vector<Corners>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(odd_of(ply.bytes()), OddSyntax{.header_lines = 3});
  }
}

TEST(PlySource, PointCloudsAndNothingAreMeshes) {
  for (const PlyEncoding encoding : kEncodings) {
    const auto header = [&](int vertices, const std::string& faces) {
      PlyText ply(encoding);
      ply.line(fmt::format("element vertex {}", vertices)).line("property float x");
      ply.line("property float y").line("property float z");
      if (!faces.empty())
        ply.line(faces);
      return ply;
    };
    EXPECT_EQ(read_bytes(header(0, "").end_header().bytes()).positions.size(), 0U);
    EXPECT_EQ(read_bytes(header(0, "element face 0").end_header().bytes()).counts.faces, 0U);
    PlyText one = header(1, "element face 0");
    const ReadMesh mesh = read_bytes(one.end_header().row(PlyType::f32, {1, 2, 3}).bytes());
    EXPECT_EQ(mesh.positions.size(), 1U);
    EXPECT_EQ(mesh.counts.triangles, 0U);
  }
}

/// More than one block and more than one buffer, with polygons of changing size in between.
TEST(PlySource, ManyBlocksInEveryEncoding) {
  constexpr std::uint32_t kSide = 420;
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply(encoding);
    ply.line(fmt::format("element vertex {}", kSide * kSide));
    ply.line("property float x").line("property float y").line("property float z");
    ply.line("property uchar red").line("property uchar green").line("property uchar blue");
    ply.line(fmt::format("element face {}", (kSide - 1) * (kSide - 1)));
    ply.line("property list uchar int vertex_indices").end_header();
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      for (const double v : {1.0 * (i % kSide), 1.0 * (i / kSide), 0.125 * i}) {
        ply.value(PlyType::f32, v);
      }
      for (const std::uint32_t c : {i % 256, i % 255, i % 7})
        ply.value(PlyType::u8, c);
      ply.end_row();
    }
    std::vector<Corners> expected;
    for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
      for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
        const std::uint32_t a = y * kSide + x;
        expected.push_back({a, a + 1, a + kSide});
        if ((x * 7 + y) % 5 == 0) {
          expected.push_back({a, a + kSide, a + kSide + 1});
          ply.list(PlyType::u8, PlyType::i32, {1.0 * a, a + 1.0, a + 1.0 * kSide, a + 1.0 + kSide});
        } else {
          ply.list(PlyType::u8, PlyType::i32, {1.0 * a, a + 1.0, a + 1.0 * kSide});
        }
      }
    }
    const ReadMesh mesh = read_bytes(ply.bytes());
    EXPECT_EQ(mesh.triangles, expected);
    ASSERT_EQ(mesh.positions.size(), kSide * kSide);
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      ASSERT_EQ(mesh.positions[i], (Vec3d{1.0 * (i % kSide), 1.0 * (i / kSide), 0.125 * i}));
      ASSERT_EQ(mesh.attributes[3 * i + 2], static_cast<float>(i % 7));
    }
  }
}

/// A comb of so many corners, whose area is 4.5 a tooth, or is refused.
TEST(PlySource, SLOW_AHugePolygon) {
  for (const std::uint32_t corners : {100'002U, 1'000'002U}) {
    for (const PlyEncoding encoding : kEncodings) {
      PlyText ply(encoding);
      ply.line("element face 1").line("property list uint uint vertex_indices");
      ply.line(fmt::format("element vertex {}", corners)).line("property int x");
      ply.line("property int y").line("property int z").end_header();
      ply.value(PlyType::u32, corners);
      for (std::uint32_t i = 0; i < corners; ++i)
        ply.value(PlyType::u32, i);
      ply.end_row();
      ply.row(PlyType::i32, {0, -1, 0});
      for (std::uint32_t i = 0; i + 2 < corners; ++i)
        ply.row(PlyType::i32, {1.0 * i, i % 2 == 0 ? 0.0 : 10.0, 0});
      ply.row(PlyType::i32, {corners - 3.0, -1, 0});
      if (corners > PolygonCut::kMostCorners) {
        EXPECT_THAT(error_of(ply.bytes()), ::testing::HasSubstr("at most 131072 corners"));
        continue;
      }
      const ReadMesh mesh = read_bytes(ply.bytes());
      EXPECT_EQ(mesh.counts.polygons.concave, 1U);
      ASSERT_EQ(mesh.triangles.size(), corners - 2);
      double area = 0;
      for (const Corners& t : mesh.triangles) {
        const Vec3d& a = mesh.positions[t[0]];
        area += cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a).z / 2;
      }
      EXPECT_EQ(std::abs(area), 6.0 * (corners - 3)) << "the teeth and what they stand on";
    }
  }
}

/// Nothing of a polygon of which a corner is not finite is left when triangles without it are.
TEST(PlySource, APolygonWithACornerThatIsNowhereIsAFanAroundIt) {
  MemoryFiles files;
  files.put("m",
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "end_header\n0 0 0\n1 0 0\nnan 1 0\n1 1 0\n0 1 0\n5 0 1 2 3 4\n");
  const auto source = make_ply_source(files.open("m"), {.unplaced = Unplaced::visited});
  source->read_vertices([](const VertexBlock&) {});
  source->read_triangles([](std::span<const Triangle<VertexId>> triangles) {
    EXPECT_EQ(triangles.size(), 3U);
    for (const Triangle<VertexId>& t : triangles)
      EXPECT_EQ(raw(t[0]), 2U);
  });
}

/// As a bridge to a hole has them.
TEST(PlySource, APolygonOfCornersAtOnePlaceIsAFan) {
  constexpr std::uint32_t kCorners = 100'000;
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply(encoding);
    ply.line("element face 1").line("property list uint uint vertex_indices");
    ply.line(fmt::format("element vertex {}", kCorners)).line("property uchar x");
    ply.line("property uchar y").line("property uchar z").end_header();
    ply.value(PlyType::u32, kCorners);
    for (std::uint32_t i = 0; i < kCorners; ++i)
      ply.value(PlyType::u32, i);
    ply.end_row();
    for (std::uint32_t i = 0; i < kCorners; ++i)
      ply.row(PlyType::u8, {1, 2, 3});
    const ReadMesh mesh = read_bytes(ply.bytes());
    EXPECT_EQ(mesh.counts.faces, 1U);
    ASSERT_EQ(mesh.triangles.size(), kCorners - 2);
    EXPECT_EQ(mesh.triangles.back(), (Corners{0, kCorners - 2, kCorners - 1}));
  }
}

TEST(PlySource, AVisitorsExceptionPassesThrough) {
  MemoryFiles files;
  files.put("m", tetrahedron(PlyEncoding::little_endian));
  const auto source = open_mesh(files, "m");
  EXPECT_THROW(source->read_vertices([](const VertexBlock&) { throw 17; }), int);
  EXPECT_THROW(source->read_triangles([](std::span<const Triangle<VertexId>>) { throw 17; }), int);
  EXPECT_EQ(read_mesh(*source).triangles, kTriangles) << "and the source still works";
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
