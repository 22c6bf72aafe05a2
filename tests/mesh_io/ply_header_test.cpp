#include "mesh_io/ply_header.h"

#include "base/error.h"
#include "tests/support/error_message.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  const std::string message =
      meshhier::tests::error_message(ErrorCode::input, [&] { parse_ply_header(text, "h.ply"); });
  EXPECT_NE(message, "") << "no error for " << text;
  return message;
}

TEST(PlyHeader, ReadsElementsPropertiesAndLists) {
  const std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 12\nproperty float x\n"
      "property uint16 quality\nproperty list int8 float64 weights\nelement face 7\n"
      "property list uchar int vertex_indices\nend_header\n";
  const PlyHeader header = parse_ply_header(text + "DATA", "h.ply");
  EXPECT_EQ(header.encoding, PlyEncoding::big_endian);
  EXPECT_EQ(header.data_offset, text.size());
  EXPECT_EQ(header.data_line, 10U);
  ASSERT_EQ(header.elements.size(), 2U);
  EXPECT_EQ(header.elements[0].name, "vertex");
  EXPECT_EQ(header.elements[0].count, 12U);
  ASSERT_EQ(header.elements[0].properties.size(), 3U);
  EXPECT_EQ(header.elements[0].properties[1].type, PlyType::u16);
  EXPECT_FALSE(header.elements[0].properties[1].is_list());
  EXPECT_EQ(header.elements[0].properties[2].type, PlyType::f64);
  EXPECT_EQ(header.elements[0].properties[2].count_type, PlyType::i8);
  EXPECT_EQ(header.elements[1].count, 7U);
}

TEST(PlyHeader, KnowsOldAndSizedTypeNames) {
  const char* const names[] = {"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                               "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                               "float",  "float32", "double", "float64"};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    const std::string text = std::string("ply\nformat ascii 1.0\nelement e 1\nproperty ") +
                             names[i] + " p\nend_header\n";
    const PlyHeader header = parse_ply_header(text, "h.ply");
    EXPECT_EQ(header.elements[0].properties[0].type, static_cast<PlyType>(i / 2)) << names[i];
    EXPECT_EQ(header.odd_lines, 0U) << names[i];
  }
}

TEST(PlyHeader, CommentsBlanksAndEmptyLinesMayBeAnywhere) {
  const PlyHeader header = parse_ply_header(
      "ply \ncomment first\nformat  ascii\t1.0 \n\nobj_info num_cols 512\nelement vertex 1 \n"
      "comment element vertex 9\n\tproperty float x\ncomment\nend_header  \n1\n",
      "h.ply");
  ASSERT_EQ(header.elements.size(), 1U);
  EXPECT_EQ(header.elements[0].count, 1U);
  EXPECT_EQ(header.data_line, 11U);
}

TEST(PlyHeader, RemarksWithoutTheirKeywordArePassedOver) {
  for (const char* remark : {"Created by Blender3D 247 - www.blender.org, source file: ",
                             "# a remark", "author me", "comments: none", "\"x\""}) {
    const std::string text = std::string("ply\nformat ascii 1.0\n") + remark + "\nelement e 1\n";
    const PlyHeader header = parse_ply_header(text + "property int p\nend_header\n", "h.ply");
    EXPECT_EQ(header.elements.size(), 1U);
    EXPECT_EQ(header.data_line, 7U);
    EXPECT_THAT(error_of(text + remark + "\nend_header\n"), HasSubstr("line 5: expected 'format'"))
        << "what is behind an element may be a property";
    EXPECT_THAT(error_of(std::string("ply\n") + remark + "\n"), HasSubstr("line 2"));
  }
}

