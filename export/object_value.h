// A value of objects by its name: a property, or a fact of all objects (object_condition.h).
#pragma once

#include "hierarchy/object_row.h"

#include <functional>
#include <span>
#include <string_view>

namespace meshhier::exporting {

struct ObjectValueOf {
  ObjectPropertyType type{};
  std::function<ObjectValue(const ObjectRow& row)> get;
};

/// Throws Error(usage), which lists what there is, if objects have nothing of that name.
ObjectValueOf value_named(std::string_view name, std::span<const ObjectProperty> properties);

}  // namespace meshhier::exporting
