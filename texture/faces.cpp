#include "texture/faces.h"

#include "base/sort_few.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace meshhier::texture {
namespace {

/// An edge at its lower corner.
struct HalfEdge {
  std::uint32_t higher = 0;
  std::uint32_t side = 0;  ///< 3 * triangle + edge
  bool is_upward = false;  ///< the triangle has the lower corner first
};

std::vector<HalfEdge> by_lower_corner(std::span<const TileTriangle> triangles,
                                      std::vector<std::uint32_t>& ends) {
  const auto each = [&](const auto& visit) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k)
        visit(raw(triangles[t][k]), raw(triangles[t][(k + 1) % 3]), 3 * t + k);
    }
  };
  each([&](std::uint32_t a, std::uint32_t b, std::uint32_t) { ++ends[std::min(a, b) + 1]; });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<HalfEdge> edges(3 * triangles.size());
  each([&](std::uint32_t a, std::uint32_t b, std::uint32_t side) {
    edges[ends[std::min(a, b)]++] = {std::max(a, b), side, a < b};
  });
  return edges;
}

void connect(std::span<const TileTriangle> triangles, std::size_t vertex_count, Faces& faces) {
  faces.across.assign(triangles.size(), {kNoFace, kNoFace, kNoFace});
  std::vector<std::uint32_t> ends(vertex_count + 1);
  std::vector<HalfEdge> edges = by_lower_corner(triangles, ends);
  std::uint32_t begin = 0;
  for (std::size_t v = 0; v < vertex_count; begin = ends[v++]) {
    const std::span<HalfEdge> fan = std::span(edges).subspan(begin, ends[v] - begin);
    sort_few(fan, [](const HalfEdge& e) { return std::pair(e.higher, e.side); });
    for (std::size_t i = 0, end = 0; i < fan.size(); i = end) {
      while (end < fan.size() && fan[end].higher == fan[i].higher)
        ++end;
      if (end - i != 2 || fan[i].is_upward == fan[i + 1].is_upward)
        continue;
      faces.across[fan[i].side / 3][fan[i].side % 3] = fan[i + 1].side / 3;
      faces.across[fan[i + 1].side / 3][fan[i + 1].side % 3] = fan[i].side / 3;
    }
  }
}

}  // namespace

Faces faces_of(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles) {
  Faces faces;
  faces.normals.reserve(triangles.size());
  faces.areas.reserve(triangles.size());
  for (const TileTriangle& t : triangles) {
    const Vec3d a = to_double(positions[raw(t[0])]);
    const Vec3d normal =
        cross(to_double(positions[raw(t[1])]) - a, to_double(positions[raw(t[2])]) - a);
    const double size = length(normal);
    faces.normals.push_back(size > 0 ? normal * (1 / size) : Vec3d{});
    faces.areas.push_back(size / 2);
  }
  connect(triangles, positions.size(), faces);
  return faces;
}

}  // namespace meshhier::texture
