#include "texture/vertex_feet.h"

#include <limits>
#include <numeric>

namespace meshhier::texture {
namespace {

constexpr double kBeyondAll = std::numeric_limits<double>::infinity();

/// The foot of the perpendicular, if it is within the triangle.
struct Perpendicular {
  double on_b = 0, on_c = 0;
  double squared = kBeyondAll;  ///< its length

  Perpendicular(const Vec3d& point, const TriangleFrame& t) {
    const Vec3d to = point - t.a;
    const double b = dot(to, t.ab), c = dot(to, t.ac);
    const double v = t.cc * b - t.bc * c, w = t.bb * c - t.bc * b;
    const double area = t.bb * t.cc - t.bc * t.bc;
    if (!(v >= 0 && w >= 0 && v + w <= area && area > 0))
      return;
    on_b = v / area, on_c = w / area;
    const Vec3d off = to - t.ab * on_b - t.ac * on_c;
    squared = dot(off, off);
  }
};

/// The edge that a point of a triangle is on, from its first corner; 3: it is on none.
std::size_t edge_of(const ClosestPoint& at) {
  if (at.on_c <= 0)
    return 0;
  if (at.on_b <= 0)
    return 2;
  return at.on_b + at.on_c >= 1 ? 1 : 3;
}

}  // namespace

FootFinder::FootFinder(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles,
                       const Faces& faces)
    : faces_(faces), begins_(positions.size() + 1), around_(3 * triangles.size()) {
  frames_.reserve(triangles.size());
  for (const TileTriangle& t : triangles) {
    frames_.emplace_back(to_double(positions[raw(t[0])]), to_double(positions[raw(t[1])]),
                         to_double(positions[raw(t[2])]));
    for (const TileVertex corner : t)
      ++begins_[raw(corner)];
  }
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  for (auto t = static_cast<std::uint32_t>(triangles.size()); t-- > 0;) {
    for (const TileVertex corner : triangles[t])
      around_[--begins_[raw(corner)]] = t;
  }
}

VertexFoot FootFinder::operator()(const Vec3d& point, std::uint32_t vertex) const {
  VertexFoot foot;
  double least = kBeyondAll;
  for (const std::uint32_t t : around(vertex)) {
    const Perpendicular there(point, frames_[t]);
    if (!(there.squared < least))
      continue;
    least = there.squared;
    foot = {t, frames_[t].a + frames_[t].ab * there.on_b + frames_[t].ac * there.on_c};
  }
  if (foot.triangle != kNoFace)
    return foot;
  for (const std::uint32_t t : around(vertex)) {
    const ClosestPoint there = closest_point(point, frames_[t]);
    if (!(there.squared_distance < least))
      continue;
    least = there.squared_distance;
    foot = {t, there.point};
  }
  return foot.triangle == kNoFace ? foot : walked(point, foot.triangle);
}

/// Goes on over edges as long as that comes nearer, so it ends.
VertexFoot FootFinder::walked(const Vec3d& point, std::uint32_t triangle) const {
  ClosestPoint here = closest_point(point, frames_[triangle]);
  for (std::size_t edge = edge_of(here); edge < 3; edge = edge_of(here)) {
    const std::uint32_t next = faces_.across[triangle][edge];
    if (next == kNoFace)
      break;
    const ClosestPoint there = closest_point(point, frames_[next]);
    if (!(there.squared_distance < here.squared_distance))
      break;
    triangle = next;
    here = there;
  }
  return {triangle, here.point};
}

std::vector<VertexFoot> feet_of(const FootFinder& tile, std::span<const Vec3f> positions,
                                std::span<const TileTriangle> triangles,
                                std::span<const std::uint32_t> beside) {
  std::vector<VertexFoot> feet(positions.size());
  if (beside.empty())
    return feet;
  std::vector<std::uint32_t> from(beside.begin(), beside.end());
  for (const TileTriangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& corner = from[raw(t[k])];
      for (std::size_t other = 1; other < 3 && corner == kNoVertex; ++other)
        corner = beside[raw(t[(k + other) % 3])];
    }
  }
  for (std::size_t v = 0; v < feet.size(); ++v) {
    if (from[v] != kNoVertex)
      feet[v] = tile(to_double(positions[v]), from[v]);
  }
  return feet;
}

}  // namespace meshhier::texture
