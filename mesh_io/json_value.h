// Values of JSON as those of objects.
#pragma once

#include "hierarchy/object_row.h"

#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {

/// Returns a value of JSON as one of an object: lists and objects are texts of JSON, and so are
/// integers that no double holds; null is no value.
ObjectValue value_of_json(const nlohmann::json& value);

}  // namespace meshhier::mesh_io
