#include "texture/faces.h"

#include "base/sort_few.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace meshhier::texture {
namespace {

/// An edge of a triangle, at its lower corner: the higher one, then the triangle and the edge.
class HalfEdge {
 public:
  HalfEdge() = default;
  HalfEdge(std::uint32_t higher, std::uint32_t triangle, std::uint32_t edge)
      : bits_(std::uint64_t{higher} << 32 | triangle << 2 | edge) {}

  std::uint64_t bits() const { return bits_; }
  std::uint32_t higher() const { return static_cast<std::uint32_t>(bits_ >> 32); }
  std::uint32_t triangle() const { return static_cast<std::uint32_t>(bits_) >> 2; }
  std::uint32_t edge() const { return static_cast<std::uint32_t>(bits_) & 3; }

 private:
  std::uint64_t bits_ = 0;
};

/// Returns the edges of each vertex that is their lower corner; `ends`: where they end.
std::vector<HalfEdge> by_lower_corner(std::span<const TileTriangle> triangles,
                                      std::vector<std::uint32_t>& ends) {
  constexpr std::array<std::uint32_t, 3> kNext{1, 2, 0};
  for (const TileTriangle& t : triangles) {
    for (std::uint32_t k = 0; k < 3; ++k)
      ++ends[std::min(raw(t[k]), raw(t[kNext[k]])) + 1];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<HalfEdge> edges(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({raw(triangles[t][k]), raw(triangles[t][kNext[k]])});
      edges[ends[low]++] = {high, t, k};
    }
  }
  return edges;
}

void connect(std::span<const TileTriangle> triangles, std::size_t vertex_count, Faces& faces) {
  faces.across.assign(triangles.size(), {kNoFace, kNoFace, kNoFace});
  std::vector<std::uint32_t> ends(vertex_count + 1);
  std::vector<HalfEdge> edges = by_lower_corner(triangles, ends);
  std::uint32_t begin = 0;
  for (std::size_t v = 0; v < vertex_count; begin = ends[v++]) {
    const std::span<HalfEdge> fan = std::span(edges).subspan(begin, ends[v] - begin);
    sort_few(fan, [](const HalfEdge& e) { return e.bits(); });
    const auto is_upward = [&](const HalfEdge& e) {
      return raw(triangles[e.triangle()][e.edge()]) == v;
    };
    for (std::size_t i = 0, end = 0; i < fan.size(); i = end) {
      while (end < fan.size() && fan[end].higher() == fan[i].higher())
        ++end;
      if (end - i != 2 || is_upward(fan[i]) == is_upward(fan[i + 1]))
        continue;
      faces.across[fan[i].triangle()][fan[i].edge()] = fan[i + 1].triangle();
      faces.across[fan[i + 1].triangle()][fan[i + 1].edge()] = fan[i].triangle();
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