TEST(PlyHeader, NamesWithSpacesAreRead) {
  const PlyHeader header = parse_ply_header(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float scalar field 2\nend_header\n", "h");
  EXPECT_EQ(header.elements[0].properties[0].name, "scalar field 2");
}

TEST(PlyHeader, DataStartsRightBehindTheLineEnd) {
  // The bytes behind it look like a line end in every case: they are data.
  const std::string crlf = "ply\r\nformat binary_little_endian 1.0\r\nend_header\r\n";
  EXPECT_EQ(parse_ply_header(crlf + "\n\n", "h").data_offset, crlf.size());
  const std::string lf = "ply\nformat binary_little_endian 1.0\nend_header\n";
  EXPECT_EQ(parse_ply_header(lf + "\n\r", "h").data_offset, lf.size());
  const std::string cr = "ply\rformat binary_little_endian 1.0\rend_header\r";
  EXPECT_EQ(parse_ply_header(cr + "\n\n", "h").data_offset, cr.size());
  const std::string mixed = "ply\nformat binary_little_endian 1.0\nend_header\r\n";
  EXPECT_EQ(parse_ply_header(mixed + "\n", "h").data_offset, mixed.size());
}

TEST(PlyHeader, MayEndTheFileWithoutALineEnd) {
  const std::string text = "ply\nformat ascii 1.0\nend_header";
  EXPECT_EQ(parse_ply_header(text, "h").data_offset, text.size());
}

/// A header of one face element, whose lines stand in `lines`.
PlyHeader header_of(const std::string& lines,
                    const std::string& start = "ply\nformat ascii 1.0\n") {
  return parse_ply_header(start + lines + "end_header\n", "h.ply");
}

TEST(PlyHeader, SmallSinsAreReadAndCounted) {
  const std::string vertex = "element vertex 1\nproperty float x\n";
  for (const char* start :
       {"\xEF\xBB\xBFply\nformat ascii 1.0\n", "\n \r\nply\nformat ascii 1.0\n",
        "PLY\nformat ascii 1.0\n", "Ply\nformat ascii 1.0\n", "ply\nformat ascii 1.1\n",
        "ply\nformat ascii 1\n", "ply\nformat ascii\n"}) {
    const PlyHeader header = header_of(vertex, start);
    EXPECT_EQ(header.odd_lines, 1U) << start;
    EXPECT_EQ(header.elements[0].name, "vertex") << start;
  }
  EXPECT_EQ(header_of(vertex).odd_lines, 0U);
  const PlyHeader capitals = parse_ply_header(
      "PLY\nFORMAT ASCII 1.0\nELEMENT VERTEX 1\nPROPERTY FLOAT X\nEND_HEADER\n", "h.ply");
  EXPECT_EQ(capitals.odd_lines, 6U);
  EXPECT_EQ(capitals.elements[0].name, "vertex");
  EXPECT_EQ(header_of("element vertex 1\nproperty Float x\nproperty INT64 id\n").odd_lines, 2U);
}

TEST(PlyHeader, LinesAreCountedBehindWhatComesFirst) {
  const PlyHeader header = parse_ply_header("\n\nply\nformat ascii 1.0\nend_header\n", "h.ply");
  EXPECT_EQ(header.data_line, 6U);
}

TEST(PlyHeader, NamesThatMeanTheFormatsAreThese) {
  for (const char* name : {"vertices", "Vertex", "VERTICES", "vertexes"}) {
    const PlyHeader header = header_of("element " + std::string(name) + " 1\nproperty float x\n");
    EXPECT_EQ(header.elements[0].name, "vertex") << name;
    EXPECT_EQ(header.odd_lines, 1U) << name;
  }
  for (const char* name : {"vertex_indexes", "Vertex_Indices", "vertexIndex", "indices"}) {
    const PlyHeader header =
        header_of("element faces 1\nproperty list uchar int " + std::string(name) + "\n");
    EXPECT_EQ(header.elements[0].name, "face") << name;
    EXPECT_EQ(header.elements[0].properties[0].name, "vertex_indices") << name;
    EXPECT_EQ(header.odd_lines, 2U) << name;
  }
  const PlyHeader both =
      header_of("element vertices 1\nproperty float a\nelement vertex 1\nproperty float x\n");
  EXPECT_EQ(both.elements[0].name, "vertices") << "another one is there";
  const PlyHeader unclear = header_of(
      "element face 1\nproperty list uchar int indices\nproperty list uchar int vertices\n");
  EXPECT_EQ(unclear.elements[0].properties[0].name, "indices") << "either may be meant";
}

TEST(PlyHeader, ScalarsSideBySideAreTheCornersOfFacesWithoutALists) {
  const auto face = [](const std::vector<std::string>& names, const std::string& type = "int") {
    std::string lines = "element face 1\nproperty uchar tag\n";
    for (const std::string& name : names)
      lines += "property " + type + " " + name + "\n";
    return header_of(lines + "property float area\n").elements[0].properties;
  };
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"v1", "v2", "v3"},
        {"v0", "v1", "v2"},
        {"a", "b", "c"},
        {"i", "j", "k"},
        {"vertex_index_0", "vertex_index_1", "vertex_index_2"},
        {"vertex_indices", "vertex_indices", "vertex_indices"},
        {"V1", "V2", "V3", "V4"}}) {
    const std::vector<PlyProperty> properties = face(names);
    ASSERT_EQ(properties.size(), 3U) << names[0];
    EXPECT_EQ(properties[1].name, "vertex_indices");
    EXPECT_EQ(properties[1].fixed_count, names.size());
    EXPECT_TRUE(properties[1].is_list());
  }
  EXPECT_EQ(face({"v1", "v2", "v3"}, "float").size(), 5U) << "no numbers of vertices";
  EXPECT_EQ(face({"v1", "v3", "v2"}).size(), 5U);
  EXPECT_EQ(face({"red", "green", "blue"}).size(), 5U);
}

