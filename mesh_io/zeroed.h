// Attributes that are not kept as the file has them: normals and texture coordinates that are no
// numbers, integers that no double holds.
#pragma once

#include "hierarchy/attributes.h"

#include <cstdint>
#include <span>

namespace meshhier::mesh_io {

/// Counts of attributes that became 0, or another number.
struct ZeroedCounts {
  std::uint64_t normals = 0;
  std::uint64_t texcoords = 0;
  std::uint64_t rounded = 0;  ///< integers of 64 bits

  ZeroedCounts& operator+=(const ZeroedCounts& other) {
    normals += other.normals;
    texcoords += other.texcoords;
    rounded += other.rounded;
    return *this;
  }
  friend bool operator==(const ZeroedCounts&, const ZeroedCounts&) = default;
};

/// Makes the whole normal 0 if one of its numbers is not finite, and likewise the texture
/// coordinates. Many programs write "nan" as the normal of what has no area. `rows`:
/// layout.channels() floats a vertex. Returns how many became 0.
ZeroedCounts zero_what_is_not_finite(const AttributeLayout& layout, std::span<float> rows);

}  // namespace meshhier::mesh_io
