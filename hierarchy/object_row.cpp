#include "hierarchy/object_row.h"

#include <algorithm>
#include <array>

namespace meshhier {
namespace {

constexpr std::array<std::string_view, kObjectPropertyTypes> kTypeNames{"number", "boolean", "text",
                                                                        "date"};

}  // namespace

std::string_view name_of(ObjectPropertyType type) {
  return kTypeNames[static_cast<std::size_t>(type)];
}

std::optional<ObjectPropertyType> object_property_type_of(std::string_view name) {
  const auto found = std::ranges::find(kTypeNames, name);
  if (found == kTypeNames.end())
    return std::nullopt;
  return static_cast<ObjectPropertyType>(found - kTypeNames.begin());
}

bool is_value_of(ObjectPropertyType type, const ObjectValue& value) {
  switch (type) {
    case ObjectPropertyType::number:
      return std::holds_alternative<std::monostate>(value) || std::holds_alternative<double>(value);
    case ObjectPropertyType::boolean:
      return std::holds_alternative<std::monostate>(value) || std::holds_alternative<bool>(value);
    default:
      return std::holds_alternative<std::monostate>(value) ||
             std::holds_alternative<std::string>(value);
  }
}

std::size_t text_bytes(const ObjectRow& row) {
  std::size_t bytes = row.name.size();
  for (const ObjectValue& value : row.values) {
    if (const auto* text = std::get_if<std::string>(&value))
      bytes += text->size();
  }
  return bytes;
}

}  // namespace meshhier
