#include "texture/vertex_frame.h"

#include "texture/faces.h"

#include <cmath>

namespace meshhier::texture {
namespace {

/// A vertex without a direction looks along z, as glTF has it.
Vec3d shown_direction(const Vec3f& normal) {
  const Vec3d direction = direction_of(to_double(normal));
  return direction == Vec3d{} ? Vec3d{0, 0, 1} : direction;
}

}  // namespace

Vec3d VertexFrame::coefficients_of(const Vec3d& direction) const {
  const Vec3d of_tangent = cross(bitangent, normal);
  const double turn = dot(tangent, of_tangent) < 0 ? -1 : 1;
  return Vec3d{dot(direction, of_tangent), dot(direction, cross(normal, tangent)),
               dot(direction, cross(tangent, bitangent))} *
         turn;
}

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
  VertexFrame frame;
  frame.normal = shown_direction(normal);
  frame.tangent = direction_of({double(tangent[0]), double(tangent[1]), double(tangent[2])});
  frame.bitangent =
      direction_of(cross(frame.normal, frame.tangent)) * (tangent[3] < 0 ? -1.0 : 1.0);
  return frame;
}

VertexFrame interpolated(const std::array<VertexFrame, 3>& corners,
                         const std::array<double, 3>& weights) {
  VertexFrame frame;
  for (std::size_t k = 0; k < 3; ++k) {
    frame.normal = frame.normal + corners[k].normal * weights[k];
    frame.tangent = frame.tangent + corners[k].tangent * weights[k];
    frame.bitangent = frame.bitangent + corners[k].bitangent * weights[k];
  }
  return {direction_of(frame.tangent), direction_of(frame.bitangent), direction_of(frame.normal)};
}

}  // namespace meshhier::texture
