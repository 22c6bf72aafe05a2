#include "mesh_io/ply_value_plan.h"

#include "mesh_io/ply_properties.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {
namespace {

/// A name that MeshLab gives to its own notes, as that vertices and faces are selected.
constexpr std::string_view kBookkeeping = "flags";

/// The properties of a face, in every spelling, that say what vertices say better, or which texture
/// it has.
std::vector<int> known_properties(const PlyElement& element, const std::filesystem::path& path) {
  std::vector<int> known;
  for (const PlyAttribute& attribute : kPlyAttributes) {
    if (!attribute.is_of_faces)
      continue;
    for (std::size_t i = 0; i < attribute.spellings(); ++i) {
      std::vector<int> found(attribute.spelling(i).size());
      if (find_all(element, attribute.spelling(i), found, path))
        known.insert(known.end(), found.begin(), found.end());
    }
  }
  for (const PlyColourNames& names : kPlyColours) {
    if (const auto colour = find_colour(element, names, path))
      known.insert(known.end(), colour->properties.begin(), colour->properties.end());
  }
  for (const std::string_view name : kPlyTextureNumbers)
    known.push_back(find_scalar(element, name, path));
  return known;
}

}  // namespace

std::optional<ScalarAttribute> value_of(const PlyProperty& property, const AttributeChoice& choice,
                                        PlyWrittenBy writer, const AttributeLayout& known) {
  const ValueType type = value_type(property.type);
  const bool is_label =
      choice.labels ? choice.is_label(property.name, type) : is_integer(property.type);
  ScalarAttribute value{property.name, type, is_label};
  if (writer == PlyWrittenBy::import) {
    const auto* kind = std::ranges::find_if(kValueKinds, [&](const auto& one) {
      return property.name.starts_with(imported_prefix(one.value));
    });
    if (kind == kValueKinds.end())
      return std::nullopt;
    set_kind(value, kind->value);
    value.name.erase(0, imported_prefix(kind->value).size());
  } else if (!choice.takes(value.name) ||
             (choice.which == AttributeChoice::Which::all && value.name == kBookkeeping)) {
    return std::nullopt;
  }
  const bool is_new =
      std::ranges::find(known.values, value.name, &ScalarAttribute::name) == known.values.end();
  const bool fits = known.value_channels() + channels_of(type) <= kMaxValueChannels;
  return is_attribute_name(value.name) && is_new && fits ? std::optional(value) : std::nullopt;
}

void plan_face_values(PlyPlan& plan, const AttributeChoice& choice,
                      const std::filesystem::path& path) {
  AttributeLayout known = plan.attributes;
  for (PlyElementPlan& one : plan.elements) {
    if (one.role != PlyElementPlan::Role::polygons)
      continue;
    const std::vector<int> others = known_properties(one.element, path);
    for (std::size_t i = 0; i < one.element.properties.size(); ++i) {
      const PlyProperty& property = one.element.properties[i];
      const bool is_other = std::ranges::find(others, static_cast<int>(i)) != others.end();
      if (property.is_list() || one.takes(i) || is_other)
        continue;
      if (const auto value = value_of(property, choice, PlyWrittenBy::anyone, known)) {
        known.values.push_back(*value);
        plan.face_values.push_back(*value);
        one.values.push_back(i);
      }
    }
  }
}

}  // namespace meshhier::mesh_io
