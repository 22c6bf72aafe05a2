// Objects: the things that a mesh consists of, as the buildings of a city. Each has a number, a
// name and properties.
//
// Objects are numbered ascending by name, compared byte by byte; no name is there twice. So a name
// is found by bisection, and the objects of a branch ("storey/room/...") are a range.
#pragma once

#include "base/bounds.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace meshhier {

/// A float holds every such number.
inline constexpr std::uint32_t kMostObjects = std::uint32_t{1} << 24;
inline constexpr std::size_t kMostObjectProperties = 64;
inline constexpr std::size_t kMostPropertyNameBytes = 255;
/// The name and the texts of one object have so many bytes at most, together.
inline constexpr std::size_t kMostObjectTextBytes = std::size_t{1} << 20;

/// A date is a text as ISO 8601 has it.
enum class ObjectPropertyType : std::uint8_t { number, boolean, text, date };
inline constexpr std::size_t kObjectPropertyTypes = 4;
/// "number", "boolean", "text", "date".
std::string_view name_of(ObjectPropertyType type);
std::optional<ObjectPropertyType> object_property_type_of(std::string_view name);

struct ObjectProperty {
  std::string name;  ///< UTF-8, 1 to kMostPropertyNameBytes
  ObjectPropertyType type{};
  friend bool operator==(const ObjectProperty&, const ObjectProperty&) = default;
};

/// No value, a finite number, a boolean, or a text in UTF-8 (also of a date).
using ObjectValue = std::variant<std::monostate, double, bool, std::string>;

/// Whether a value may be one of a property of that type.
bool is_value_of(ObjectPropertyType type, const ObjectValue& value);

/// All that is known of one object.
struct ObjectRow {
  std::string name;                 ///< UTF-8; empty: the faces of no object
  std::vector<ObjectValue> values;  ///< one of each property
  std::optional<BoundsD> box;       ///< of its triangles, in the input's coordinates
  std::uint64_t triangles = 0;
  double area = 0;  ///< of its triangles, in the input's units
  friend bool operator==(const ObjectRow&, const ObjectRow&) = default;
};

/// Returns the bytes that kMostObjectTextBytes bounds.
std::size_t text_bytes(const ObjectRow& row);

}  // namespace meshhier
