#include "mesh_io/other_formats.h"

#include "mesh_io/formats.h"
#include "streams.h"

#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using namespace std::string_view_literals;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string refusal_of_start(std::string_view start) {
  return input_error_of([&] { detect_format(Streamed(std::string(start)).file()); });
}

TEST(OtherFormats, SaysWhatAFileIs) {
  const auto tar = std::string(257, 'x') + "ustar\00000";
  for (const auto& [start, name] : {
           std::pair("PK\x03\x04\x14"sv, "a zip archive"),
           {std::string_view(tar), "a tar archive"},
           {"7z\xBC\xAF\x27\x1C"sv, "a 7z archive"},
           {"\x28\xB5\x2F\xFD\0"sv, "a file in zstd"},
           {"Kaydara FBX Binary  \0"sv, "an FBX file"},
           {"; FBX 7.4.0 project file"sv, "an FBX file"},
           {"<?xml version=\"1.0\"?>\n<COLLADA>"sv, "a Collada file"},
           {"<?xml version=\"1.0\"?>\n<core:CityModel>"sv, "a CityGML file"},
           {"\xEF\xBB\xBF<?xml version=\"1.0\"?>\n<other>"sv, "an XML file"},
           {"<!DOCTYPE html><html>404"sv, "a web page"},
           {"LASF\0\0"sv, "a point cloud (LAS or LAZ)"},
           {"ASTM-E57"sv, "a point cloud (E57)"},
           {"# .PCD v0.7\nVERSION 0.7"sv, "a point cloud (PCD)"},
           {"1.5 2 -3.25e1 200\n"sv, "rows of numbers"},
           {"1,2,3\r\n"sv, "rows of numbers"},
           {"{\n  \"format\": \"meshhier\","sv, "the manifest of a hierarchy"},
           {"{\"type\":\"CityJSON\"}"sv, "a CityJSON file"},
           {"MHTILES\n\4"sv, "the index of a hierarchy"},
           {"b3dm\1\0"sv, "a tile of 3D Tiles"},
           {"BLENDER-v300"sv, "a Blender file"},
           {"#usda 1.0\n"sv, "a USD file"},
           {"  0\nSECTION\n"sv, "a DXF drawing"},
           {"ISO-10303-21;"sv, "a STEP file"},
           {"\xFF\xFEv\0 \0"sv, "a text in UTF-16"},
           {"version https://git-lfs.github.com/spec/v1"sv, "a pointer of Git LFS"},
           {"newmtl wall\n"sv, "a material library"},
       }) {
    EXPECT_THAT(other_format(start), StartsWith(name)) << start;
    EXPECT_THAT(other_format(start), HasSubstr("; ")) << start;  // and what to do
    EXPECT_THAT(refusal_of_start(start), HasSubstr(name)) << start;
  }
}

TEST(OtherFormats, KnowsNothingOfOthers) {
  for (const std::string_view start :
       {""sv, "hello"sv, "{}"sv, "{\"input\": \"a.ply\", \"output\": \"meshhier\"}"sv,
        "1 2\n3 4 5"sv, "0 1 x"sv, "PK"sv, "<"sv, "-"sv})
    EXPECT_EQ(other_format(start), "") << start;
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
