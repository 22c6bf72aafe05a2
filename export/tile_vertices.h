// Vertices of tiles, one at a time.
#pragma once

#include "hierarchy/shading.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/vertex_numbers.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace meshhier::exporting {

/// Returns how many of the tile's copies lie at its own places: they come first.
inline std::size_t own_copy_count(const TileMesh& mesh) {
  return mesh.copies.first_of(mesh.own_count);
}

/// Returns the numbers of vertices as the tile's file has them.
inline VertexNumbers vertex_numbers(const TileMesh& mesh) {
  return {static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places};
}

/// Returns the computed normal of a vertex or split, by its number, if neighbours have it too; else
/// none. In a tile with texture coordinates these decide which normal of a vertex is its first, so
/// neighbours have the same normals at corners of triangles only.
inline std::span<const NormalCode> normal_of(const Shading& shading, std::size_t number) {
  const bool is_common = !shading.normals.empty() && shading.texcoords.empty();
  return is_common ? std::span(shading.normals).subspan(number, 1) : std::span<const NormalCode>();
}

/// Returns the wedges of a triangle; `all` is empty if there are no copies.
inline CornerWedges corner_wedges(const std::vector<CornerWedges>& all, std::size_t triangle) {
  return all.empty() ? CornerWedges{} : all[triangle];
}

/// A vertex in an array of them, which must outlive this.
class VertexAt {
 public:
  VertexAt(const VertexArray& array, std::size_t index) : array_(&array), index_(index) {}

  const Vec3f& position() const { return array_->positions[index_]; }
  std::span<const float> attributes() const { return array_->attributes_of(index_); }

 private:
  const VertexArray* array_;
  std::size_t index_;
};

/// Both compare bits, not values: -0 is not 0 where "bit for bit" is promised.
inline bool has_same_position(const VertexAt& a, const VertexAt& b) {
  return std::memcmp(&a.position(), &b.position(), sizeof(Vec3f)) == 0;
}

inline bool has_same_attributes(const VertexAt& a, const VertexAt& b) {
  const auto x = a.attributes(), y = b.attributes();
  return x.empty() || std::memcmp(x.data(), y.data(), x.size_bytes()) == 0;
}

}  // namespace meshhier::exporting
