// Values of vertices as tiles hold them (docs/file_format.md, section 4.11): each is an accessor of
// glTF, and EXT_structural_metadata describes them.
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
/// A float accessor has this where a vertex has no finite value, as glTF allows neither NaN nor
/// infinities.
inline constexpr float kNoValue = std::numeric_limits<float>::lowest();

/// Returns the accessor's component type: integers of up to 16 bits are stored as they are, others
/// as floats.
unsigned component_of(ValueType type);
/// Returns the accessor's number for a value: finite, of its component type.
double stored_value(ValueType type, double value);
/// Returns the value that stored_value() was given, as far as it is known.
double value_of_stored(ValueType type, double stored);

/// Whether the accessors lose a part of any value, or, if `labels_only`, of any label.
bool loses_values(const AttributeLayout& layout, const VertexArray& vertices, bool labels_only);

/// Returns the name of each value in glTF, "_QUALITY"; no name twice, and none that rows of a
/// tile's table of objects have.
std::vector<std::string> value_attributes(const AttributeLayout& layout, bool has_feature_ids);
/// Returns the id of each in EXT_structural_metadata and 3D Tiles: letters, digits and underscores;
/// no id twice.
std::vector<std::string> value_ids(const AttributeLayout& layout);

/// Returns the class of a vertex in a schema.
nlohmann::ordered_json vertex_class(const AttributeLayout& layout);
/// Returns the content of the root's extension: the class, and the one property attribute.
nlohmann::ordered_json values_metadata(const AttributeLayout& layout, bool has_feature_ids);

}  // namespace meshhier::storage
