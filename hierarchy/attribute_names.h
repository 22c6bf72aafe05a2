// Vertex attributes as words.
#pragma once

#include "hierarchy/attributes.h"

#include <string>

namespace meshhier {

/// For people: "normals, 8-bit colours with alpha"; "none".
std::string attribute_names(const AttributeLayout& layout);

}  // namespace meshhier
