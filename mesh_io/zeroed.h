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

/// Makes all numbers of an attribute 0 if one of them is not finite. Many programs write "nan" as
/// the normal of what has no area. Returns how many attributes became 0: 1, or none.
std::uint64_t zero_if_not_finite(std::span<float> attribute);

/// Does so to normals and texture coordinates of many vertices. `rows`: all the channels of a
/// vertex, `parts` of which say where the attributes are, behind those of the one before.
ZeroedCounts zero_what_is_not_finite(const AttributeParts& parts, std::span<float> rows);

}  // namespace meshhier::mesh_io
