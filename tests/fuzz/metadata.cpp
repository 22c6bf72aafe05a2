// Tables of what features are, in a mesh that is always the same.
//
// First a byte: its lowest bit says whether it is a batch table of a b3dm, the next one whether
// somebody asks for features. Then 2 bytes, how long the JSON is, the JSON, and the bytes:
//
//     property table   EXT_structural_metadata; views 0 to 3 each begin where a quarter of the
//                      bytes does, and end with them
//     batch table      the JSON and the binary part
#include "fuzz/import_reading.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "support/gltf_builder.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

constexpr std::size_t kViews = 4;

/// Two triangles whose corners have features; the accessors come behind the views of the table.
GltfBuilder triangles(const std::string& bytes, const char* ids) {
  GltfBuilder gltf;
  const std::size_t begin = gltf.bin.size();
  for (std::size_t i = 0; i < kViews; ++i) {
    const std::size_t offset = begin + bytes.size() * i / kViews;
    gltf.add(
        "bufferViews",
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", begin + bytes.size() - offset}});
  }
  gltf.bin += bytes;
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  gltf.show({{"attributes",
              {{"POSITION", gltf.accessor(corners, "VEC3")},
               {ids, gltf.accessor(std::vector<float>{0, 0, 0, 1, 1, 3}, "SCALAR")}}}});
  return gltf;
}

std::string with_properties(const std::string& json, const std::string& bytes) {
  GltfBuilder gltf = triangles(bytes, "_FEATURE_ID_0");
  gltf.json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"] = {
      {{"featureCount", 4}, {"attribute", 0}, {"propertyTable", 0}}};
  gltf.json["extensions"]["EXT_structural_metadata"] = "METADATA";
  std::string text = gltf.text("");
  const std::string mark = "\"METADATA\"";
  return glb_of(text.replace(text.find(mark), mark.size(), json), gltf.bin);
}

std::string with_batches(const std::string& json, const std::string& bytes) {
  const std::string glb = triangles("", "_BATCHID").glb();
  const std::string features = R"({"BATCH_LENGTH":2}      )";
  const auto word = [](std::size_t number) { return little(static_cast<std::uint32_t>(number)); };
  return "b3dm" + word(1) + word(28 + features.size() + json.size() + bytes.size() + glb.size()) +
         word(features.size()) + word(0) + word(json.size()) + word(bytes.size()) + features +
         json + bytes + glb;
}

constexpr const char* kTileset = R"({"asset":{"version":"1.0"},"geometricError":1,"root":
{"boundingVolume":{"sphere":[0,0,0,1]},"geometricError":0,"content":{"uri":"a.b3dm"}}})";

}  // namespace

void metadata(Bytes input) {
  Take take(input);
  const auto flags = take.number<std::uint8_t>();
  const bool is_batched = (flags & 1) != 0, is_asked = (flags & 2) != 0;
  const std::string json(text_of(take.bytes(take.number<std::uint16_t>())));
  const std::string bytes(text_of(take.rest()));
  MemoryFiles files;
  files.put("mesh", is_batched ? kTileset : with_properties(json, bytes));
  if (is_batched)
    files.put("a.b3dm", with_batches(json, bytes));
  importing::InputUse use;
  if (is_asked)
    use.objects = {mesh_io::ObjectSource::feature};
  std::string first;
  const std::string message =
      refusal({ErrorCode::input, ErrorCode::budget}, "", [&] { first = imported(files, use); });
  if (message.empty())
    require(imported(files, use) == first, "the same once more");
}

}  // namespace meshhier::tests::fuzz
