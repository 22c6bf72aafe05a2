#include "hierarchy/attributes.h"

namespace meshhier {
namespace {

std::string name_of(const AttributeKindRow& row, const AttributeLayout& layout) {
  const std::string name(row.for_people);
  if (row.kind == AttributeKind::colours)
    return std::string(row_of(layout.colour).for_people) + ' ' + name +
           (layout.alpha ? " with alpha" : "");
  return name;
}

}  // namespace

std::string attribute_names(const AttributeLayout& layout) {
  std::string names;
  const auto add = [&](const std::string& name) {
    names.append(names.empty() ? "" : ", ").append(name);
  };
  for (const AttributeKindRow& row : kAttributeKinds) {
    const bool is_told_by_material = row.kind == AttributeKind::texcoords && layout.material;
    const bool comes_last = row.kind == AttributeKind::values;
    if (row.channels(layout) > 0 && !is_told_by_material && !comes_last)
      add(name_of(row, layout));
  }
  if (const std::size_t count = layout.values.size(); count > 0)
    add(std::to_string(count) + (count == 1 ? " value" : " values"));
  return names.empty() ? "none" : names;
}

}  // namespace meshhier
