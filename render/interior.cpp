#include "render/interior.h"

#include "base/angle.h"
#include "base/bounds.h"
#include "render/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::render {
namespace {

constexpr int kRays = 600, kLeastMet = 60;
/// More of the hull than this looks away: of a sheet half of it does.
constexpr double kMostBacks = 0.6;
/// Within 30 degrees of level; a ball, inside out, has a quarter of its shadow so.
constexpr double kLevel = 0.87, kLeastLevel = 0.5;
constexpr double kSteep = 0.7;
/// Steps of an even sequence in five dimensions: powers of the root of x^6 = x + 1 (Roberts 2018).
constexpr double kStep = 1 / 1.1347241384015194;

struct Ray {
  Vec3d from, direction;
};

/// A triangle: a corner, the two edges at it, and their cross product.
struct Face {
  Vec3d corner, edge, other, normal;
};

/// Directions around `up`, at right angles to it and to each other.
struct Around {
  Vec3d one, other;

  explicit Around(Vec3d up)
      : one(unit(cross(up, std::abs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}))),
        other(cross(up, one)) {}
};

/// The i-th ray from outside of a box through a place in it, downwards or level.
Ray ray_into(const BoundsD& box, Vec3d up, int i) {
  std::array<double, 5> parts{};
  double step = 1;
  for (double& part : parts)
    part = std::fmod(i * (step *= kStep), 1);
  const Vec3d size = box.max - box.min;
  const Vec3d place = box.min + Vec3d{parts[0] * size.x, parts[1] * size.y, parts[2] * size.z};
  const UnitTurn turn = turn_by(2 * std::numbers::pi * parts[4]);
  const double rise = parts[3], level = std::sqrt(1 - rise * rise);
  const Around around(up);
  const Vec3d direction =
      up * -rise + (around.one * turn.cosine + around.other * turn.sine) * level;
  return {place - direction * length(size), direction};
}

/// How far along a ray a face is met; infinite: it is not.
double distance_to(const Face& face, const Ray& ray) {
  constexpr double kMissed = std::numeric_limits<double>::infinity();
  const double turned = -dot(face.normal, ray.direction);
  const Vec3d from = ray.from - face.corner;
  const Vec3d across = cross(from, ray.direction);
  const double u = dot(face.other, across) / turned, v = -dot(face.edge, across) / turned;
  const double distance = dot(face.normal, from) / turned;
  const bool is_met = turned != 0 && u >= 0 && v >= 0 && u + v <= 1 && distance >= 0;
  return is_met ? distance : kMissed;
}

/// The faces that a ray meets first: of all, and of those that look at where it comes from.
struct FirstFaces {
  const Face* any = nullptr;
  const Face* front = nullptr;
};

FirstFaces first_of(std::span<const Face> faces, const Ray& ray) {
  FirstFaces first;
  double nearest = std::numeric_limits<double>::infinity(), nearest_front = nearest;
  for (const Face& face : faces) {
    const double distance = distance_to(face, ray);
    if (distance < nearest) {
      nearest = distance;
      first.any = &face;
    }
    if (distance < nearest_front && dot(face.normal, ray.direction) < 0) {
      nearest_front = distance;
      first.front = &face;
    }
  }
  return first;
}

std::vector<Face> faces_of(const TileMesh& mesh) {
  std::vector<Face> faces;
  for (const TileTriangle& triangle : mesh.interior) {
    const auto at = [&](std::size_t k) {
      return to_double(mesh.vertices.positions[raw(triangle[k])]);
    };
    const Vec3d corner = at(0), edge = at(1) - corner, other = at(2) - corner;
    faces.push_back({corner, edge, other, cross(edge, other)});
  }
  return faces;
}

/// Whether each edge is used as often in one direction as in the other.
bool is_closed(std::span<const TileTriangle> triangles) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::pair<Edge, int>> edges;
  for (const TileTriangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = raw(triangle[k]), to = raw(triangle[(k + 1) % 3]);
      edges.push_back({{std::min(from, to), std::max(from, to)}, from < to ? 1 : -1});
    }
  }
  std::ranges::sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    const Edge edge = edges[i].first;
    for (; i < edges.size() && edges[i].first == edge; ++i)
      balance += edges[i].second;
    if (balance != 0)
      return false;
  }
  return true;
}

}  // namespace

bool is_interior(const TileMesh& mesh, Vec3d up) {
  if (mesh.interior.empty() || is_closed(mesh.interior))
    return false;
  BoundsD box;
  for (const Vec3f& position : mesh.vertices.positions)
    box.add(to_double(position));
  const std::vector<Face> faces = faces_of(mesh);
  int met = 0, backs = 0, fronts = 0, level = 0;
  for (int i = 1; i <= kRays; ++i) {
    const Ray ray = ray_into(box, up, i);
    const FirstFaces first = first_of(faces, ray);
    if (first.any == nullptr)
      continue;
    ++met;
    backs += dot(first.any->normal, ray.direction) > 0 ? 1 : 0;
    if (first.front == nullptr || dot(ray.direction, up) > -kSteep)
      continue;
    ++fronts;
    level += dot(unit(first.front->normal), up) > kLevel ? 1 : 0;
  }
  return met >= kLeastMet && backs > kMostBacks * met && level > kLeastLevel * fronts;
}

}  // namespace meshhier::render
