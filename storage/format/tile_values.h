// Values of vertices as tiles hold them (docs/file_format.md, section 4.11): an accessor of glTF
// each, and what EXT_structural_metadata says of them.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/tile_mesh.h"

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

inline constexpr const char* kMetadataExtension = "EXT_structural_metadata";

/// Each value of a vertex takes so many bytes of the section, whatever its component type.
inline constexpr std::size_t kValueStride = 4;
/// What a float accessor has where a vertex has no finite value, as glTF allows neither NaN nor
/// infinities.
inline constexpr float kNoValue = std::numeric_limits<float>::lowest();

/// Of the accessor: integers of up to 16 bits as they are, others as floats.
unsigned component_of(ValueType type);
/// What the accessor has of a value, a number of its component type; finite.
double stored_value(ValueType type, double value);
/// The inverse, as far as there is one.
double value_of_stored(ValueType type, double stored);

/// Whether the accessors have less than there is: of any value, or of labels alone.
bool loses_values(const AttributeLayout& layout, const VertexArray& vertices, bool labels_only);

/// What each is called in glTF: "_QUALITY"; no name twice.
std::vector<std::string> value_attributes(const AttributeLayout& layout);
/// Likewise as an id of EXT_structural_metadata and 3D Tiles: letters, digits and underscores.
std::vector<std::string> value_ids(const AttributeLayout& layout);

/// Of the root's extension: the class, and the one property attribute.
nlohmann::ordered_json values_metadata(const AttributeLayout& layout);

}  // namespace meshhier::storage
