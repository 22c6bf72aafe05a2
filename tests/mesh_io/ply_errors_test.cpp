// Every way a PLY file can be broken, and the one message it gets.
#include "base/error.h"
#include "mesh_io/ply_source.h"
#include "ply_samples.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PlyText vertices(PlyEncoding encoding, const std::string& count, const std::string& type) {
  PlyText ply(encoding);
  ply.line("element vertex " + count);
  for (const char axis : {'x', 'y', 'z'})
    ply.line(fmt::format("property {} {}", type, axis));
  return ply;
}

/// Two vertices, then the faces given.
PlyText with_faces(PlyEncoding encoding, int faces, const std::string& list = "list uchar int",
                   const std::string& element = "face") {
  PlyText ply = vertices(encoding, "3", "uchar");
  ply.line(fmt::format("element {} {}", element, faces));
  ply.line("property " + list + " vertex_indices").end_header();
  for (int i = 0; i < 3; ++i)
    ply.row(PlyType::u8, {1.0 * i, 2, 3});
  return ply;
}

/// "byte B" or "line L", whichever names the place in this encoding.
std::string place(PlyEncoding encoding, std::size_t byte, std::size_t line) {
  return encoding == PlyEncoding::ascii ? fmt::format("mesh.ply: line {}: ", line)
                                        : fmt::format("mesh.ply: byte {}: ", byte);
}

TEST(PlyErrors, CoordinatesThatAreNotFinite) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const PlyType type : {PlyType::f32, PlyType::f64}) {
      for (const double bad : {kNan, kInfinity, -kInfinity}) {
        PlyText ply = vertices(encoding, "3", std::string(name_of(type))).end_header();
        const std::size_t data = ply.bytes().size();
        ply.row(type, {1, 2, 3}).row(type, {4, bad, 6}).row(type, {kNan, 2, 3});
        EXPECT_EQ(error_of(ply.bytes()),
                  place(encoding, data + 4 * size_of(type), 9) +
                      fmt::format("expected a finite number as 'y' in row 1 of 3 of element "
                                  "'vertex', found {}",
                                  bad));
      }
    }
  }
}

TEST(PlyErrors, CoordinatesBetweenWhichDistancesAreNoFloats) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const auto& [type, bad] : {std::pair{PlyType::f32, 3e38},
                                    {PlyType::f32, -9e37},
                                    {PlyType::f64, 1e39},
                                    {PlyType::f64, -1e308}}) {
      PlyText ply = vertices(encoding, "2", std::string(name_of(type))).end_header();
      ply.row(type, {0x1p126, -0x1p126, 6});
      const std::size_t data = ply.bytes().size();
      ply.row(type, {1, 2, bad});
      EXPECT_THAT(error_of(ply.bytes()),
                  HasSubstr(place(encoding, data + 2 * size_of(type), 9) +
                            "expected a coordinate from -8.5e37 to 8.5e37 (2^126) as 'z' in row 1 "
                            "of 2 of element 'vertex', found "));
    }
  }
}

TEST(PlyErrors, CoordinatesThatAreNotFiniteBehindLists) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply = vertices(encoding, "2", "float").line("property list uchar int l").end_header();
    ply.value(PlyType::f32, 1).value(PlyType::f32, 1).value(PlyType::f32, 1);
    ply.value(PlyType::u8, 1).value(PlyType::i32, 1).end_row();
    const std::size_t data = ply.bytes().size();
    ply.value(PlyType::f32, 1).value(PlyType::f32, 1).value(PlyType::f32, kInfinity);
    ply.value(PlyType::u8, 0).end_row();
    EXPECT_EQ(error_of(ply.bytes()),
              place(encoding, data, 10) +
                  "expected a finite number as 'z' in row 1 of 2 of element 'vertex', found inf");
  }
}

TEST(PlyErrors, CoordinatesTooLargeForTheirType) {
  PlyText ply = vertices(PlyEncoding::ascii, "1", "float").end_header().line("1e39 0 0");
  EXPECT_THAT(error_of(ply.bytes()), HasSubstr("line 8: expected a finite number as 'x'"));
}

