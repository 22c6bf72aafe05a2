// Buffer views and primitives that codecs made: EXT_meshopt_compression,
// KHR_draco_mesh_compression.
#include "base/error.h"
#include "import/imported.h"
#include "storage/format/meshopt_codec.h"
#include "support/gltf_builder.h"
#include "tests/support/error_message.h"
#include "tests/support/memory_files.h"

#include <cmath>
#include <string>

#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

namespace meshhier::mesh_io {
namespace {

using testing::HasSubstr;
using tests::GltfBuilder;
using tests::GltfJson;
using tests::Imported;

const std::vector<float> kPositions{0, 0, 0, 1, 0, 0, 1, 1, 0.25F, 0, 1, 0};
const std::vector<std::uint32_t> kCorners{0, 1, 2, 0, 2, 3};

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class GltfCodecsTest : public testing::Test {
 protected:
  Imported import(const GltfBuilder& gltf, bool tight = false) {
    files_.put("w/a.glb", gltf.glb());
    return tests::import_files(files_, std::filesystem::path("w/a.glb"),
                               {.memory = tight ? tests::kTight : tests::kRoomy});
  }
  std::string failure(const GltfBuilder& gltf, ErrorCode code = ErrorCode::input,
                      bool tight = false) {
    return tests::error_message(code, [&] { import(gltf, tight); });
  }
  void expect_square(const Imported& mesh) {
    ASSERT_EQ(mesh.positions.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(mesh.positions[i],
                (Vec3d{kPositions[3 * i], kPositions[3 * i + 1], kPositions[3 * i + 2]}));
    EXPECT_EQ(mesh.triangles.size(), 2U);
  }

  tests::MemoryFiles files_;
};

/// A view of a fallback buffer, decoded from bytes of buffer 0.
std::size_t packed_view(GltfBuilder& gltf, const std::string& packed, std::size_t stride,
                        std::size_t count, const char* mode, const char* filter = nullptr) {
  const std::size_t number = gltf.view(packed);
  GltfJson& view = gltf.json["bufferViews"][number];
  GltfJson meshopt{{"buffer", 0},
                   {"byteOffset", view["byteOffset"]},
                   {"byteLength", packed.size()},
                   {"byteStride", stride},
                   {"count", count},
                   {"mode", mode}};
  if (filter != nullptr)
    meshopt["filter"] = filter;
  view = {{"buffer", 1}, {"byteLength", stride * count}};
  if (mode == std::string("ATTRIBUTES"))
    view["byteStride"] = stride;
  view["extensions"]["EXT_meshopt_compression"] = meshopt;
  return number;
}

void use_fallback(GltfBuilder& gltf) {
  gltf.json["buffers"] = {{{"byteLength", gltf.bin.size()}}, {{"byteLength", 1000000}}};
}

std::string packed_positions() {
  return text_of(storage::encode_attributes(std::as_bytes(std::span(kPositions)), 12));
}

std::size_t add_accessor(GltfBuilder& gltf, std::size_t view, int component, std::size_t count,
                         const char* type) {
  return gltf.add(
      "accessors",
      {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
}

GltfBuilder meshopt_square(const char* index_mode, std::size_t index_bytes) {
  GltfBuilder gltf;
  const std::size_t positions = packed_view(gltf, packed_positions(), 12, 4, "ATTRIBUTES");
  const std::string packed = index_mode == std::string("INDICES")
                                 ? text_of(storage::encode_indices(kCorners))
                                 : text_of(storage::encode_triangles(kCorners, {4, 0}));
  const std::size_t corners = packed_view(gltf, packed, index_bytes, 6, index_mode);
  gltf.show(
      {{"attributes", {{"POSITION", add_accessor(gltf, positions, 5126, 4, "VEC3")}}},
       {"indices", add_accessor(gltf, corners, index_bytes == 2 ? 5123 : 5125, 6, "SCALAR")}});
  use_fallback(gltf);
  return gltf;
}

TEST_F(GltfCodecsTest, MeshoptViewsOfAllModesAreDecoded) {
  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    expect_square(import(meshopt_square(mode, 2)));
    expect_square(import(meshopt_square(mode, 4)));
  }
}

TEST_F(GltfCodecsTest, MeshoptFiltersAreUndone) {
  GltfBuilder gltf;
  std::vector<std::byte> words(48);
  std::ranges::copy(std::as_bytes(std::span(kPositions)), words.begin());
  ASSERT_TRUE(storage::try_filter_positions(words));
  const std::size_t positions = packed_view(gltf, text_of(storage::encode_attributes(words, 12)),
                                            12, 4, "ATTRIBUTES", "EXPONENTIAL");
  std::vector<std::int8_t> octahedral(16);
  const std::vector<float> normals{0, 0, 1, 0, 1, 0, 0, -1, 0, 0, 1, 0, -1, 0, 0, 0};
  meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, normals.data());
  const std::size_t oct = packed_view(
      gltf, text_of(storage::encode_attributes(std::as_bytes(std::span(octahedral)), 4)), 4, 4,
      "ATTRIBUTES", "OCTAHEDRAL");
  const std::size_t normal = add_accessor(gltf, oct, 5120, 4, "VEC3");
  gltf.json["accessors"][normal]["normalized"] = true;
  gltf.show({{"attributes",
              {{"POSITION", add_accessor(gltf, positions, 5126, 4, "VEC3")}, {"NORMAL", normal}}},
             {"indices", gltf.accessor(kCorners, "SCALAR")}});
  use_fallback(gltf);
  const Imported mesh = import(gltf);
  expect_square(mesh);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(mesh.attributes[3 * i + k], normals[4 * i + k], 0.01);
  }
}

TEST_F(GltfCodecsTest, ADecodedViewIsUsedByManyPrimitives) {
  GltfBuilder gltf = meshopt_square("TRIANGLES", 2);
  for (int i = 0; i < 20; ++i)
    gltf.node({{"mesh", 0}});
  EXPECT_EQ(import(gltf).positions.size(), 84U);
}

TEST_F(GltfCodecsTest, WrongMeshoptViewsAreRefusedBeforeMemoryIsTaken) {
  const GltfBuilder sound = meshopt_square("TRIANGLES", 2);
  const auto with = [&](std::size_t view, const char* key, const GltfJson& value) {
    GltfBuilder gltf = sound;
    gltf.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
    return failure(gltf);
  };
  EXPECT_THAT(with(0, "count", 4000000000U), HasSubstr("cannot hold 4000000000 elements"));
  EXPECT_THAT(with(1, "count", 3999999999U), HasSubstr("cannot hold 3999999999 elements"));
  EXPECT_THAT(with(1, "count", 5), HasSubstr("count 5 is none of its mode"));
  EXPECT_THAT(with(0, "count", 0), HasSubstr("count 0 is none of its mode"));
  EXPECT_THAT(with(0, "count", 3), HasSubstr("bufferViews[0]"));
  EXPECT_THAT(with(0, "byteStride", 0), HasSubstr("byteStride 0"));
  EXPECT_THAT(with(0, "byteStride", 6), HasSubstr("byteStride 6"));
  EXPECT_THAT(with(0, "byteStride", 260), HasSubstr("byteStride is 260"));
  EXPECT_THAT(with(1, "byteStride", 8), HasSubstr("byteStride 8"));
  EXPECT_THAT(with(0, "filter", "OCTAHEDRAL"), HasSubstr("its filter does not fit"));
  EXPECT_THAT(with(1, "filter", "EXPONENTIAL"), HasSubstr("its filter does not fit"));
  EXPECT_THAT(with(0, "filter", "OTHER"), HasSubstr("unknown filter \"OTHER\""));
  EXPECT_THAT(with(0, "mode", "OTHER"), HasSubstr("unknown mode \"OTHER\""));
  EXPECT_THAT(with(0, "mode", "INDICES"), HasSubstr("byteStride 12"));
  EXPECT_THAT(with(0, "buffer", 2), HasSubstr("buffer is 2"));
  EXPECT_THAT(with(0, "buffer", 1), HasSubstr("buffers[1] has neither"));
  EXPECT_THAT(with(0, "byteLength", 5000), HasSubstr("bufferViews[0] has 5000 bytes"));
  for (std::size_t size = 0; size < packed_positions().size(); ++size)
    EXPECT_THAT(with(0, "byteLength", size), HasSubstr("bufferViews[0]")) << size;
}

TEST_F(GltfCodecsTest, AMeshoptViewBeyondTheMemoryIsRefused) {
  GltfBuilder gltf;
  constexpr std::size_t kCount = 400000;  // 4.8 MB
  const std::vector<float> zeros(3 * kCount);
  const std::string packed =
      text_of(storage::encode_attributes(std::as_bytes(std::span(zeros)), 12));
  const std::size_t view = packed_view(gltf, packed, 12, kCount, "ATTRIBUTES");
  gltf.show({{"attributes", {{"POSITION", add_accessor(gltf, view, 5126, 3, "VEC3")}}}});
  use_fallback(gltf);
  gltf.json["buffers"][1]["byteLength"] = 12 * kCount;
  EXPECT_THAT(failure(gltf, ErrorCode::budget, true), HasSubstr("bufferViews[0] takes"));
  EXPECT_EQ(import(gltf).positions.size(), 3U);
}

TEST_F(GltfCodecsTest, PicturesInCompressedViewsAreRefused) {
  GltfBuilder gltf = meshopt_square("TRIANGLES", 2);
  const std::size_t material = gltf.textured_material({{"bufferView", 0}});
  gltf.json["meshes"][0]["primitives"][0]["material"] = material;
  EXPECT_THAT(failure(gltf), HasSubstr("images[0] lies in a compressed buffer view"));
}

// ---- Draco ---------------------------------------------------------------------------------

template <class Number>
void add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, std::int8_t components,
                   draco::DataType data, bool normalized, const std::vector<Number>& numbers,
                   std::uint32_t id) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, components, data, normalized,
                 static_cast<std::int64_t>(sizeof(Number)) * components, 0);
  const auto count =
      static_cast<std::uint32_t>(numbers.size() / static_cast<std::size_t>(components));
  const int number = mesh.AddAttribute(attribute, true, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.attribute(number)->SetAttributeValue(draco::AttributeValueIndex(i),
                                              &numbers[i * static_cast<std::size_t>(components)]);
  }
  mesh.attribute(number)->set_unique_id(id);
}

