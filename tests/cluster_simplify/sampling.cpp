#include "tests/cluster_simplify/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::tests {
namespace {

double distance_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d along = b - a;
  const double squared = dot(along, along);
  const double part = squared > 0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0;
  return length(p - a - along * part);
}

Corners corners_of(const std::vector<Vec3f>& positions, const auto& t, const auto& number) {
  return {to_double(positions[number(t[0])]), to_double(positions[number(t[1])]),
          to_double(positions[number(t[2])])};
}

}  // namespace

double distance_to_triangle(Vec3d p, const Corners& t) {
  double least = std::min({distance_to_segment(p, t[0], t[1]), distance_to_segment(p, t[1], t[2]),
                           distance_to_segment(p, t[2], t[0])});
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
  const double area = length(normal);
  if (!(area > 0))
    return least;
  // Above the triangle if it is on the inner side of all three edges.
  bool above = true;
  for (std::size_t k = 0; k < 3; ++k)
    above = above && dot(cross(t[(k + 1) % 3] - t[k], p - t[k]), normal) >= 0;
  return above ? std::min(least, std::abs(dot(p - t[0], normal)) / area) : least;
}

double distance_to_surface(Vec3d p, std::span<const Corners> surface) {
  double least = std::numeric_limits<double>::infinity();
  for (const Corners& t : surface)
    least = std::min(least, distance_to_triangle(p, t));
  return least;
}

std::vector<Vec3d> samples_of(const Corners& t, int steps) {
  std::vector<Vec3d> samples;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      samples.push_back((t[0] * double(i) + t[1] * double(j) + t[2] * double(steps - i - j)) *
                        (1.0 / steps));
    }
  }
  return samples;
}

double farthest_sample(std::span<const Corners> from, std::span<const Corners> onto, int steps) {
  double farthest = 0;
  for (const Corners& t : from) {
    for (const Vec3d p : samples_of(t, steps))
      farthest = std::max(farthest, distance_to_surface(p, onto));
  }
  return farthest;
}

std::vector<Corners> surface_of(const TestMesh& mesh) {
  std::vector<Corners> surface;
  for (const MeshTriangle& t : mesh.triangles)
    surface.push_back(corners_of(mesh.positions, t, [](std::uint32_t v) { return v; }));
  return surface;
}

std::vector<Corners> surface_of(const TileMesh& mesh) {
  std::vector<Corners> surface;
  for (const auto* triangles : {&mesh.interior, &mesh.border}) {
    for (const TileTriangle& t : *triangles) {
      surface.push_back(
          corners_of(mesh.vertices.positions, t, [](TileVertex v) { return raw(v); }));
    }
  }
  return surface;
}

}  // namespace meshhier::tests
