// Objects of a glTF: its nodes that show a mesh, its materials, or its features.
#pragma once

#include "import/gltf_features.h"
#include "import/gltf_place.h"
#include "import/gltf_primitive.h"
#include "import/raw_mesh.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_scene.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::importing {

/// Says whose the triangles of a scene are. For one thread.
class GltfObjects {
 public:
  /// `objects`: those of the mesh; null: nobody asks. All must outlive it.
  GltfObjects(mesh_io::GltfFile& file, const mesh_io::GltfScene& scene, RawMesh& mesh,
              const GltfPlace& place, const ImportRoom& room);

  /// Says which mesh of the scene is appended next.
  void begin(const mesh_io::GltfInstance& instance) { instance_ = &instance; }
  /// Says which of its copies is, from 1 on; 0: it has none.
  void begin_copy(std::uint64_t copy) { copy_ = copy; }
  /// Takes the triangles of a primitive that the mesh has from `first` on. Their vertices, which it
  /// gets next, are those in `used`, of `count`.
  void add(const mesh_io::GltfPrimitive& primitive, const PrimitiveSources& sources,
           std::uint64_t first, const storage::RecordSpool<std::uint32_t>& used,
           std::uint64_t count);
  /// Returns how many sets of feature ids were passed over, as textures have them.
  std::uint64_t features_in_textures() const { return features_ ? features_->in_textures() : 0; }
  std::uint64_t unread_tables() const {
    return unread_ + (features_ ? features_->unread_tables() : 0);
  }

 private:
  bool has_features(mesh_io::FeatureTable* batch);
  bool are_features_evident(mesh_io::FeatureTable* batch) const;
  bool add_features(const mesh_io::GltfPrimitive& primitive, const PrimitiveSources& sources,
                    std::uint64_t first, const storage::RecordSpool<std::uint32_t>& used,
                    std::uint64_t count);
  bool are_nodes_evident() const;
  const std::string& name_of_node(std::uint32_t node) const;
  std::string path_to(std::uint32_t node) const;
  std::string own_name(const std::string& wanted);
  ObjectValues values_of(std::uint32_t node);
  std::uint32_t object_here();

  mesh_io::GltfFile& file_;
  const mesh_io::GltfDocument& document_;
  const mesh_io::GltfScene& scene_;
  RawMesh& mesh_;
  MeshObjects* objects_;
  const ImportRoom& room_;
  std::optional<GltfFeatures> features_;
  std::uint64_t unread_ = 0;  ///< tables that are damaged, before there are features
  bool are_nodes_ = false, are_materials_ = false;
  std::vector<std::uint32_t> parents_;
  std::map<std::string, std::uint64_t> taken_;  ///< names of nodes, each with how many have it
  const mesh_io::GltfInstance* instance_ = nullptr;
  std::uint64_t copy_ = 0;
  /// The node and the copy that have the number `object_`.
  std::pair<std::uint32_t, std::uint64_t> known_{UINT32_MAX, 0};
  std::uint32_t object_ = 0;
};

}  // namespace meshhier::importing