TEST(PlyErrors, ColoursThatAreNotFinite) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const double bad : {kNan, kInfinity}) {
      PlyText ply = vertices(encoding, "1", "float").line("property float red");
      ply.line("property float green").line("property float blue").end_header();
      const std::size_t data = ply.bytes().size();
      ply.row(PlyType::f32, {1, 2, 3, 4, 5, bad});
      EXPECT_THAT(error_of(ply.bytes()),
                  HasSubstr(place(encoding, data + (encoding == PlyEncoding::ascii ? 0 : 20), 11) +
                            "expected a finite number as 'blue'"));
    }
  }
}

TEST(PlyErrors, ColoursOutOfRange) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const double bad : {-1.0, 256.0}) {
      PlyText ply = vertices(encoding, "2", "float").line("property int red");
      ply.line("property int green").line("property int blue").end_header();
      const std::size_t data = ply.bytes().size();
      for (const double green : {3.0, bad}) {
        for (int i = 0; i < 3; ++i)
          ply.value(PlyType::f32, 1);
        ply.value(PlyType::i32, 1).value(PlyType::i32, green).value(PlyType::i32, 1).end_row();
      }
      EXPECT_EQ(error_of(ply.bytes()),
                place(encoding, data + 24 + 16, 12) +
                    fmt::format("expected an integer from 0 to 255 as 'green' in row 1 of 2 of "
                                "element 'vertex', found {}",
                                bad));
    }
  }
}

TEST(PlyErrors, IndicesOutOfRange) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const double bad : {3.0, -1.0, -2.0, 2147483647.0}) {
      PlyText ply = with_faces(encoding, 2);
      ply.list(PlyType::u8, PlyType::i32, {0, 1, 2});
      const std::size_t data = ply.bytes().size();
      ply.list(PlyType::u8, PlyType::i32, {0, bad, 2});
      EXPECT_EQ(error_of(ply.bytes()),
                place(encoding, data + 5, 14) +
                    fmt::format("expected a vertex index below 3, the number of vertices, in row "
                                "1 of 2 of element 'face', found {}",
                                bad));
    }
  }
}

TEST(PlyErrors, IndicesOutOfRangeInPolygonsAndStrips) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText polygon = with_faces(encoding, 1, "list ushort short");
    polygon.list(PlyType::u16, PlyType::i16, {0, 1, 2, 7});
    EXPECT_THAT(error_of(polygon.bytes()), HasSubstr("vertex index below 3"));
    for (const double bad : {3.0, -2.0}) {
      PlyText strip = with_faces(encoding, 1, "list int int", "tristrips");
      strip.list(PlyType::i32, PlyType::i32, {0, 1, -1, bad});
      EXPECT_THAT(error_of(strip.bytes()), HasSubstr(fmt::format("found {}", bad)));
    }
  }
}

TEST(PlyErrors, FacesWithoutVertices) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText ply = vertices(encoding, "0", "float").line("element face 1");
    ply.line("property list uchar int vertex_indices").end_header();
    ply.list(PlyType::u8, PlyType::i32, {0, 0, 0});
    EXPECT_THAT(error_of(ply.bytes()), HasSubstr("vertex index below 0"));
  }
}

TEST(PlyErrors, ListCounts) {
  for (const PlyEncoding encoding : kEncodings) {
    PlyText negative = with_faces(encoding, 1, "list char int");
    const std::size_t data = negative.bytes().size();
    negative.value(PlyType::i8, -3);
    for (const double corner : {0.0, 1.0, 2.0})
      negative.value(PlyType::i32, corner);
    EXPECT_THAT(error_of(negative.end_row().bytes()),
                HasSubstr(place(encoding, data, 13) +
                          "expected the length of list 'vertex_indices' in row 0 of 1 of element "
                          "'face' from 0 to 3, as many as fit"));
    PlyText huge = with_faces(encoding, 1, "list uint int");
    huge.value(PlyType::u32, 4294967295.0);
    for (const double corner : {0.0, 1.0, 2.0})
      huge.value(PlyType::i32, corner);
    EXPECT_THAT(error_of(huge.end_row().bytes()),
                HasSubstr("found 4294967295 (truncated or damaged)"));
  }
}

