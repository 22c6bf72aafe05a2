#include "export/triangle_clipper.h"

#include "base/clip_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace meshhier::exporting {
namespace {

/// Returns the point moved exactly onto the side of a box.
Vec3f on_side(Vec3f p, const HalfSpace& half) {
  const Vec3d& n = half.normal;
  const auto is_axis = [](double a, double b, double c) {
    return std::abs(a) == 1 && b == 0 && c == 0;
  };
  if (is_axis(n.x, n.y, n.z))
    p.x = static_cast<float>(n.x * half.offset);
  else if (is_axis(n.y, n.x, n.z))
    p.y = static_cast<float>(n.y * half.offset);
  else if (is_axis(n.z, n.x, n.y))
    p.z = static_cast<float>(n.z * half.offset);
  return p;
}

}  // namespace

std::vector<ClippedPolygon> TriangleClipper::pieces(ClippedPolygon triangle) const {
  if (region_.box)
    triangle = within_box(std::move(triangle));
  if (triangle.size() < 3)
    return {};
  std::vector<ClippedPolygon> pieces;
  if (!region_.plan) {
    pieces.push_back(std::move(triangle));
    return pieces;
  }
  for (std::size_t i = 1; i + 1 < triangle.size(); ++i)
    add_within_plan({&triangle[0], &triangle[i], &triangle[i + 1]}, pieces);
  return pieces;
}

bool TriangleClipper::touches(const ClippedPolygon& triangle) const {
  const auto corner = [&](std::size_t i) { return to_double(triangle[i].position); };
  if (region_.box &&
      !meshhier::touches(region_.box->half_spaces(), {corner(0), corner(1), corner(2)}))
    return false;
  return !region_.plan || std::ranges::any_of(triangle, [&](const ClippedCorner& c) {
    return region_.contains(to_double(c.position));
  }) || !pieces(triangle).empty();
}

ClippedPolygon TriangleClipper::within_box(ClippedPolygon polygon) const {
  ClippedPolygon next;
  for (const HalfSpace& half : region_.box->half_spaces()) {
    const auto beyond = [&](const ClippedCorner& corner) {
      return half.beyond(to_double(corner.position));
    };
    if (std::ranges::all_of(polygon, [&](const ClippedCorner& c) { return beyond(c) <= 0; }))
      continue;
    clip_at(
        polygon, beyond,
        [&](const ClippedCorner& from, const ClippedCorner& to, double, double) {
          return cut(from, to, half);
        },
        next);
    std::swap(polygon, next);
  }
  return polygon;
}

/// The same from both sides: from the lesser end.
ClippedCorner TriangleClipper::cut(const ClippedCorner& one, const ClippedCorner& other,
                                   const HalfSpace& half) const {
  const bool in_order = key_of(one) < key_of(other);
  const ClippedCorner& from = in_order ? one : other;
  const ClippedCorner& to = in_order ? other : one;
  const double a = half.beyond(to_double(from.position)), b = half.beyond(to_double(to.position));
  ClippedCorner made = mixer_.between(from, to, a / (a - b));
  made.position = on_side(made.position, half);
  return made;
}

void TriangleClipper::add_within_plan(const std::array<const ClippedCorner*, 3>& triangle,
                                      std::vector<ClippedPolygon>& pieces) const {
  const auto place = [&](std::size_t i) { return to_double(triangle[i]->position); };
  const TriangleCut cut = region_.plan->cut({place(0), place(1), place(2)});
  if (cut.is_whole)
    pieces.push_back({*triangle[0], *triangle[1], *triangle[2]});
  std::vector<ClippedCorner> corners;
  for (const ClippedCorner* corner : triangle)
    corners.push_back(*corner);
  for (const TriangleCut::Vertex& vertex : cut.vertices)
    corners.push_back(corner_of(triangle, vertex));
  for (const std::array<std::uint32_t, 3>& t : cut.triangles)
    pieces.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
}

/// Makes the corner of a cut's vertex. On an edge it is the same from both sides.
ClippedCorner TriangleClipper::corner_of(const std::array<const ClippedCorner*, 3>& triangle,
                                         const TriangleCut::Vertex& vertex) const {
  if (vertex.edge < 0) {
    const std::array<double, 2> weights{vertex.to, vertex.rest};
    return mixer_.mixed(*triangle[0], std::span(triangle).subspan(1), weights);
  }
  const auto edge = static_cast<std::size_t>(vertex.edge);
  const ClippedCorner& one = *triangle[edge];
  const ClippedCorner& other = *triangle[(edge + 1) % 3];
  return key_of(one) < key_of(other) ? mixer_.between(one, other, vertex.to)
                                     : mixer_.between(other, one, vertex.rest);
}

}  // namespace meshhier::exporting
