// Which per-vertex attributes a mesh carries, and how they lie in memory.
//
// Inside meshhier every attribute is a float channel; a vertex has channels() floats, in this
// order:
//
//   normals     nx ny nz      as given (unit length or not)
//   colours     r g b [a]     the stored number: 0..255 for u8, 0..65535 for u16, as given for f32
//   values      one or two    each, as scalar_value.h says
//   texcoords   u v
//   material    m             its number in the mesh's MaterialList, where the coordinates count
//
// u8, u16 and float values are exact as float, so attributes survive bit for bit.
#pragma once

#include "hierarchy/scalar_value.h"
#include "hierarchy/srgb.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier {

enum class ColourType : std::uint8_t { none, u8, u16, f32 };

/// White as the type has it.
constexpr float full_number(ColourType type) {
  return type == ColourType::u8 ? 255.0F : type == ColourType::u16 ? 65535.0F : 1.0F;
}

/// The numbers of red, green and blue are in proportion to this; alpha's are always a part.
enum class ColourSpace : std::uint8_t {
  srgb,   ///< the values of a screen (IEC 61966-2-1): PLY, OBJ, OFF, colours of materials
  linear  ///< light: glTF's COLOR_0
};

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

  int colour_channels() const { return colour == ColourType::none ? 0 : alpha ? 4 : 3; }
  int value_channels() const {
    int sum = 0;
    for (const ScalarAttribute& value : values)
      sum += channels_of(value.type);
    return sum;
  }
  int normal_offset() const { return 0; }
  int colour_offset() const { return normals ? 3 : 0; }
  int value_offset() const { return colour_offset() + colour_channels(); }
  int texcoord_offset() const { return value_offset() + value_channels(); }
  int material_offset() const { return texcoord_offset() + (texcoords ? 2 : 0); }
  int channels() const { return material_offset() + (material ? 1 : 0); }
  /// Normals, colours and values, which lie first.
  AttributeLayout without_texcoords() const {
    AttributeLayout layout = *this;
    layout.texcoords = layout.material = false;
    return layout;
  }
  friend bool operator==(const AttributeLayout&, const AttributeLayout&) = default;
};

/// A mesh has at most so many channels of values.
inline constexpr int kMaxValueChannels = 54;
/// The largest channel count of any layout: 3 + 4 + kMaxValueChannels + 2 + 1.
inline constexpr int kMaxChannels = 10 + kMaxValueChannels;

/// Colours as their light, 0 to 1, so that means are those of light; what is outside is cut.
class ColourLight {
 public:
  explicit ColourLight(const AttributeLayout& layout);

  /// Whether the numbers in channel `k` of a vertex are not in proportion to its light.
  bool has(std::size_t k) const { return k - first_ < count_; }
  double light(double number) const { return curve_.light(number / full_); }
  /// The inverse, but for rounding.
  double number(double light) const { return full_ * curve_.value(light); }

 private:
  const LightCurve& curve_ = LightCurve::get();
  double full_;
  std::size_t first_, count_;
};

/// Makes an average of attribute vectors an attribute vector again: normals to unit length (a zero
/// normal stays zero); the rest unchanged. `channels`: layout.channels() floats of one vertex.
void normalize_average(const AttributeLayout& layout, std::span<float> channels);

}  // namespace meshhier
