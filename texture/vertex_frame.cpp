#include "texture/vertex_frame.h"

#include "texture/faces.h"

#include <cmath>
#include <cstddef>

namespace meshhier::texture {
namespace {

/// A vertex without a direction looks along z, as glTF has it.
Vec3d shown_direction(const Vec3f& normal) {
  const Vec3d direction = direction_of(to_double(normal));
  return direction == Vec3d{} ? Vec3d{0, 0, 1} : direction;
}

}  // namespace

TangentCode tangent_of(const ChartPlane& plane, const Vec3f& corner) {
  // A triangle that is seen more from the side has u along the plane.
  constexpr double kLeastSeen = 0.1;
  const Vec3d normal = shown_direction(corner);
  const double seen = dot(normal, plane.normal);
  const Vec3d tangent = seen > kLeastSeen ? plane.x - plane.normal * (dot(normal, plane.x) / seen)
                                          : plane.x - normal * dot(normal, plane.x);
  // A picture's rows go down, and so does its v; the bitangent goes up.
  const bool is_mirrored = dot(cross(plane.x, plane.y), plane.normal) > 0;
  return tangent_code(length(tangent) > 1e-6 ? tangent : plane.y, is_mirrored);
}

VertexFrame frame_of(const Vec3f& normal, const TangentCode& tangent) {
  const Vec3d up = shown_direction(normal);
  const Vec3d along = direction_of({double(tangent[0]), double(tangent[1]), double(tangent[2])});
  const Vec3d across = direction_of(cross(up, along)) * (tangent[3] < 0 ? -1.0 : 1.0);
  return {lanes_of(along), lanes_of(across), lanes_of(up)};
}

VertexFrame interpolated(const VertexFrame& a, const VertexFrame& b, const VertexFrame& c,
                         const CornerWeights& weights) {
  const auto mixed = [&](FourFloats VertexFrame::*axis) {
    return unit_of(a.*axis * weights[0] + b.*axis * weights[1] + c.*axis * weights[2]);
  };
  return {mixed(&VertexFrame::tangent), mixed(&VertexFrame::bitangent),
          mixed(&VertexFrame::normal)};
}

}  // namespace meshhier::texture
