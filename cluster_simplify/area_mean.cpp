#include "cluster_simplify/area_mean.h"

#include "hierarchy/widest_corner.h"

#include <algorithm>
#include <cmath>

namespace meshhier::cluster_simplify {
namespace {

// A corner that is no farther than so many times the mean is near: one in 50 of scans is farther.
constexpr double kFar = 3;

// What is typical of triangles, as a part of how far they are at most. With a tenth, the steps of
// five scans have a larger mean over vertices, but for one in 40. Where no collapse cares for the
// surface, much of a triangle is away from it.
constexpr double kWithCare = 0.1;
constexpr double kWithout = 0.5;

void add_moved(AreaMean& mean, const TileMesh& mesh, const TileTriangle& t,
               std::span<const double> moved) {
  const double a = moved[raw(t[0])], b = moved[raw(t[1])], c = moved[raw(t[2])];
  mean.add(std::max(std::max(a, b), c), [&] {
    const auto at = [&](TileVertex v) { return mesh.vertices.positions[raw(v)]; };
    return AreaMean::Patch{doubled_area(at(t[0]), at(t[1]), at(t[2])), (a * a + b * b + c * c) / 3};
  });
}

}  // namespace

void AreaMean::add_far(Patch patch) {
  whole_ += patch.doubled_area;
  if (patch.doubled_area > 0)  // nothing times infinity is no number
    sum_ += patch.doubled_area * patch.square;
}

double mean_over_joined(const TileMesh& joined, std::span<const double> moved,
                        std::span<const LostArea> lost, double over_vertices) {
  AreaMean mean(kFar * std::sqrt(over_vertices));
  for (const auto* triangles : {&joined.interior, &joined.border}) {
    for (const TileTriangle& t : *triangles)
      add_moved(mean, joined, t, moved);
  }
  for (const LostArea& area : lost) {  // beside its corners, as if one were so far away
    mean.add(area.farthest, [&] {
      return AreaMean::Patch{area.doubled, area.farthest * area.farthest / 3};
    });
  }
  return mean.value();
}

DrawnMean::DrawnMean(double over_vertices, double careless)
    : mean_(std::sqrt(over_vertices)), typical_(kWithCare + (kWithout - kWithCare) * careless) {}

AreaMean::Patch DrawnMean::patch(const std::array<Vec3f, 3>& corners, double distance) {
  return {doubled_area(corners[0], corners[1], corners[2]), distance * distance};
}

}  // namespace meshhier::cluster_simplify
