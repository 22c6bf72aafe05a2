// Which per-vertex attributes a mesh carries, what each kind of them is, and how they lie in
// memory.
//
// Inside meshhier every attribute is a float channel; a vertex has channels() floats, kind after
// kind in the order of kAttributeKinds:
//
//   normals     nx ny nz      as given (unit length or not)
//   colours     r g b [a]     the stored number: 0..255 for u8, 0..65535 for u16, as given for f32
//   values      one or two    each, as scalar_value.h says
//   texcoords   u v
//   material    m             its number in the mesh's MaterialList, where the coordinates count
//
// u8, u16 and float values are exact as float, so attributes survive bit for bit.
//
// Code that treats all kinds alike walks AttributeLayout::parts(); what it does with one follows
// from the kind's rule. Tables of formats name the kinds that a format holds: kAttributeSections in
// storage/format/tile_plan.h, kPlyAttributes in mesh_io/ply_properties.h.
#pragma once

#include "base/named_value.h"
#include "hierarchy/scalar_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier {

enum class ColourType : std::uint8_t { none, u8, u16, f32 };

struct ColourTypeRow {
  std::string_view name;  ///< in files
  ColourType value;
  std::string_view for_people;
  float full;  ///< white
  int bytes;   ///< that a number takes
};
inline constexpr std::array kColourTypes{ColourTypeRow{"none", ColourType::none, "", 1, 4},
                                         ColourTypeRow{"u8", ColourType::u8, "8-bit", 255, 1},
                                         ColourTypeRow{"u16", ColourType::u16, "16-bit", 65535, 2},
                                         ColourTypeRow{"f32", ColourType::f32, "float", 1, 4}};
static_assert(are_in_order(kColourTypes, &ColourTypeRow::value));

constexpr const ColourTypeRow& row_of(ColourType type) {
  return kColourTypes[static_cast<std::size_t>(type)];
}
/// White as the type has it.
constexpr float full_number(ColourType type) {
  return row_of(type).full;
}

/// The numbers of red, green and blue are in proportion to this; alpha's are always a part.
enum class ColourSpace : std::uint8_t {
  srgb,   ///< the values of a screen (IEC 61966-2-1): PLY, OBJ, OFF, colours of materials
  linear  ///< light: glTF's COLOR_0
};

/// In the order of a vertex's channels.
enum class AttributeKind : std::uint8_t { normals, colours, values, texcoords, material };

/// Says what the numbers of a kind are, and so how those of several vertices become those of one,
/// when two are different, and what may stand in a file.
enum class AttributeRule : std::uint8_t {
  direction,   ///< the mean is made unit length; apart by the angle; finite
  colour,      ///< the mean is that of light; apart by the largest difference; finite
  quantities,  ///< each number for itself, as ValueMixer has it; labels are apart; anything
  coordinates  ///< between those of one chart; apart if not equal; finite
};

/// The channels of one kind in each vertex of a layout.
struct AttributePart {
  AttributeKind kind{};
  std::size_t first = 0, count = 0;

  std::size_t end() const { return first + count; }
  bool has(std::size_t channel) const { return channel - first < count; }
  template <class Float>
  std::span<Float> of(std::span<Float> channels) const {
    return channels.subspan(first, count);
  }
};

inline constexpr std::size_t kAttributeKindCount = 5;
using AttributeParts = std::array<AttributePart, kAttributeKindCount>;

constexpr const AttributePart& part_of(const AttributeParts& parts, AttributeKind kind) {
  return parts[static_cast<std::size_t>(kind)];
}

struct AttributeLayout {
  bool normals = false;
  ColourType colour = ColourType::none;
  bool alpha = false;  ///< colours have a fourth channel
  bool texcoords = false;
  bool material = false;  ///< texture coordinates name a material; only with texcoords
  ColourSpace space = ColourSpace::srgb;  ///< of colours
  /// Colours are what the light of pictures is multiplied by, as glTF has it, and are seen where
  /// there is no picture; else they are seen without pictures alone. Only of textured meshes.
  bool tints = false;
  std::vector<ScalarAttribute> values{};  ///< of at most kMaxValueChannels; no name twice

