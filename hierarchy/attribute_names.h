// Vertex attributes as words.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/named_value.h"

#include <array>
#include <string>
#include <string_view>

namespace meshhier {

struct ColourTypeRow {
  std::string_view name;  ///< in files
  ColourType value;
  std::string_view for_people;
};
inline constexpr std::array kColourTypes{ColourTypeRow{"none", ColourType::none, ""},
                                         ColourTypeRow{"u8", ColourType::u8, "8-bit"},
                                         ColourTypeRow{"u16", ColourType::u16, "16-bit"},
                                         ColourTypeRow{"f32", ColourType::f32, "float"}};

/// For people: "normals, 8-bit colours with alpha"; "none".
std::string attribute_names(const AttributeLayout& layout);

}  // namespace meshhier
