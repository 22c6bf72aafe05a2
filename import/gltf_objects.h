// Objects of a glTF: its nodes that show a mesh, its materials, or its features.
#pragma once

#include "import/gltf_features.h"
#include "import/gltf_place.h"
#include "import/gltf_primitive.h"
#include "import/raw_mesh.h"
#include "import/unread_metadata.h"
#include "mesh_io/gltf_elements.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_scene.h"

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
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
  void begin(const mesh_io::GltfInstance& instance);
  /// Says which of its copies is, from 1 on; 0: it has none.
  void begin_copy(std::uint64_t copy) { copy_ = copy; }
  /// Takes the triangles of a primitive that the mesh has from `first` on. Their vertices, which it
  /// gets next, are those in `used`, of `count`.
  void add(const mesh_io::GltfPrimitive& primitive, const PrimitiveSources& sources,
           std::uint64_t first, const storage::RecordSpool<std::uint32_t>& used,
           std::uint64_t count);
  /// Returns what was passed over, if objects may be features.
  UnreadMetadata unread() const;

 private:
  bool has_features(mesh_io::FeatureTable* batch);
  bool are_features_evident(mesh_io::FeatureTable* batch) const;
  template <class Visit>
  void for_each_features(const Visit& visit) const;
  void note_unread();
  std::uint32_t object_of_copy();
  void read_features(const mesh_io::GltfFeatureIds& ids, const PrimitiveSources& sources,
                     const storage::RecordSpool<std::uint32_t>& used, std::uint64_t count,
                     storage::RecordSpool<double>& features);
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
  UnreadMetadata unread_;  ///< tables: before there are features
  bool are_nodes_ = false, are_materials_ = false;
  std::vector<std::uint32_t> parents_;
  /// Checksums of nodes' names, each with how many have it: paths are long. Two that are alike by
  /// chance cost one of them a number.
  std::unordered_map<std::uint64_t, std::uint64_t> taken_;
  const mesh_io::GltfInstance* instance_ = nullptr;
  std::uint64_t copy_ = 0;
  std::optional<mesh_io::GltfFeatureIds> copy_ids_;    ///< those of the copies, if they have any
  std::optional<mesh_io::GltfElements> copy_feature_;  ///< a feature for each copy, if one says it
  /// The node and the copy that have the number `object_`.
  std::pair<std::uint32_t, std::uint64_t> known_{UINT32_MAX, 0};
  std::uint32_t object_ = 0;
};

}  // namespace meshhier::importing
