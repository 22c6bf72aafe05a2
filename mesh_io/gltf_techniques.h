// The base colour of materials that are shaders (KHR_techniques_webgl). They come from glTF 1.0;
// some programs convert it and write no other material.
#pragma once

#include "mesh_io/gltf_json.h"

#include <array>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the objects whose members are values of a material's uniforms: the material's own
/// object, and its technique's, where each value is an object {"value": ...}. Throws as GltfObject.
std::vector<GltfObject> technique_values(const GltfObject& root, const GltfObject& material);

struct TechniqueTexture {
  std::optional<GltfObject> use{};  ///< {"index": ...}
  bool is_unknown = false;          ///< there are several, and none is named so
};

/// Returns the texture that is named as a base colour ("u_diffuse"), else the only one that is not
/// named as something else.
TechniqueTexture technique_texture(const std::vector<GltfObject>& values);

/// Returns the colour that is named as a base colour, linear; shaders have it as sRGB.
std::optional<std::array<double, 4>> technique_colour(const std::vector<GltfObject>& values);

}  // namespace meshhier::mesh_io