TEST(PlyErrors, TextNumbers) {
  const auto vertex_row = [](const std::string& type, const std::string& row) {
    return error_of(vertices(PlyEncoding::ascii, "1", type).end_header().line(row).bytes());
  };
  EXPECT_EQ(vertex_row("float", "1 abc 3"),
            "mesh.ply: line 8: expected a number ('float') for 'y' in row 0 of 1 of element "
            "'vertex', found 'abc'");
  for (const char* type : {"float", "double", "int"}) {
    EXPECT_THAT(vertex_row(type, "1 2,5 3"),
                HasSubstr("found '2,5' (numbers have a decimal point, not a comma"));
  }
  EXPECT_THAT(vertex_row("uchar", "1 256 3"),
              HasSubstr("expected an integer from 0 to 255 ('uchar') for 'y'"));
  EXPECT_THAT(vertex_row("char", "1 2 -129"), HasSubstr("from -128 to 127 ('char') for 'z'"));
  EXPECT_THAT(vertex_row("uint", "-1 2 3"), HasSubstr("from 0 to 4294967295 ('uint') for 'x'"));
  EXPECT_THAT(vertex_row("int", "1.5 2 3"), HasSubstr("from -2147483648 to 2147483647 ('int')"));
  EXPECT_THAT(vertex_row("float", "1 2 " + std::string(5000, '1')),
              HasSubstr("found a word of more than 4096 bytes"));
  PlyText face = with_faces(PlyEncoding::ascii, 1).line("3 0 1.5 2");
  EXPECT_THAT(error_of(face.bytes()), HasSubstr("line 13: expected an integer from"));
  PlyText count = with_faces(PlyEncoding::ascii, 1).line("x 0 1 2");
  EXPECT_THAT(error_of(count.bytes()), HasSubstr("for 'vertex_indices' in row 0 of 1"));
}

TEST(PlyErrors, TextRowsThatContradictTheHeader) {
  const Bytes header = vertices(PlyEncoding::ascii, "2", "float").end_header().bytes();
  EXPECT_EQ(error_of(header + "1 2 3 4\n5 6 7 8\n"),
            "mesh.ply: line 8: expected the end of the line behind row 0 of 2 of element "
            "'vertex', found '4' (the row has more numbers than the header declares)");
  EXPECT_EQ(error_of(header + "1 2 3\n\n5 6\n7 8\n"),
            "mesh.ply: line 10: expected a number for 'z' in row 1 of 2 of element 'vertex', found "
            "the end of the line (the row has fewer numbers than the header declares)");
  EXPECT_THAT(error_of(header + "1 2 3  \r\n5 6"), HasSubstr("line 9: expected a number for 'z'"));
  EXPECT_THAT(error_of(header + "1 2 3  \r\n5 6"), HasSubstr("found the end of the file"));
  PlyText face = with_faces(PlyEncoding::ascii, 2).line("3 0 1").line("2 3 0 1 2");
  EXPECT_THAT(error_of(face.bytes()), HasSubstr("line 13: expected a number"));
}

TEST(PlyErrors, Truncated) {
  const Bytes text = vertices(PlyEncoding::ascii, "2", "float").end_header().bytes();
  EXPECT_EQ(error_of(text + "100 200 300\n"),
            "mesh.ply: line 9: expected row 1 of 2 of element 'vertex', found the end of the file "
            "(truncated, or the count in the header is wrong)");
  EXPECT_THAT(error_of(text + "1 2 3"),
              HasSubstr(fmt::format("byte {}: expected 2 rows of element 'vertex' with at least 6 "
                                    "bytes each, found the end of the file 5 bytes after",
                                    text.size() + 5)));
  const Bytes whole = tetrahedron(PlyEncoding::little_endian);
  EXPECT_EQ(error_of(whole.substr(0, whole.size() - 1)),
            fmt::format("mesh.ply: byte {}: expected the length of list 'vertex_indices' in row 3 "
                        "of 4 of element 'face' from 0 to 2, as many as fit into the rest of the "
                        "file, found 3 (truncated or damaged)",
                        whole.size() - 13));
}

