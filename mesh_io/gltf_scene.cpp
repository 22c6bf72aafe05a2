#include "mesh_io/gltf_scene.h"

#include "mesh_io/input_error.h"

#include <cstddef>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

struct Visit {
  std::uint32_t node;
  GltfTransform parent;
  bool is_visible;
};

void add_reversed(std::vector<Visit>& visits, const std::vector<std::uint32_t>& nodes,
                  const GltfTransform& parent, bool are_visible) {
  for (std::size_t i = nodes.size(); i-- > 0;)
    visits.push_back({nodes[i], parent, are_visible});
}

void add_instance(GltfScene& scene, const GltfNode& node, const GltfTransform& transform) {
  scene.cameras += node.is_camera ? 1 : 0;
  if (!node.mesh)
    return;
  scene.skinned += node.is_skinned ? 1 : 0;
  scene.instances.push_back({*node.mesh, transform, node.instancing});
}

GltfTransform moved_by(Vec3d offset) {
  GltfTransform transform;
  transform.offset = offset;
  return transform;
}

}  // namespace

GltfScene gltf_scene(const GltfDocument& document, const std::filesystem::path& path,
                     const GltfTransform& placement) {
  GltfScene scene;
  std::vector<bool> seen(document.nodes.size());
  std::vector<Visit> visits;
  add_reversed(visits, document.roots, placement * moved_by(document.centre), true);
  while (!visits.empty()) {
    const Visit visit = visits.back();
    visits.pop_back();
    if (seen[visit.node]) {
      fail_file(path, fmt::format("nodes[{}] is reached twice: nodes must be a tree", visit.node));
    }
    seen[visit.node] = true;
    const GltfNode& node = document.nodes[visit.node];
    const GltfTransform transform = visit.parent * node.transform;
    const bool is_visible = visit.is_visible && node.is_visible;
    if (is_visible)
      add_instance(scene, node, transform);
    else
      scene.hidden += node.mesh ? 1 : 0;
    add_reversed(visits, node.children, transform, is_visible);
  }
  return scene;
}

}  // namespace meshhier::mesh_io
