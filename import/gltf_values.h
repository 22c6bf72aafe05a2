// What vertices of glTF have besides the attributes that glTF names: those of applications,
// `_NAME`.
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

/// A value, and where it comes from.
struct GltfValue {
  ScalarAttribute attribute;
  std::string source;           ///< "_QUALITY"
  std::uint32_t component = 0;  ///< of its elements
};

/// Of attributes of glTF, without what marks them as an application's: ids of features.
inline bool is_feature_name(std::string_view name) {
  return name.starts_with("FEATURE_ID_") || name == "BATCHID";
}

/// Collects the attributes of applications that primitives have.
class GltfValues {
 public:
  explicit GltfValues(const mesh_io::AttributeChoice& choice) : choice_(choice) {}

  /// Of one that has triangles.
  void add(const mesh_io::GltfDocument& document, const mesh_io::GltfPrimitive& primitive);

  /// Those that are read, in the order of their names: `_NAME` is "NAME"; of several components
  /// "NAME_1", "NAME_2", and so on; of primitives of several types the one that holds all. Integers
  /// that not all primitives have are left out, because no number says that there is none; others
  /// are NaN there. Ids of features (EXT_mesh_features, b3dm) are labels whatever their type.
  std::vector<GltfValue> values() const;
  /// How many vertices have what was left out for that.
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
