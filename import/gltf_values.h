// Values of glTF's vertices: the attributes of applications, `_NAME`, and ids of features.
#pragma once

#include "hierarchy/attributes.h"
#include "mesh_io/attribute_choice.h"
#include "mesh_io/gltf_document.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

/// A value, and its source.
struct GltfValue {
  ScalarAttribute attribute;
  std::string source;           ///< "_QUALITY"
  std::uint32_t component = 0;  ///< component of its elements
};

/// Returns whether a name is one of ids of features; the name comes without the mark of an
/// application's attribute.
inline bool is_feature_name(std::string_view name) {
  return name.starts_with("FEATURE_ID_") || name == "BATCHID";
}

/// Collects the attributes of applications that primitives have.
class GltfValues {
 public:
  explicit GltfValues(const mesh_io::AttributeChoice& choice) : choice_(choice) {}

  /// Takes the attributes of a primitive, which has triangles.
  void add(const mesh_io::GltfDocument& document, const mesh_io::GltfPrimitive& primitive);

  /// Returns the values that are read, in the order of their names: `_NAME` is "NAME", its
  /// components "NAME_1", "NAME_2", and so on if there are several. Where primitives have several
  /// types, the value has the one that holds all. Integers that not all primitives have are left
  /// out, because no number says that there is none; others are NaN there. Ids of features
  /// (EXT_mesh_features, b3dm) are labels whatever their type.
  std::vector<GltfValue> values() const;
  /// Returns how many vertices have values that were left out for that.
  std::uint64_t dropped() const;

 private:
  struct Found {
    ValueType type{};
    std::uint32_t components = 1;
    std::uint64_t primitives = 0, vertices = 0;
  };
  bool is_dropped(const Found& found) const {
    return is_integer(found.type) && found.primitives < primitives_;
  }
  bool is_label(const std::string& name, ValueType type) const;

  const mesh_io::AttributeChoice& choice_;
  std::map<std::string, Found> found_;  ///< by the name in the file
  std::uint64_t primitives_ = 0;
};

}  // namespace meshhier::importing
