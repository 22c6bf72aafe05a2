// The meshes that the scene of a glTF document shows, each with its placement.
#pragma once

#include "mesh_io/gltf_document.h"
#include "mesh_io/gltf_transform.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// A mesh in one place of the scene.
struct GltfInstance {
  std::uint32_t mesh = 0;
  GltfTransform transform;
  std::optional<GltfInstancing> copies{};  ///< that stand within `transform`
  std::optional<std::uint32_t> skin{};  ///< whose joints place its vertices, if these have weights
  std::uint32_t node = 0;
};

struct GltfScene {
  std::vector<GltfInstance> instances;  ///< in the order of the tree, parents first
  std::vector<GltfTransform> places;    ///< one for each node, if there are skins; else empty
  std::uint64_t cameras = 0;
  std::uint64_t hidden = 0;  ///< meshes of nodes that are not visible
};

inline constexpr std::uint32_t kNoParent = UINT32_MAX;
/// Returns the first node that names each one as its child; kNoParent: none does.
std::vector<std::uint32_t> parents_of(const GltfDocument& document);

/// Walks the tree of nodes from the roots; all stand within `placement`. Joints that the scene does
/// not show stand where their parents bring them. Throws Error(input) naming a node that is reached
/// twice (a child of two nodes, or in a circle), so the time is linear, however deep the tree is.
GltfScene gltf_scene(const GltfDocument& document, const std::filesystem::path& path,
                     const GltfTransform& placement = {});

}  // namespace meshhier::mesh_io
