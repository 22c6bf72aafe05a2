#include "storage/format/glb_material.h"

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

// Filters and wrap modes of the glTF 2.0 specification.
constexpr unsigned kLinear = 9729;
constexpr unsigned kLinearMipmapLinear = 9987;
constexpr unsigned kClampToEdge = 33071;

}  // namespace

Json material_json() {
  return {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
          {"doubleSided", true}};
}

Json material_json(std::size_t texture, AlphaMode alpha, bool unlit) {
  Json material = material_json();
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", texture}};
  if (alpha != AlphaMode::opaque)
    material["alphaMode"] = name_in(kAlphaModes, alpha);
  if (unlit)
    material["extensions"][kUnlitExtension] = Json::object();
  return material;
}

Json normal_texture_json(std::size_t texture, unsigned texcoord_set) {
  Json normals = {{"index", texture}};
  if (texcoord_set > 0)
    normals["texCoord"] = texcoord_set;
  return normals;
}

Json texture_json(std::size_t image, ImageFormat format) {
  Json texture = {{"sampler", 0}};
  if (const char* const extension = row_of(format).gltf_extension)
    texture["extensions"][extension] = {{"source", image}};
  else
    texture["source"] = image;
  return texture;
}

Json sampler_json() {
  return {{"magFilter", kLinear},
          {"minFilter", kLinearMipmapLinear},
          {"wrapS", kClampToEdge},
          {"wrapT", kClampToEdge}};
}

Json image_json(std::size_t view, ImageFormat format) {
  return {{"bufferView", view}, {"mimeType", row_of(format).file.media_type}};
}

}  // namespace meshhier::storage
