// The triangles within one chunk, and what they lie on, as the splits see them.
#pragma once

#include "base/vec.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// Vertices numbered from 0, in the unit cube so that no length overflows or vanishes as a float,
/// and triangles between them, none with three equal corners.
struct Surface {
  std::vector<Vec3f> positions;
  std::vector<Triangle<std::uint32_t>> triangles;

  std::uint32_t size() const { return static_cast<std::uint32_t>(positions.size()); }
};

/// Vertex v is what triangles call `first` + v; those with other corners are left out. Of a mesh
/// with more than `kMostTriangles` triangles a vertex a choice of so many distinct ones is taken,
/// by their corners alone. O(n + t), t log t for the choice. Holds 12 bytes a vertex and 12 a
/// triangle, as many again for the triangles chosen from.
Surface make_surface(std::span<const Vec3f> positions,
                     std::span<const Triangle<std::uint32_t>> triangles, std::uint32_t first = 0);

/// On a closed surface there are two triangles a vertex; this bounds the memory for any other.
inline constexpr std::size_t kMostTriangles = 3;

/// The parts of a surface, each with the triangles that lie in it and its vertices in their order.
/// `part_of`: per vertex, < count. O(n + t).
std::vector<Surface> separate(const Surface& surface, std::span<const std::uint32_t> part_of,
                              std::uint32_t count);

}  // namespace meshhier::partition