TEST(PlyErrors, ATruncatedFileIsToldAsSuchHoweverOftenItIsRead) {
  // Where the vertices begin is known only behind a list, and they do not end within the file.
  for (const PlyEncoding encoding : {PlyEncoding::little_endian, PlyEncoding::big_endian}) {
    PlyText ply(encoding);
    ply.line("element other 1").line("property list uchar uchar tags").line("element vertex 2");
    ply.line("property float x").line("property float y").line("property float z");
    ply.line("element face 1").line("property list uchar int vertex_indices").end_header();
    ply.list(PlyType::u8, PlyType::u8, {1, 2, 3, 4, 5, 6, 7, 8});
    ply.row(PlyType::f32, {1, 2, 3}).row(PlyType::f32, {4, 5});
    MemoryFiles files;
    files.put("m", ply.bytes());
    const auto source = open_mesh(files, "m");
    const auto told = [](const auto& read) {
      try {
        read();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        return std::string(error.what());
      }
      return std::string("none");
    };
    const auto read_faces = [&] {
      source->read_triangles([](std::span<const Triangle<VertexId>>) {});
    };
    const std::string first = told(read_faces);
    EXPECT_THAT(first, HasSubstr("(truncated)"));
    EXPECT_THAT(told([&] { source->read_vertices([](const VertexBlock&) {}); }),
                HasSubstr("(truncated)"));
    EXPECT_EQ(told(read_faces), first);
  }
}

TEST(PlyErrors, NoWholeVertexBehindALongList) {
  for (const PlyEncoding encoding : {PlyEncoding::little_endian, PlyEncoding::big_endian}) {
    PlyText ply(encoding);
    ply.line("element other 1").line("property list uchar uchar tags").line("element vertex 1");
    ply.line("property double x").line("property double y").line("property double z").end_header();
    ply.list(PlyType::u8, PlyType::u8, {1, 2, 3, 4, 5, 6, 7, 8}).row(PlyType::f64, {1, 2});
    EXPECT_THAT(error_of(ply.bytes()), HasSubstr("found the end of the file after 16 (truncated)"));
  }
}

TEST(PlyErrors, ABlockOfTrianglesThatWouldLieBehindTheFile) {
  // Faces of no corners are shorter than triangles: blocks are laid out for more bytes than there
  // are.
  constexpr int kFaces = 200'000;
  for (const PlyEncoding encoding : {PlyEncoding::little_endian, PlyEncoding::big_endian}) {
    PlyText ply = vertices(encoding, "0", "float").line(fmt::format("element face {}", kFaces));
    ply.line("property uchar flags").line("property list uchar int vertex_indices").end_header();
    MemoryFiles files;
    files.put("m", ply.bytes() + Bytes(2 * kFaces, '\0'));
    const auto source = open_mesh(files, "m");
    ASSERT_GT(source->triangle_blocks(), 1U);
    BlockMemory memory;
    const TriangleBlock block = source->read_triangle_block(source->triangle_blocks() - 1, memory);
    EXPECT_EQ(block.faces, 0U);
    EXPECT_FALSE(block.whole);
    const FaceCounts counts = source->read_triangles([](std::span<const Triangle<VertexId>>) {});
    EXPECT_EQ(counts.degenerate_triangles, std::uint64_t{kFaces});
  }
}

TEST(PlyErrors, Overlong) {
  EXPECT_EQ(error_of(tetrahedron(PlyEncoding::ascii) + "3 0 1 2\n"),
            "mesh.ply: line 18: expected the end of the file behind the last row the header "
            "declares, found '3' (the header's counts do not match the data)");
  for (const char* rest : {"1.5 2 3\n", "no row\n0 0 0\n", "4 0 1 2 3\n"}) {
    EXPECT_THAT(error_of(tetrahedron(PlyEncoding::ascii) + rest),
                HasSubstr("the header's counts do not match the data"))
        << rest;
  }
  for (const PlyEncoding encoding : {PlyEncoding::little_endian, PlyEncoding::big_endian}) {
    const Bytes whole = tetrahedron(encoding);
    for (const Bytes& rest : {Bytes("x"), Bytes("\0", 1), Bytes("x\n"), Bytes("\n\0", 2),
                              Bytes("\0\0\0\n", 4), Bytes(13, '\0')}) {
      EXPECT_EQ(error_of(whole + rest),
                fmt::format("mesh.ply: byte {}: expected the end of the file behind the last row "
                            "the header declares, found {} bytes more (the header's counts or "
                            "types do not match the data)",
                            whole.size(), rest.size()));
    }
  }
}

