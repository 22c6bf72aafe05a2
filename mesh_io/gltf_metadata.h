// Features of glTF (EXT_mesh_features) and tables of their properties (EXT_structural_metadata).
//
// A vertex has the number of its feature in an attribute; a feature is a row of a table:
//
//     _FEATURE_ID_0   0 0 0 1 1 2        height   name     roof        row
//                                        12.5     "Mill"   "gabled"    0
//                                         8.1     "Hall"   "flat"      1
//                                        31.0     "Tower"  "dome"      2
#pragma once

#include "mesh_io/feature_table.h"
#include "mesh_io/gltf_file.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A set of ids that a primitive's vertices have, or copies of a node's mesh.
struct GltfFeatureIds {
  std::uint64_t count = 0;
  std::optional<std::uint64_t> null_id{};  ///< that of no feature
  /// "_FEATURE_ID_0"; none: a texture has the ids, or else each vertex or copy has its own number.
  std::optional<std::string> attribute{};
  bool is_in_texture = false;
  std::optional<std::uint32_t> table{};
};

/// Returns the sets of a primitive (EXT_mesh_features) or of a node's copies
/// (EXT_instance_features); none if there is no such extension. Throws Error(input) naming the
/// place.
std::vector<GltfFeatureIds> feature_ids_of(const GltfFile& file,
                                           const std::shared_ptr<const nlohmann::json>& extension);

/// Returns how many property tables the document has.
std::size_t property_table_count(const GltfFile& file);
/// Opens a property table, whose class may be in a schema of another file. Throws Error(input)
/// naming the place if that is not there, if the table contradicts itself, or if its values have no
/// room where they should lie.
std::unique_ptr<FeatureTable> open_property_table(GltfFile& file, std::uint32_t number);

/// Counts of metadata of another kind than tables: textures and attributes of properties.
struct GltfOtherProperties {
  std::uint64_t textures = 0, attributes = 0;
};
GltfOtherProperties other_properties_of(const GltfFile& file);

}  // namespace meshhier::mesh_io