TEST(PlyHeader, SaysWhatAForeignFileIs) {
  EXPECT_EQ(error_of(""), "h.ply: expected a PLY file, found an empty file");
  EXPECT_EQ(error_of("solid x\n"),
            "h.ply: expected a PLY file, which starts with the line 'ply', found 'solid x'");
  EXPECT_THAT(error_of("\x1f\x8b\x08rest"), HasSubstr("found gzip data (unpack it first)"));
  EXPECT_THAT(error_of("plyx\nformat ascii 1.0\n"), HasSubstr("found 'plyx'"));
}

TEST(PlyHeader, EveryErrorNamesItsLine) {
  const struct {
    const char* text;
    const char* message;
  } cases[] = {
      {"ply\nformat text 1.0\n",
       "line 2: expected the format 'ascii', 'binary_little_endian' or "
       "'binary_big_endian', found 'text'"},
      {"ply\nformat ascii 2.0\n", "line 2: expected format version '1.0', found '2.0'"},
      {"ply\nformat ascii 1.0 x\n", "line 2: expected format version '1.0', found '1.0 x'"},
      {"ply\nformat ascii 1.0\nformat ascii 1.0\n", "line 3: expected one 'format' line"},
      {"ply\nend_header\n", "line 2: expected a 'format' line before 'end_header', found none"},
      {"ply\nformat ascii 1.0\nelements vertex 3\n", "line 3: expected 'format', 'comment'"},
      {"ply\nformat ascii 1.0\nproperty float x\n", "line 3: expected an 'element' before"},
      {"ply\nformat ascii 1.0\nelement\n", "line 3: expected 'element NAME COUNT', found no name"},
      {"ply\nformat ascii 1.0\nelement vertex\n", "line 3: expected the number of 'vertex' rows"},
      {"ply\nformat ascii 1.0\nelement vertex -4\n", "found '-4'"},
      {"ply\nformat ascii 1.0\nelement vertex 4 5\n", "found '4 5'"},
      {"ply\nformat ascii 1.0\nelement vertex 1e3\n", "found '1e3'"},
      {"ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n", "integer below 2^64"},
      {"ply\nformat ascii 1.0\nelement a 1\nelement a 1\n", "line 4: expected each element once"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty real x\n", "line 4: expected a type (char"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty float\n",
       "line 4: expected a property's name"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty list float int v\n",
       "line 4: expected an integer type for a list's length, found 'float'"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty list uchar v\n", "found 'v'"},
      {"ply\nformat ascii 1.0\nend_header now\n", "line 3: expected a line end after 'end_header'"},
      {"ply\nformat ascii 1.0\nelement a 1\n", "line 4: expected a header line, found the end"},
      {"ply", "line 2: expected a header line, found the end of the file (is it truncated?)"},
  };
  for (const auto& c : cases)
    EXPECT_THAT(error_of(c.text), HasSubstr(c.message)) << c.text;
}

TEST(PlyHeader, UnprintableTextIsShownSafely) {
  EXPECT_THAT(error_of("ply\n\x01\xff" + std::string(100, 'a') + "\n"),
              HasSubstr("found '??" + std::string(38, 'a') + "...'"));
}

TEST(PlyHeader, LengthIsLimited) {
  std::string text = "ply\nformat ascii 1.0\n";
  while (text.size() < kMaxHeaderBytes)
    text += "comment " + std::string(1000, 'c') + "\n";
  text.resize(kMaxHeaderBytes);
  EXPECT_THAT(error_of(text), HasSubstr("expected 'end_header' within 262144 bytes, found none"));
  const std::string long_line = "ply\ncomment " + std::string(kMaxHeaderLineBytes, 'c') + "\n";
  EXPECT_THAT(error_of(long_line), HasSubstr("line 2: expected header lines of at most 65536"));
}

}  // namespace
}  // namespace meshhier::mesh_io
