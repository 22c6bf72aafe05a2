// Materials without pictures: their colours become colours of the vertices.
#pragma once

#include "base/srgb.h"
#include "hierarchy/attributes.h"
#include "images/material_list.h"

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <set>

namespace meshhier::importing {

/// A material's colour as an 8-bit vertex colour, sRGB.
struct PlainColour {
  std::array<std::uint8_t, 3> channels{255, 255, 255};

  static PlainColour of(const images::Material& material) {
    const auto& [red, green, blue, alpha] = material.colour;
    return {{screen_byte(red), screen_byte(green), screen_byte(blue)}};
  }

  bool is_grey() const { return channels[0] == channels[1] && channels[1] == channels[2]; }
  /// Returns the colour as attributes have it.
  std::array<float, 3> values() const {
    return {static_cast<float>(channels[0]), static_cast<float>(channels[1]),
            static_cast<float>(channels[2])};
  }
  /// Returns one number for each colour, below 2^24.
  std::uint32_t number() const {
    return std::uint32_t{channels[0]} << 16 | std::uint32_t{channels[1]} << 8 | channels[2];
  }
  static PlainColour from(std::uint32_t number) {
    return {{static_cast<std::uint8_t>(number >> 16), static_cast<std::uint8_t>(number >> 8),
             static_cast<std::uint8_t>(number)}};
  }
  friend auto operator<=>(const PlainColour&, const PlainColour&) = default;
};

/// The colours that the triangles of a file show.
class PlainColours {
 public:
  static constexpr ColourType kType = ColourType::u8;

  void add(PlainColour colour) { colours_.insert(colour); }
  std::size_t count() const { return colours_.size(); }
  /// Returns whether vertices get them: not if all are one shade of grey, as programs write that
  /// where nobody chose a colour.
  bool are_seen() const {
    return colours_.size() > 1 || (colours_.size() == 1 && !colours_.begin()->is_grey());
  }
  /// Returns whether any is not white.
  bool are_coloured() const {
    return colours_.size() > 1 || (colours_.size() == 1 && *colours_.begin() != PlainColour());
  }

 private:
  std::set<PlainColour> colours_;
};

}  // namespace meshhier::importing