std::string draco_square(int method) {
  draco::Mesh mesh;
  mesh.set_num_points(4);
  mesh.AddFace({draco::PointIndex(0), draco::PointIndex(1), draco::PointIndex(2)});
  mesh.AddFace({draco::PointIndex(0), draco::PointIndex(2), draco::PointIndex(3)});
  add_attribute(mesh, draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, false, kPositions,
                7);
  add_attribute(mesh, draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8, true,
                std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 255}, 3);
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return {buffer.data(), buffer.size()};
}

GltfBuilder draco_gltf(const std::string& stream) {
  GltfBuilder gltf;
  GltfJson primitive{
      {"attributes",
       {{"POSITION",
         gltf.add("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}})},
        {"COLOR_0",
         gltf.add(
             "accessors",
             {{"componentType", 5121}, {"count", 4}, {"type", "VEC3"}, {"normalized", true}})}}},
      {"indices",
       gltf.add("accessors", {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}})}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", gltf.view(stream)}, {"attributes", {{"POSITION", 7}, {"COLOR_0", 3}}}};
  gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  gltf.show(primitive);
  return gltf;
}

TEST_F(GltfCodecsTest, DracoPrimitivesOfBothMethodsAreDecoded) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const Imported mesh = import(draco_gltf(draco_square(method)));
    EXPECT_EQ(mesh.layout,
              (AttributeLayout{.colour = ColourType::u8, .space = ColourSpace::linear}));
    ASSERT_EQ(mesh.positions.size(), 4U);
    EXPECT_EQ(mesh.triangles.size(), 2U);
    std::size_t found = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      // Edgebreaker gives the vertices in another order.
      if (mesh.positions[i] == Vec3d{0, 1, 0}) {
        EXPECT_EQ(mesh.attributes[3 * i], 10);
        EXPECT_EQ(mesh.attributes[3 * i + 2], 255);
        ++found;
      }
    }
    EXPECT_EQ(found, 1U);
  }
}

