// The part of a glTF in a larger scene.
#pragma once

#include "mesh_io/feature_table.h"
#include "mesh_io/gltf_transform.h"

#include <string>

namespace meshhier::importing {

struct GltfPlace {
  mesh_io::GltfTransform placement{};
  /// It belongs to a tileset or a similar tree, whose nodes are never evident as objects.
  bool is_tile = false;
  /// Before names that only number features: "tile.cmpt/2/"; empty: it is alone.
  std::string name{};
  mesh_io::FeatureTable* batch = nullptr;  ///< table of the b3dm that it is in; null: none
  bool is_batch_unread = false;            ///< there is one, which is damaged
};

}  // namespace meshhier::importing
