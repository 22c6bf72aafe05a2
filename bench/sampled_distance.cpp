#include "bench/sampled_distance.h"

#include "bench/noise.h"
#include "hierarchy/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace meshhier::bench {
namespace {

using inspection::SurfaceTriangle;

/// Random sequences of the samples: where in its share, and where in the triangle.
constexpr std::uint64_t kPlaceSeed = 1;
constexpr std::uint64_t kFirstSeed = 2;
constexpr std::uint64_t kSecondSeed = 3;

SurfaceTriangle corners_of(const PlainMesh& mesh, const MeshTriangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

double area_of(const SurfaceTriangle& corners) {
  return inspection::doubled_area(corners) / 2;
}

std::vector<SurfaceTriangle> triangles_of(const PlainMesh& mesh) {
  std::vector<SurfaceTriangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const MeshTriangle& t : mesh.triangles)
    triangles.push_back(corners_of(mesh, t));
  return triangles;
}

/// Uniform over the triangle (Turk, Generating random points in triangles, 1990).
Vec3d point_in(const SurfaceTriangle& corners, std::uint64_t sample) {
  const double s = std::sqrt(uniform_at(kFirstSeed, sample));
  const double t = uniform_at(kSecondSeed, sample);
  return to_double(corners[0]) * (1 - s) + to_double(corners[1]) * (s * (1 - t)) +
         to_double(corners[2]) * (s * t);
}

/// Calls visit(point) for each sample, in the order of the triangles.
template <class Visit>
void for_each_sample(const PlainMesh& mesh, std::uint64_t samples, const Visit& visit) {
  double total = 0;
  for (const MeshTriangle& t : mesh.triangles)
    total += area_of(corners_of(mesh, t));
  if (!(total > 0))
    throw Error(ErrorCode::input, "no triangle of the mesh has an area: nothing to sample");
  const double share = total / static_cast<double>(samples);
  double passed = 0;
  std::uint64_t sample = 0;
  const MeshTriangle* last = nullptr;
  const auto place = [&](std::uint64_t k) {
    return (static_cast<double>(k) + uniform_at(kPlaceSeed, k)) * share;
  };
  for (const MeshTriangle& t : mesh.triangles) {
    const SurfaceTriangle corners = corners_of(mesh, t);
    const double area = area_of(corners);
    passed += area;
    for (; area > 0 && sample < samples && place(sample) < passed; ++sample)
      visit(point_in(corners, sample));
    if (area > 0)
      last = &t;
  }
  for (; sample < samples; ++sample)  // rounded up to the total area
    visit(point_in(corners_of(mesh, *last), sample));
}

}  // namespace

SearchableSurface::SearchableSurface(const PlainMesh& mesh) : search_(triangles_of(mesh)) {
  if (mesh.triangles.empty())
    throw Error(ErrorCode::input, "a mesh without triangles is no surface");
}

Distances SearchableSurface::distances_from(const PlainMesh& from, std::uint64_t samples) const {
  // Samples come in the order of the triangles, neighbours mostly after each other: the triangle
  // nearest to the last one is a good guess for the next.
  std::uint32_t hint = 0;
  double sum = 0;
  double squares = 0;
  double most = 0;
  for_each_sample(from, samples, [&](Vec3d point) {
    const double squared = search_.nearest(point, std::numeric_limits<double>::infinity(), hint);
    sum += std::sqrt(squared);
    squares += squared;
    most = std::max(most, squared);
  });
  const auto count = static_cast<double>(samples);
  return {sum / count, std::sqrt(squares / count), std::sqrt(most)};
}

}  // namespace meshhier::bench