  bool has_colours() const { return colour != ColourType::none; }
  int colour_channels() const { return !has_colours() ? 0 : alpha ? 4 : 3; }
  int value_channels() const {
    int sum = 0;
    for (const ScalarAttribute& value : values)
      sum += channels_of(value.type);
    return sum;
  }
  int channels() const;
  /// Returns a part for every kind; those that the layout lacks have no channels.
  AttributeParts parts() const;
  AttributePart part(AttributeKind kind) const;
  /// Normals, colours and values, which lie first.
  AttributeLayout without_texcoords() const {
    AttributeLayout layout = *this;
    layout.texcoords = layout.material = false;
    return layout;
  }
  friend bool operator==(const AttributeLayout&, const AttributeLayout&) = default;
};

/// A kind of attributes. One that is there or not, with so many channels, is a member of
/// AttributeLayout and a row.
struct AttributeKindRow {
  AttributeKind kind;
  AttributeRule rule;
  std::string_view name;  ///< in manifests, and of counts there
  std::string_view for_people;
  std::string_view gltf;                  ///< in glTF, or its first set; empty: glTF has no name
  int size = 0;                           ///< channels, if `flag` is set
  bool AttributeLayout::*flag = nullptr;  ///< null: colours and values, which say more

  int channels(const AttributeLayout& layout) const {
    return flag != nullptr                  ? (layout.*flag ? size : 0)
           : kind == AttributeKind::colours ? layout.colour_channels()
                                            : layout.value_channels();
  }
};
inline constexpr std::array<AttributeKindRow, kAttributeKindCount> kAttributeKinds{
    {{AttributeKind::normals, AttributeRule::direction, "normals", "normals", "NORMAL", 3,
      &AttributeLayout::normals},
     {AttributeKind::colours, AttributeRule::colour, "colours", "colours", "COLOR_0"},
     {AttributeKind::values, AttributeRule::quantities, "values", "values", ""},
     {AttributeKind::texcoords, AttributeRule::coordinates, "texcoords", "texture coordinates",
      "TEXCOORD_0", 2, &AttributeLayout::texcoords},
     {AttributeKind::material, AttributeRule::coordinates, "material", "textures", "", 1,
      &AttributeLayout::material}}};
static_assert(are_in_order(kAttributeKinds, &AttributeKindRow::kind));

constexpr const AttributeKindRow& row_of(AttributeKind kind) {
  return kAttributeKinds[static_cast<std::size_t>(kind)];
}

inline int AttributeLayout::channels() const {
  int sum = 0;
  for (const AttributeKindRow& row : kAttributeKinds)
    sum += row.channels(*this);
  return sum;
}

inline AttributePart AttributeLayout::part(AttributeKind kind) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kind); ++i)
    first += static_cast<std::size_t>(kAttributeKinds[i].channels(*this));
  return {kind, first, static_cast<std::size_t>(row_of(kind).channels(*this))};
}

inline AttributeParts AttributeLayout::parts() const {
  AttributeParts parts;
  for (const AttributeKindRow& row : kAttributeKinds)
    parts[static_cast<std::size_t>(row.kind)] = part(row.kind);
  return parts;
}

/// A mesh has at most so many channels of values.
inline constexpr int kMaxValueChannels = 54;
/// The largest channel count of any layout.
inline constexpr int kMaxChannels = [] {
  int sum = 4 + kMaxValueChannels;  // of colours and values
  for (const AttributeKindRow& row : kAttributeKinds)
    sum += row.size;
  return sum;
}();
static_assert(kMaxChannels == 64);

/// For people: "normals, 8-bit colours with alpha"; "none".
std::string attribute_names(const AttributeLayout& layout);

}  // namespace meshhier
