// Which kind of mesh a file is, whatever its name.
#include "mesh_io/formats.h"

#include "streams.h"
#include "support/gzip.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using meshhier::tests::gzip;
using ::testing::HasSubstr;

std::string format_of(const std::string& content) {
  return name_of(detect_format(Streamed(content).file()));
}

std::string format_refusal(const std::string& content) {
  return input_error_of([&] { format_of(content); });
}

/// A binary STL whose header begins with `name` and whose count is `facets`.
std::string binary_stl(std::string name, unsigned char facets, std::size_t bytes_of_facets) {
  name.resize(80, '\0');
  return name + std::string{static_cast<char>(facets), '\0', '\0', '\0'} +
         std::string(bytes_of_facets, '\0');
}

TEST(MeshFormat, IsKnownByTheContent) {
  EXPECT_EQ(format_of("ply\nformat ascii 1.0\n"), "PLY");
  EXPECT_EQ(format_of("ply\r\nwhatever"), "PLY");
  EXPECT_EQ(format_of("# a comment\n\n  # another\nv 1 2 3\n"), "OBJ");
  EXPECT_EQ(format_of("mtllib a.mtl\r\n"), "OBJ");
  EXPECT_EQ(format_of("# caf\xc3\xa9\no x"), "OBJ");
  EXPECT_EQ(format_of("# a comment\nOFF\n0 0 0\n"), "OFF");
  for (const char* keyword : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF", "4OFF", "nOFF"})
    EXPECT_EQ(format_of(std::string(keyword) + "\n0 0 0\n"), "OFF") << keyword;
  EXPECT_EQ(format_of("solid part\nfacet normal 0 0 1\n"), "ASCII STL");
  EXPECT_EQ(format_of("SOLID\n"), "ASCII STL");
  EXPECT_EQ(format_of(binary_stl("a part", 2, 100)), "binary STL");
  EXPECT_EQ(format_of(binary_stl("", 0, 0)), "binary STL");
}

TEST(MeshFormat, OfRasters) {
  for (const char* start : {"II*\0", "MM\0*", "II+\0", "MM\0+"})
    EXPECT_EQ(format_of(std::string(start, 4) + "more"), "GeoTIFF") << start;
  EXPECT_EQ(format_of("NCOLS 4\r\nnrows 3\r\n"), "ESRI text grid");
  EXPECT_THAT(format_refusal(gzip(std::string("II*\0more", 8))), HasSubstr("unpack it"));
}

TEST(MeshFormat, IsKnownWithSmallSins) {
  for (const char* start : {"\xEF\xBB\xBFply\n", "\n\r\n ply \r\n", "PLY\n", "Ply\r"}) {
    EXPECT_EQ(format_of(std::string(start) + "format ascii 1.0\n"), "PLY") << start;
    EXPECT_EQ(format_of(gzip(std::string(start) + "format ascii 1.0\n")), "PLY (gzip)") << start;
  }
  EXPECT_NE(format_refusal("PLY by somebody\n"), "");
  EXPECT_EQ(format_of("off\n1 0 0\n0 0 0\n"), "OFF");
  for (const std::size_t zeros : {1, 1000, 200'000}) {
    EXPECT_EQ(format_of("solid a\nendsolid\n" + std::string(zeros, '\0')), "ASCII STL") << zeros;
    EXPECT_EQ(format_of("v 0 0 0\n" + std::string(zeros, '\0')), "OBJ") << zeros;
  }
}

TEST(MeshFormat, ATilesetBeginsAsAGltf) {
  const std::string text = R"({"asset": {"version": "1.1"}, "geometricError": 1, "root": {}})";
  EXPECT_EQ(format_of(text), "3D Tiles");
  EXPECT_EQ(format_of("\xef\xbb\xbf \n" + text), "3D Tiles");
  EXPECT_EQ(format_of(gzip(text)), "3D Tiles (gzip)");
  EXPECT_EQ(format_of(R"({"asset": {"version": "2.0"}, "scenes": []})"), "glTF");
  EXPECT_EQ(
      format_of(R"({"extras": [")" + std::string(100000, 'x') + R"("], "root": {}, "asset": {}})"),
      "3D Tiles");
  EXPECT_EQ(format_of(R"({"asset": {"extras": {"root": 1, "geometricError": 1}}, "meshes": [)"),
            "glTF");
}

TEST(MeshFormat, AFileOfAnStlsLengthIsOneWhateverItsHeaderSays) {
  for (const char* header : {"glTF to STL", R"({"asset": solid of a maker)", R"({"meshes": 1, )",
                             "OFF exporter", "o part", "normal"})
    EXPECT_EQ(format_of(binary_stl(header, 4, 200)), "binary STL") << header;
}

TEST(MeshFormat, ABinaryStlMayBeginAsATextDoes) {
  EXPECT_EQ(format_of(binary_stl("solid part", 2, 100)), "binary STL");
  EXPECT_EQ(format_of(gzip(binary_stl("solid part", 2, 100))), "binary STL (gzip)");
}

TEST(MeshFormat, IsKnownInGzip) {
  EXPECT_EQ(format_of(gzip("ply\nformat ascii 1.0\n")), "PLY (gzip)");
  EXPECT_EQ(format_of(gzip("v 1 2 3\n")), "OBJ (gzip)");
  EXPECT_EQ(format_of(gzip("solid part\nfacet normal 0 0 1\n")), "ASCII STL (gzip)");
  EXPECT_EQ(format_of(gzip("OFF\n0 0 0\n")), "OFF (gzip)");
}

TEST(MeshFormat, OsgbIsKnownByItsFirstBytes) {
  const std::string osgb = "\xA1\x0E\x91\x6C\x45\x45\xFB\x1A and more";
  EXPECT_EQ(format_of(osgb), "OSGB");
  EXPECT_EQ(format_of(gzip(osgb)), "OSGB (gzip)");
  EXPECT_NE(format_refusal(osgb.substr(0, 7)), "");
}

TEST(MeshFormat, WhatIsNoMeshIsRefused) {
  EXPECT_EQ(format_refusal(""),
            "mesh: expected a mesh (PLY, OBJ, glTF, STL, OFF, OSGB, GeoTIFF, SRTM or ESRI ASCII, "
            "or one of them packed by gzip), found an "
            "empty file");
  EXPECT_THAT(format_refusal("hello world"), HasSubstr("found 'hello world'"));
  EXPECT_THAT(format_refusal("plyx"), HasSubstr("found 'plyx'"));
  EXPECT_THAT(format_refusal(gzip("hello world")), HasSubstr("found 'hello world'"));
  EXPECT_THAT(format_refusal("\x7f"
                             "abc\1\2"),
              HasSubstr(R"(found '?abc?)"));
}

TEST(MeshFormat, AnStlOfAnotherSizeIsToldWhatItShouldHave) {
  const auto refusal = [](std::size_t bytes) {
    return format_refusal(binary_stl("a part", 2, bytes));
  };
  EXPECT_THAT(refusal(99), HasSubstr("as a binary STL it would have 184 bytes, it has 183 (trunc"));
  EXPECT_THAT(refusal(500),
              HasSubstr("it has 584 (its count of facets is wrong, or more follows)"));
}

TEST(MeshFormat, ABinaryStlMayBeLongerThanItsCountSays) {
  for (const std::size_t more : {1, 2, 40, 50, 183})
    EXPECT_EQ(format_of(binary_stl("solid made by x", 2, 100 + more)), "binary STL") << more;
  EXPECT_EQ(format_of(binary_stl("", 0, 150)), "binary STL");
  for (const std::size_t bytes : {1, 49, 51})
    EXPECT_NE(format_refusal(binary_stl("", 0, bytes)), "") << bytes;
  std::string odd = binary_stl("", 2, 101);
  odd.replace(84 + 12, 4, "\xff\xff\xff\xff");  // no number
  EXPECT_NE(format_refusal(odd), "");
  odd.replace(84 + 12, 4, std::string("\1\0\0\0", 4));  // smaller than any coordinate
  EXPECT_NE(format_refusal(odd), "");
  EXPECT_NE(format_refusal("PK\3\4" + binary_stl("", 2, 101).substr(4)), "");
}

TEST(MeshFormat, NamesOfMeshesAreKnownByTheirEndings) {
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.off", "a.gltf", "a.glb.gz", "a.PLY",
                           "a.Ply.GZ", "a.b.obj.gz", "ä ö.stl", "town.3tz"})
    EXPECT_TRUE(is_mesh_name(name)) << name;
  for (const char* name : {"a", "a.txt", ".a.ply", ".ply", "a.ply.part", "a.ply.tmp",
                           "a.ply.crdownload", "a.ply~", "a.gz", "a.ply.bz2", "a.hier", "ply"})
    EXPECT_FALSE(is_mesh_name(name)) << name;
  EXPECT_EQ(mesh_stem("david.ply"), "david");
  EXPECT_EQ(mesh_stem("david.2.OBJ.gz"), "david.2");
  EXPECT_EQ(mesh_stem("town.3TZ"), "town");
  EXPECT_EQ(mesh_stem("david"), "");
  EXPECT_EQ(mesh_stem("@ply"), "");
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
