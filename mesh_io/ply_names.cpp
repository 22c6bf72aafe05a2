#include "mesh_io/ply_names.h"

#include "base/small_letters.h"
#include "mesh_io/text_chars.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {
namespace {

/// Returns a name in small letters, without the characters that join words.
std::string bare(std::string_view name) {
  std::string letters = small_letters(name);
  std::erase_if(letters, [](char c) { return c == '_' || c == '-' || c == ' '; });
  return letters;
}

struct ElementNames {
  std::string_view name;
  std::array<std::string_view, 3> bare_names;
};
constexpr std::array<ElementNames, 3> kElementNames{{{"vertex", {"vertex", "vertices", "vertexes"}},
                                                     {"face", {"face", "faces", "polygons"}},
                                                     {"tristrips", {"tristrips", "tristrip"}}}};

constexpr std::string_view kCorners = "vertex_indices";
constexpr std::array<std::string_view, 2> kCornerNames{kCorners, "vertex_index"};
constexpr std::array<std::string_view, 7> kBareCornerNames{
    "vertexindices", "vertexindex", "vertexindexes", "vertexids", "vertices", "indices", "indexes"};

/// Prefixes of scalars that are corners; kSuffixes tell the corners apart.
constexpr std::array<std::string_view, 13> kPrefixes{
    "",      "v",   "vert", "vertex", "vertexindex", "vertexindices", "vertexid",
    "index", "idx", "i",    "p",      "point",       "corner"};
constexpr std::array<std::string_view, 4> kSuffixes{"0123", "1234", "abcd", "ijkl"};

/// The one that `is_it` says; none if there is none or are several.
template <class Item, class Is>
Item* only_one(std::vector<Item>& items, const Is& is_it) {
  const auto first = std::ranges::find_if(items, is_it);
  if (first == items.end() || std::find_if(first + 1, items.end(), is_it) != items.end())
    return nullptr;
  return &*first;
}

std::uint64_t settle_element(std::vector<PlyElement>& elements, const ElementNames& names) {
  if (std::ranges::find(elements, names.name, &PlyElement::name) != elements.end())
    return 0;
  PlyElement* const meant = only_one(elements, [&](const PlyElement& element) {
    return is_one_of(bare(element.name), names.bare_names);
  });
  if (meant == nullptr)
    return 0;
  meant->name = names.name;
  return 1;
}

/// Returns whether names are those of corners: all one, or a common beginning with an end that
/// tells corners apart.
bool are_corners(std::span<const PlyProperty> properties) {
  const std::string first = bare(properties[0].name);
  const auto all_are = [&](const auto& name_of_corner) {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (bare(properties[i].name) != name_of_corner(i))
        return false;
    }
    return true;
  };
  if (is_one_of(first, kBareCornerNames) && all_are([&](std::size_t) { return first; }))
    return true;
  if (first.empty() || !is_one_of(std::string_view(first).substr(0, first.size() - 1), kPrefixes))
    return false;
  const std::string prefix = first.substr(0, first.size() - 1);
  return std::ranges::any_of(kSuffixes, [&](std::string_view suffixes) {
    return all_are([&](std::size_t i) { return prefix + suffixes[i]; });
  });
}

bool are_scalars_of_one_type(std::span<const PlyProperty> properties) {
  return std::ranges::all_of(properties, [&](const PlyProperty& property) {
    return !property.is_list() && property.type == properties[0].type && is_integer(property.type);
  });
}

std::uint64_t join_corners(PlyElement& element) {
  std::vector<PlyProperty>& all = element.properties;
  for (std::size_t first = 0; first < all.size(); ++first) {
    for (const std::size_t count : {std::size_t{4}, std::size_t{3}}) {
      if (first + count > all.size())
        continue;
      const std::span run(all.data() + first, count);
      if (!are_scalars_of_one_type(run) || !are_corners(run))
        continue;
      all[first].name = kCorners;
      all[first].fixed_count = static_cast<std::uint8_t>(count);
      const auto second = all.begin() + static_cast<std::ptrdiff_t>(first) + 1;
      all.erase(second, second + static_cast<std::ptrdiff_t>(count) - 1);
      return count;
    }
  }
  return 0;
}

std::uint64_t settle_corners(PlyElement& element) {
  const auto is_exact = [](const PlyProperty& property) {
    return property.is_list() && is_one_of(property.name, kCornerNames);
  };
  if (std::ranges::any_of(element.properties, is_exact))
    return 0;
  PlyProperty* const meant = only_one(element.properties, [](const PlyProperty& property) {
    return property.is_list() && is_integer(property.type) &&
           is_one_of(bare(property.name), kBareCornerNames);
  });
  if (meant == nullptr)
    return element.name == kElementNames[1].name ? join_corners(element) : 0;
  meant->name = kCorners;
  return 1;
}

}  // namespace

std::uint64_t settle_ply_names(std::vector<PlyElement>& elements) {
  std::uint64_t lines = 0;
  for (const ElementNames& names : kElementNames)
    lines += settle_element(elements, names);
  for (PlyElement& element : elements) {
    if (element.name == kElementNames[1].name || element.name == kElementNames[2].name)
      lines += settle_corners(element);
  }
  return lines;
}

}  // namespace meshhier::mesh_io