TEST_F(GltfCodecsTest, WrongDracoStreamsAreRefused) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string stream = draco_square(method);
    for (std::size_t size = 0; size + 1 < stream.size(); ++size)
      EXPECT_THAT(failure(draco_gltf(stream.substr(0, size))), HasSubstr("bufferViews[0]")) << size;
    // Any byte may lie: an error or another mesh, nothing else.
    for (std::size_t at = 0; at < stream.size(); ++at) {
      for (const char byte : {'\0', '\x7f', '\xff'}) {
        std::string changed = stream;
        changed[at] = byte;
        try {
          import(draco_gltf(changed));
        } catch (const Error& error) {
          EXPECT_THAT(error.what(), HasSubstr("w/a.glb")) << at;
        }
      }
    }
  }
  GltfBuilder gltf = draco_gltf(draco_square(draco::MESH_SEQUENTIAL_ENCODING));
  GltfJson& draco =
      gltf.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  draco["attributes"]["POSITION"] = 5;
  EXPECT_THAT(failure(gltf), HasSubstr("has no attribute 5 for POSITION"));
  draco["attributes"]["POSITION"] = 7;
  gltf.json["accessors"][1]["type"] = "VEC4";
  EXPECT_THAT(failure(gltf), HasSubstr("has 3 components of COLOR_0, expected 4"));
}

TEST_F(GltfCodecsTest, ADracoStreamOfManyTrianglesIsRefusedByItsHead) {
  std::string stream = draco_square(draco::MESH_SEQUENTIAL_ENCODING);
  // Faces and points as varints behind 11 bytes.
  stream.replace(11, 2, "\xff\xff\xff\xff\x0f\xff\xff\xff\xff\x0f");
  EXPECT_THAT(failure(draco_gltf(stream), ErrorCode::budget), HasSubstr("larger memory_budget"));
}

}  // namespace
}  // namespace meshhier::mesh_io
