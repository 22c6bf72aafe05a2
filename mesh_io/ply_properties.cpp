#include "mesh_io/ply_properties.h"

#include "base/small_letters.h"
#include "mesh_io/input_error.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

bool is_same_word(std::string_view a, std::string_view b) {
  return small_letters(a) == small_letters(b);
}

ColourType colour_type(PlyType type) {
  if (!is_integer(type))
    return ColourType::f32;
  return type == PlyType::u16 ? ColourType::u16 : ColourType::u8;
}

}  // namespace

int find_scalar(const PlyElement& element, std::string_view name,
                const std::filesystem::path& path) {
  int found = -1, similar = -1, similar_count = 0;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.is_list() || !is_same_word(property.name, name))
      continue;
    if (property.name != name) {
      similar = static_cast<int>(i);
      ++similar_count;
      continue;
    }
    if (found >= 0) {
      fail_file(path, fmt::format("expected property {} of element {} once, found it twice",
                                  in_quotes(name), in_quotes(element.name)));
    }
    found = static_cast<int>(i);
  }
  return found < 0 && similar_count == 1 ? similar : found;
}

bool find_all(const PlyElement& element, std::span<const std::string_view> names,
              std::span<int> found, const std::filesystem::path& path) {
  for (std::size_t i = 0; i < names.size(); ++i)
    found[i] = find_scalar(element, names[i], path);
  return std::all_of(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(names.size()),
                     [](int property) { return property >= 0; });
}

std::vector<int> find_attribute(const PlyElement& element, const PlyAttribute& attribute,
                                const std::filesystem::path& path) {
  for (std::size_t i = 0; i < attribute.spellings(); ++i) {
    std::vector<int> found(attribute.spelling(i).size());
    if (find_all(element, attribute.spelling(i), found, path))
      return found;
  }
  return {};
}

std::optional<std::size_t> find_list(const PlyElement& element,
                                     std::span<const std::string_view> names) {
  for (const std::string_view name : names) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.is_list() && is_same_word(property.name, name))
        return i;
    }
  }
  return std::nullopt;
}

std::optional<PlyColour> find_colour(const PlyElement& element, const PlyColourNames& names,
                                     const std::filesystem::path& path) {
  const auto type_of = [&](int property) {
    return element.properties[static_cast<std::size_t>(property)].type;
  };
  PlyColour colour;
  colour.properties.resize(3);
  if (!find_all(element, std::span(names).first(3), colour.properties, path))
    return std::nullopt;
  const PlyType type = type_of(colour.properties[0]);
  if (type_of(colour.properties[1]) != type || type_of(colour.properties[2]) != type)
    return std::nullopt;
  int alpha = find_scalar(element, names[3], path);
  if (alpha < 0)
    alpha = find_scalar(element, names[4], path);
  if (alpha >= 0 && type_of(alpha) == type)
    colour.properties.push_back(alpha);
  colour.kind = colour_type(type);
  colour.is_checked = is_integer(type) && type != PlyType::u8 && type != PlyType::u16;
  return colour;
}

}  // namespace meshhier::mesh_io