TEST(PlyErrors, ImpossibleCountsAreRefusedBeforeAnythingIsRead) {
  for (const PlyEncoding encoding : kEncodings) {
    const auto open_error = [](const Bytes& bytes) -> std::string {
      MemoryFiles files;
      files.put("m", bytes);
      try {
        open_mesh(files, "m");
      } catch (const Error& error) {
        return error.what();
      }
      return "none";
    };
    PlyText many = vertices(encoding, "4000000000", "float").end_header();
    many.row(PlyType::f32, {1, 2, 3});
    EXPECT_THAT(open_error(many.bytes()),
                HasSubstr("expected 4000000000 rows of element 'vertex'"));
    PlyText faces = with_faces(encoding, 2000000000);
    EXPECT_THAT(open_error(faces.bytes()), HasSubstr("expected 2000000000 rows of element 'face'"));
    PlyText overflow(encoding);
    overflow.line("element other 18446744073709551615").line("property double v");
    overflow.line("element vertex 0").line("property float x").line("property float y");
    overflow.line("property float z").end_header();
    EXPECT_THAT(open_error(overflow.bytes()), HasSubstr("rows of element 'other'"));
  }
  PlyText four_billion = vertices(PlyEncoding::ascii, "4294967296", "float").end_header();
  EXPECT_EQ(error_of(four_billion.bytes()),
            "mesh.ply: expected at most 4294967295 vertices, found 4294967296 declared (split the "
            "mesh)");
}

TEST(PlyErrors, HeadersWithoutWhatAMeshNeeds) {
  const auto header = [](const std::vector<std::string>& lines) {
    PlyText ply(PlyEncoding::ascii);
    for (const std::string& line : lines)
      ply.line(line);
    return error_of(ply.end_header().line("1 2 3").bytes());
  };
  EXPECT_THAT(header({"element point 1", "property float x"}),
              HasSubstr("expected an element 'vertex', found none"));
  const std::string missing = "expected the scalar properties 'x', 'y' and 'z' of element 'vertex'";
  EXPECT_THAT(header({"element vertex 1", "property float x", "property float y"}),
              HasSubstr(missing));
  EXPECT_THAT(header({"element vertex 1", "property float x", "property float y",
                      "property list uchar float z"}),
              HasSubstr(missing));
  EXPECT_THAT(header({"element vertex 1", "property float x", "property float y",
                      "property float z", "property float y"}),
              HasSubstr("expected property 'y' of element 'vertex' once, found it twice"));
  EXPECT_THAT(header({"element vertex 1", "property float x", "property float y",
                      "property float z", "element face 2"}),
              HasSubstr("expected properties of element 'face', which declares 2 rows"));
  const std::vector<std::string> point{"element vertex 1", "property float x", "property float y",
                                       "property float z"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), point.begin(), point.end());
    return header(more);
  };
  const std::string no_list =
      "expected one list property 'vertex_indices' or 'vertex_index' of element 'face', found ";
  EXPECT_THAT(with({"element face 1", "property int vertex_indices"}), HasSubstr(no_list + "0"));
  EXPECT_THAT(with({"element face 1", "property list uchar int vertex_index",
                    "property list uchar int vertex_indices"}),
              HasSubstr(no_list + "2"));
  EXPECT_THAT(with({"element face 1", "property list uchar float vertex_indices"}),
              HasSubstr("expected an integer type for the vertex indices of element 'face', found "
                        "'float'"));
  EXPECT_THAT(with({"element range_grid 1", "property list uchar int vertex_indices"}),
              HasSubstr("found a range grid (element 'range_grid'): this is a raw range scan"));
}

TEST(PlyErrors, AFileThatIsNotThereIsAnIoError) {
  MemoryFiles files;
  try {
    open_mesh(files, "absent.ply");
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
  }
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
