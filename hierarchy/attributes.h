// Which per-vertex attributes a mesh carries, and how they lie in memory.
//
// Inside meshhier every attribute is a float channel; a vertex has channels() floats, in this
// order:
//
//   normals     nx ny nz      as given (unit length or not)
//   colours     r g b [a]     the stored number: 0..255 for u8, 0..65535 for u16, as given for f32
//   texcoords   u v
//   material    m             its number in the mesh's MaterialList, where the coordinates count
//
// u8, u16 and float values are exact as float, so attributes survive bit for bit.
#pragma once

#include <cstdint>
#include <span>

namespace meshhier {

enum class ColourType : std::uint8_t { none, u8, u16, f32 };

struct AttributeLayout {
  bool normals = false;
  ColourType colour = ColourType::none;
  bool alpha = false;  ///< colours have a fourth channel
  bool texcoords = false;
  bool material = false;  ///< texture coordinates name a material; only with texcoords

  constexpr int colour_channels() const { return colour == ColourType::none ? 0 : alpha ? 4 : 3; }
  constexpr int normal_offset() const { return 0; }
  constexpr int colour_offset() const { return normals ? 3 : 0; }
  constexpr int texcoord_offset() const { return colour_offset() + colour_channels(); }
  constexpr int material_offset() const { return texcoord_offset() + (texcoords ? 2 : 0); }
  constexpr int channels() const { return material_offset() + (material ? 1 : 0); }
  /// Normals and colours, which lie first.
  constexpr AttributeLayout without_texcoords() const { return {normals, colour, alpha}; }
  friend constexpr bool operator==(const AttributeLayout&, const AttributeLayout&) = default;
};

/// The largest channel count of any layout: 3 + 4 + 2 + 1.
inline constexpr int kMaxChannels = 10;

/// Makes an average of attribute vectors an attribute vector again: normals to unit length (a zero
/// normal stays zero); the rest unchanged. `channels`: layout.channels() floats of one vertex.
void normalize_average(const AttributeLayout& layout, std::span<float> channels);

}  // namespace meshhier
