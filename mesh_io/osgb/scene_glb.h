// Parts of a scene as a GLB, whose coordinates are those of the scene: no axis is turned.
#pragma once

#include "mesh_io/osgb/finest_parts.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::mesh_io::osgb {

struct SceneGlb {
  std::string bytes;
  std::uint64_t triangles = 0;
  std::uint64_t without = 0;  ///< parts without triangles
};

/// Writes positions as floats, bit for bit if the scene has floats; normals, colours and texture
/// coordinates where there is one for each vertex; pictures as coded_picture() has them. Indices
/// are not checked: who reads the GLB does that. Throws std::runtime_error.
SceneGlb scene_glb(const std::vector<Part>& parts);

}  // namespace meshhier::mesh_io::osgb
