// The parts of glTF reading that need no whole file: URIs, transforms, buffers' files, formats.
#include "mesh_io/formats.h"
#include "mesh_io/gltf_outline.h"
#include "mesh_io/gltf_transform.h"
#include "mesh_io/gltf_uri.h"
#include "support/gltf_builder.h"
#include "support/gzip.h"
#include "tests/support/memory_files.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::optional<std::string> decoded(std::string_view base64) {
  std::string text;
  const bool sound = decode_base64(base64, [&](std::span<const std::byte> piece) {
    text.append(reinterpret_cast<const char*>(piece.data()), piece.size());
  });
  return sound ? std::optional(text) : std::nullopt;
}

TEST(GltfUri, Base64OfAllLengths) {
  EXPECT_EQ(decoded(""), "");
  EXPECT_EQ(decoded("YQ=="), "a");
  EXPECT_EQ(decoded("YWI="), "ab");
  EXPECT_EQ(decoded("YWJj"), "abc");
  EXPECT_EQ(decoded("YWJjZA"), "abcd");
  EXPECT_EQ(decoded("+/8="), "\xfb\xff");
  EXPECT_EQ(decoded("Y"), std::nullopt);
  EXPECT_EQ(decoded("YW=j"), std::nullopt);
  EXPECT_EQ(decoded("YW j"), std::nullopt);
  std::string text;
  for (int i = 0; i < 50000; ++i)
    text += "YWJj";
  EXPECT_EQ(decoded(text)->size(), 150000U);
}

TEST(GltfUri, NamesOfFilesArePercentDecoded) {
  EXPECT_EQ(file_of_uri("a%20b/c.bin", "w"), std::filesystem::path("w/a b/c.bin"));
  EXPECT_EQ(file_of_uri("./c.bin", "w"), std::filesystem::path("w/./c.bin"));
  EXPECT_EQ(file_of_uri("%C3%A4.bin", "w"), std::filesystem::path("w/\xc3\xa4.bin"));
  EXPECT_EQ(file_of_uri("a/b:c", "w"), std::filesystem::path("w/a/b:c"));
  EXPECT_EQ(file_of_uri(std::string(300, 'x'), "w"), std::nullopt);
  EXPECT_EQ(file_of_uri("folder/", "w"), std::nullopt);
}

TEST(GltfTransform, NormalsStandOnWhatIsFlattened) {
  const GltfTransform flat = gltf_placement({}, {0, 0, 0, 1}, {1, 1, 0});
  EXPECT_EQ(normal_rows(flat)[2], (Vec3d{0, 0, 1}));
  EXPECT_FALSE(is_mirrored(flat));
  EXPECT_TRUE(is_mirrored(gltf_placement({}, {0, 0, 0, 1}, {1, -1, 1})));
}

TEST(GltfTransform, RotationsNeedNoUnitLength) {
  const GltfTransform turn = gltf_placement({0, 0, 1}, {0, 0, 2, 2}, {3, 1, 1});
  EXPECT_EQ(transformed(turn, {1, 0, 0}), (Vec3d{0, 3, 1}));
}

std::vector<std::string> buffer_files(const std::string& content) {
  tests::MemoryFiles files;
  files.put("w/mesh", content);
  std::vector<std::string> names;
  for (const std::filesystem::path& path : outline_of_gltf(*files.open("w/mesh")).buffers)
    names.push_back(path.string());
  return names;
}

TEST(GltfBufferFiles, AreThoseOfTheBuffers) {
  const std::string json =
      R"({"images":[{"uri":"a.png"}],"buffers":[{"uri":"a.bin"},{"byteLength":3},)"
      R"({"extras":{"uri":"no"},"uri":"b%20c.bin"},{"uri":"data:x;base64,AAAA"},{"uri":"a.bin"},)"
      R"({"uri":"../no.bin"}],"nodes":[{"uri":"no.bin"}]})";
  EXPECT_THAT(buffer_files(json), ElementsAre("w/a.bin", "w/b c.bin"));
  EXPECT_THAT(buffer_files(tests::glb_of(json, "xx")), ElementsAre("w/a.bin", "w/b c.bin"));
  EXPECT_THAT(buffer_files(tests::gzip(json)), ElementsAre("w/a.bin", "w/b c.bin"));
  EXPECT_THAT(buffer_files("{\"buffers\":[{\"uri\":\"a.bin\"},"), ElementsAre("w/a.bin"));
  EXPECT_THAT(buffer_files(""), IsEmpty());
  EXPECT_THAT(buffer_files("glTF"), IsEmpty());
}

/// Texts that are cut keep their end, whatever stands there.
TEST(GltfBufferFiles, LongTextsDoNotHideOthers) {
  for (const std::string& tail :
       {std::string("\\\""), std::string("\\\\"), std::string("\\u0041")}) {
    for (std::size_t size = 8180; size < 8200; ++size) {
      const std::string json = R"({"buffers":[{"uri":"data:)" + std::string(size, 'A') + tail +
                               tail + R"("},{"uri":"b.bin"}]})";
      EXPECT_THAT(buffer_files(json), ElementsAre("w/b.bin")) << size << tail;
    }
  }
}

MeshFormat format_of(const std::string& content) {
  tests::MemoryFiles files;
  files.put("mesh", content);
  return find_format(*files.open("mesh")).value_or(MeshFormat{MeshKind::off, true});
}

TEST(GltfFormat, IsKnownByItsBeginning) {
  EXPECT_EQ(format_of("{ \n\"asset\": {").kind, MeshKind::gltf);
  EXPECT_EQ(format_of("\xef\xbb\xbf{\"textures\":").kind, MeshKind::gltf);
  EXPECT_EQ(format_of(tests::glb_of("{}", "x")).kind, MeshKind::glb);
  EXPECT_EQ(name_of(format_of(tests::gzip(tests::glb_of("{}", "x")))), "GLB (gzip)");
  // A config is no mesh.
  EXPECT_EQ(format_of("{\"input\": \"scan.ply\", \"asset\": 1}").kind, MeshKind::off);
  EXPECT_EQ(format_of("{}").kind, MeshKind::off);
}

}  // namespace
}  // namespace meshhier::mesh_io
