// Which meshes the scene of a glTF document shows, and where.
#pragma once

#include "mesh_io/gltf_document.h"
#include "mesh_io/gltf_transform.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace meshhier::mesh_io {

struct GltfInstance {
  std::uint32_t mesh = 0;
  GltfTransform transform;
};

struct GltfScene {
  std::vector<GltfInstance> instances;  ///< in the order of the tree, parents first
  std::uint64_t skinned = 0;            ///< of them
  std::uint64_t cameras = 0;
};

/// Throws Error(input) naming a node that is reached twice: a child of two nodes, or in a circle.
/// So its time is linear, however deep the tree is.
GltfScene gltf_scene(const GltfDocument& document, const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
