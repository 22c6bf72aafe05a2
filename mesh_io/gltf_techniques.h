// The base colour of materials that are shaders (KHR_techniques_webgl): what glTF 1.0 had, and what
// programs made of it that wrote no other material.
#pragma once

#include "mesh_io/gltf_json.h"

#include <array>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// The objects whose members are values of a material's uniforms: those of the material, and those
/// of its technique, each in an object {"value": ...}. Throws as GltfObject.
std::vector<GltfObject> technique_values(const GltfObject& root, const GltfObject& material);

struct TechniqueTexture {
  std::optional<GltfObject> use{};  ///< {"index": ...}
  bool is_unknown = false;          ///< there are several, and none is named so
};

/// The texture that is named as a base colour ("u_diffuse"), else the only one that is not named as
/// something else.
TechniqueTexture technique_texture(const std::vector<GltfObject>& values);

/// The colour that is named so, in light; a shader's are values of a screen.
std::optional<std::array<double, 4>> technique_colour(const std::vector<GltfObject>& values);

}  // namespace meshhier::mesh_io
