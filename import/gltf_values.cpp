#include "import/gltf_values.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::uint32_t kMostComponents = 4;  // matrices are none

ValueType type_of(mesh_io::GltfComponent component) {
  switch (component) {
    case mesh_io::GltfComponent::i8:
      return ValueType::i8;
    case mesh_io::GltfComponent::u8:
      return ValueType::u8;
    case mesh_io::GltfComponent::i16:
      return ValueType::i16;
    case mesh_io::GltfComponent::u16:
      return ValueType::u16;
    case mesh_io::GltfComponent::u32:
      return ValueType::u32;
    case mesh_io::GltfComponent::f32:
      break;
  }
  return ValueType::f32;
}

/// Holds the values of both.
ValueType common_type(ValueType a, ValueType b) {
  if (a == b)
    return a;
  return takes_two_channels(a) || takes_two_channels(b) ? ValueType::f64 : ValueType::f32;
}

}  // namespace

void GltfValues::add(const mesh_io::GltfDocument& document,
                     const mesh_io::GltfPrimitive& primitive) {
  ++primitives_;
  for (const auto& [name, accessor] : primitive.attributes) {
    // Tiles of textured hierarchies have _COLOR_0, and a kind's own name may begin with _, too.
    const bool is_kind =
        std::ranges::find(kAttributeKinds, name, &AttributeKindRow::gltf) != kAttributeKinds.end();
    if (!name.starts_with('_') || name == "_COLOR_0" || is_kind || !is_attribute_name(name) ||
        document.accessors[accessor].components > kMostComponents)
      continue;
    const mesh_io::GltfAccessor& from = document.accessors[accessor];
    const ValueType type = type_of(from.component);
    const auto [at, is_new] = found_.emplace(name, Found{type, from.components});
    Found& found = at->second;
    found.type = common_type(found.type, type);
    found.components = std::min(found.components, from.components);
    ++found.primitives;
    found.vertices += from.count;
  }
}

bool GltfValues::is_label(const std::string& name, ValueType type) const {
  return choice_.is_label(name, type) || (!choice_.labels && is_feature_name(name));
}

std::vector<GltfValue> GltfValues::values() const {
  std::vector<GltfValue> values;
  int channels = 0;
  for (const auto& [source, found] : found_) {
    for (std::uint32_t i = 0; i < found.components && !is_dropped(found); ++i) {
      const std::string name =
          source.substr(1) + (found.components > 1 ? fmt::format("_{}", i + 1) : "");
      const bool is_known = std::ranges::any_of(
          values, [&](const GltfValue& value) { return value.attribute.name == name; });
      if (!is_attribute_name(name) || is_known || !choice_.takes(name) ||
          channels + channels_of(found.type) > kMaxValueChannels)
        continue;
      channels += channels_of(found.type);
      values.push_back({{name, found.type, is_label(name, found.type)}, source, i});
    }
  }
  return values;
}

std::uint64_t GltfValues::dropped() const {
  std::uint64_t vertices = 0;
  for (const auto& [name, found] : found_) {
    if (is_dropped(found) && choice_.takes(name.substr(1)))
      vertices += found.vertices;
  }
  return vertices;
}

}  // namespace meshhier::importing
