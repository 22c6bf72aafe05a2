// Which meshes the scene of a glTF document shows, and where.
#pragma once

#include "mesh_io/gltf_document.h"
#include "mesh_io/gltf_transform.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

struct GltfInstance {
  std::uint32_t mesh = 0;
  GltfTransform transform;
  std::optional<GltfInstancing> copies{};  ///< within `transform`
  std::optional<std::uint32_t> skin{};     ///< whose joints place it, if its vertices have any
};

struct GltfScene {
  std::vector<GltfInstance> instances;  ///< in the order of the tree, parents first
  std::vector<GltfTransform> places;    ///< of all nodes, if there are skins
  std::uint64_t cameras = 0;
  std::uint64_t hidden = 0;  ///< meshes of nodes that are not visible
};

/// Throws Error(input) naming a node that is reached twice: a child of two nodes, or in a circle.
/// So its time is linear, however deep the tree is. Joints that the scene does not show stand where
/// their parents bring them.
/// `placement`: of all.
GltfScene gltf_scene(const GltfDocument& document, const std::filesystem::path& path,
                     const GltfTransform& placement = {});

}  // namespace meshhier::mesh_io
