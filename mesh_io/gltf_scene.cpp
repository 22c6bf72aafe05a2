#include "mesh_io/gltf_scene.h"

#include "mesh_io/input_error.h"

#include <cstddef>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

struct Visit {
  std::uint32_t node;
  GltfTransform parent;
};

void add_reversed(std::vector<Visit>& visits, const std::vector<std::uint32_t>& nodes,
                  const GltfTransform& parent) {
  for (std::size_t i = nodes.size(); i-- > 0;)
    visits.push_back({nodes[i], parent});
}

void add_instance(GltfScene& scene, const GltfNode& node, const GltfTransform& transform) {
  scene.cameras += node.is_camera ? 1 : 0;
  if (!node.mesh)
    return;
  scene.skinned += node.is_skinned ? 1 : 0;
  scene.instances.push_back({*node.mesh, transform});
}

}  // namespace

GltfScene gltf_scene(const GltfDocument& document, const std::filesystem::path& path) {
  GltfScene scene;
  std::vector<bool> seen(document.nodes.size());
  std::vector<Visit> visits;
  add_reversed(visits, document.roots, {});
  while (!visits.empty()) {
    const Visit visit = visits.back();
    visits.pop_back();
    if (seen[visit.node]) {
      fail_file(path, fmt::format("nodes[{}] is reached twice: nodes must be a tree", visit.node));
    }
    seen[visit.node] = true;
    const GltfNode& node = document.nodes[visit.node];
    const GltfTransform transform = visit.parent * node.transform;
    add_instance(scene, node, transform);
    add_reversed(visits, node.children, transform);
  }
  return scene;
}

}  // namespace meshhier::mesh_io
