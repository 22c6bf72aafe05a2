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

void add_instance(GltfScene& scene, const GltfDocument& document, std::uint32_t number,
                  const GltfTransform& transform) {
  const GltfNode& node = document.nodes[number];
  scene.cameras += node.is_camera ? 1 : 0;
  if (!node.mesh)
    return;
  scene.instances.push_back({*node.mesh, transform, node.instancing, node.skin, number});
}

}  // namespace

std::vector<std::uint32_t> parents_of(const GltfDocument& document) {
  std::vector<std::uint32_t> parents(document.nodes.size(), kNoParent);
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    for (const std::uint32_t child : document.nodes[i].children) {
      if (parents[child] == kNoParent)
        parents[child] = i;
    }
  }
  return parents;
}

namespace {

GltfTransform moved_by(Vec3d offset) {
  GltfTransform transform;
  transform.offset = offset;
  return transform;
}

/// Places what no scene shows: each behind its parents, which may be placed.
void place_others(const GltfDocument& document, const std::filesystem::path& path,
                  const GltfTransform& placement, std::vector<bool>& seen,
                  std::vector<GltfTransform>& places) {
  const std::vector<std::uint32_t> parents = parents_of(document);
  for (std::uint32_t first = 0; first < parents.size(); ++first) {
    std::vector<std::uint32_t> way;
    for (std::uint32_t node = first; node != kNoParent && !seen[node]; node = parents[node]) {
      if (way.size() == parents.size())
        fail_file(path, fmt::format("nodes[{}] is below itself: nodes must be a tree", node));
      way.push_back(node);
    }
    for (; !way.empty(); way.pop_back()) {
      const std::uint32_t node = way.back();
      const std::uint32_t parent = parents[node];
      places[node] =
          (parent == kNoParent ? placement : places[parent]) * document.nodes[node].transform;
      seen[node] = true;
    }
  }
}

}  // namespace

GltfScene gltf_scene(const GltfDocument& document, const std::filesystem::path& path,
                     const GltfTransform& placement) {
  GltfScene scene;
  std::vector<bool> seen(document.nodes.size());
  std::vector<Visit> visits;
  const GltfTransform root = placement * moved_by(document.centre);
  if (!document.skins.empty())
    scene.places.resize(document.nodes.size());
  add_reversed(visits, document.roots, root, true);
  while (!visits.empty()) {
    const Visit visit = visits.back();
    visits.pop_back();
    if (seen[visit.node]) {
      fail_file(path, fmt::format("nodes[{}] is reached twice: nodes must be a tree", visit.node));
    }
    seen[visit.node] = true;
    const GltfNode& node = document.nodes[visit.node];
    const GltfTransform transform = visit.parent * node.transform;
    if (!scene.places.empty())
      scene.places[visit.node] = transform;
    const bool is_visible = visit.is_visible && node.is_visible;
    if (is_visible)
      add_instance(scene, document, visit.node, transform);
    else
      scene.hidden += node.mesh ? 1 : 0;
    add_reversed(visits, node.children, transform, is_visible);
  }
  if (!scene.places.empty())
    place_others(document, path, root, seen, scene.places);
  return scene;
}

}  // namespace meshhier::mesh_io
