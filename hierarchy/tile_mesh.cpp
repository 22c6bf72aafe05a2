#include "hierarchy/tile_mesh.h"

#include <algorithm>

namespace meshhier {

void VertexArray::reserve(std::size_t count) {
  positions.reserve(count);
  attributes.reserve(count * static_cast<std::size_t>(channels));
}

void VertexArray::append(Vec3f position, std::span<const float> vertex_attributes) {
  positions.push_back(position);
  attributes.insert(attributes.end(), vertex_attributes.begin(), vertex_attributes.end());
}

void VertexArray::append(const VertexArray& other, std::size_t begin, std::size_t end) {
  const auto offset = [&](std::size_t vertex) {
    return other.attributes.begin() + static_cast<std::ptrdiff_t>(vertex * static_cast<std::size_t>(channels));
  };
  positions.insert(positions.end(), other.positions.begin() + static_cast<std::ptrdiff_t>(begin),
                   other.positions.begin() + static_cast<std::ptrdiff_t>(end));
  attributes.insert(attributes.end(), offset(begin), offset(end));
}

void normalize_triangles(std::vector<Triangle>& triangles, bool unique) {
  std::erase_if(triangles, is_degenerate);
  for (Triangle& t : triangles) t = canonical(t);
  std::sort(triangles.begin(), triangles.end());
  if (unique) triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

}  // namespace meshhier
