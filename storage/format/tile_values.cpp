#include "storage/format/tile_values.h"

#include "hierarchy/value_channels.h"
#include "storage/format/glb.h"
#include "storage/format/glb_material.h"
#include "storage/format/metadata_ids.h"
#include "storage/format/tile_object_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

const char* component_name(unsigned component) {
  switch (component) {
    case kI8:
      return "INT8";
    case kU8:
      return "UINT8";
    case kI16:
      return "INT16";
    case kU16:
      return "UINT16";
    default:
      return "FLOAT32";
  }
}

}  // namespace

unsigned component_of(ValueType type) {
  switch (type) {
    case ValueType::i8:
      return kI8;
    case ValueType::u8:
      return kU8;
    case ValueType::i16:
      return kI16;
    case ValueType::u16:
      return kU16;
    default:
      return kF32;
  }
}

double stored_value(ValueType type, double value) {
  if (component_of(type) != kF32)
    return of_type(type, value);
  if (!std::isfinite(value))
    return kNoValue;
  constexpr float kMost = std::numeric_limits<float>::max();
  const float least = std::nextafter(kNoValue, 0.0F);
  return static_cast<float>(
      std::clamp(is_integer(type) ? of_type(type, value) : value, double{least}, double{kMost}));
}

double value_of_stored(ValueType type, double stored) {
  if (component_of(type) == kF32 && stored == kNoValue)
    return is_integer(type) ? 0 : std::numeric_limits<double>::quiet_NaN();
  return of_type(type, stored);
}

bool loses_values(const AttributeLayout& layout, const VertexArray& vertices, bool labels_only) {
  const auto channels = static_cast<std::size_t>(layout.channels());
  for (const PlacedValue& value : placed_values(layout)) {
    for (std::size_t v = 0; (value.is_label || !labels_only) && v < vertices.size(); ++v) {
      const float* given = vertices.attributes.data() + v * channels + value.channel;
      std::array<float, 2> read{};
      put_value(value.type,
                value_of_stored(value.type, stored_value(value.type, value_in(value.type, given))),
                read.data());
      for (std::size_t i = 0; i < value.channels(); ++i) {
        if (std::bit_cast<std::uint32_t>(read[i]) != std::bit_cast<std::uint32_t>(given[i]))
          return true;
      }
    }
  }
  return false;
}

std::vector<std::string> value_attributes(const AttributeLayout& layout, bool has_feature_ids) {
  std::vector<std::string> names{kUnshownColours};
  if (has_feature_ids)
    names.emplace_back(kFeatureAttribute);
  // A kind's own name may begin as those of values do.
  for (const AttributeKindRow& row : kAttributeKinds)
    names.emplace_back(row.gltf);
  const auto taken = static_cast<std::ptrdiff_t>(names.size());
  for (const ScalarAttribute& value : layout.values) {
    std::string word = as_word(value.name);
    word.erase(0, std::min(word.find_first_not_of('_'), word.size()));
    std::ranges::transform(word, word.begin(), [](char c) {
      return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    add_unique(names, '_' + word);
  }
  names.erase(names.begin(), names.begin() + taken);
  return names;
}

std::vector<std::string> value_ids(const AttributeLayout& layout) {
  std::vector<std::string> names;
  for (const ScalarAttribute& value : layout.values)
    names.push_back(value.name);
  return metadata_ids(names);
}

Json vertex_class(const AttributeLayout& layout) {
  const std::vector<std::string> ids = value_ids(layout);
  Json properties = Json::object();
  for (std::size_t i = 0; i < layout.values.size(); ++i) {
    const unsigned component = component_of(layout.values[i].type);
    Json& property = properties[ids[i]];
    property["name"] = layout.values[i].name;
    property["type"] = "SCALAR";
    property["componentType"] = component_name(component);
    if (component == kF32)
      property["noData"] = double{kNoValue};
  }
  return Json::object({{"properties", std::move(properties)}});
}

Json values_metadata(const AttributeLayout& layout, bool has_feature_ids) {
  const std::vector<std::string> ids = value_ids(layout);
  const std::vector<std::string> attributes = value_attributes(layout, has_feature_ids);
  Json places = Json::object();
  for (std::size_t i = 0; i < ids.size(); ++i)
    places[ids[i]]["attribute"] = attributes[i];
  Json metadata;
  metadata["schema"]["id"] = "meshhier";
  metadata["schema"]["classes"]["vertex"] = vertex_class(layout);
  metadata["propertyAttributes"] =
      Json::array({{{"class", "vertex"}, {"properties", std::move(places)}}});
  return metadata;
}

}  // namespace meshhier::storage
