#include "hierarchy/attribute_names.h"

#include <string_view>

namespace meshhier {

std::string attribute_names(const AttributeLayout& layout) {
  std::string names;
  const auto add = [&](bool present, std::string_view name) {
    if (present)
      names.append(names.empty() ? "" : ", ").append(name);
  };
  add(layout.normals, "normals");
  add(layout.colour != ColourType::none,
      std::string(row_with(kColourTypes, layout.colour).for_people) + " colours" +
          (layout.alpha ? " with alpha" : ""));
  add(layout.texcoords && !layout.material, "texture coordinates");
  add(layout.material, "textures");
  add(!layout.values.empty(),
      std::to_string(layout.values.size()) + (layout.values.size() == 1 ? " value" : " values"));
  return names.empty() ? "none" : names;
}

}  // namespace meshhier
