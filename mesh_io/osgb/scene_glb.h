// Parts of a scene as a GLB, whose coordinates are those of the scene: no axis is turned.
#pragma once

#include "mesh_io/osgb/finest_parts.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace meshhier::mesh_io::osgb {

struct SceneGlb {
  std::string bytes;
  std::uint64_t triangles = 0;
  std::uint64_t without = 0;                            ///< parts without triangles
  std::map<std::size_t, const osg::Image*> pictures{};  ///< by where they begin in `bytes`
};

/// Writes positions as floats, bit for bit if the scene has floats; normals, colours and texture
/// coordinates where there is one for each vertex; pictures as picture_start() has them. Indices
/// are not checked: who reads the GLB does that. Throws std::runtime_error.
SceneGlb scene_glb(const std::vector<Part>& parts);

}  // namespace meshhier::mesh_io::osgb
