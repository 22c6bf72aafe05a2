// Colours of faces on their way to the vertices of their corners.
#pragma once

#include "hierarchy/attributes.h"
#include "import/split_corners.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace meshhier::importing {

using FaceColour = std::array<float, 4>;

/// Packs the numbers of a colour into parts of a corner, all but CornerParts::kValues: integers of
/// 16 bits, or three floats. colour_of() unpacks them.
inline CornerParts::Parts parts_of(const FaceColour& colour, ColourType type) {
  if (type == ColourType::f32) {
    return {std::bit_cast<std::uint32_t>(colour[0]), std::bit_cast<std::uint32_t>(colour[1]), 0,
            std::bit_cast<std::uint32_t>(colour[2])};
  }
  const auto pair = [&](std::size_t i) {
    return static_cast<std::uint32_t>(colour[i]) << 16 | static_cast<std::uint32_t>(colour[i + 1]);
  };
  return {pair(0), pair(2)};
}

inline FaceColour colour_of(const CornerParts::Parts& parts, ColourType type) {
  if (type == ColourType::f32) {
    return {std::bit_cast<float>(parts[0]), std::bit_cast<float>(parts[1]),
            std::bit_cast<float>(parts[3]), 0};
  }
  const auto number = [](std::uint32_t bits) { return static_cast<float>(bits & 0xffff); };
  return {number(parts[0] >> 16), number(parts[0]), number(parts[1] >> 16), number(parts[1])};
}

/// Returns the colour of faces without one.
inline FaceColour white_face(ColourType type) {
  const float most = full_number(type);
  return {most, most, most, most};
}

}  // namespace meshhier::importing
