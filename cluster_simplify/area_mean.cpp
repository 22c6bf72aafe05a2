#include "cluster_simplify/area_mean.h"

#include "base/widest_corner.h"

#include <algorithm>
#include <cmath>

namespace meshhier::cluster_simplify {
namespace {

// A corner that is no farther than so many times the mean is near: one in 50 of scans is farther.
constexpr double kFar = 3;

// A triangle's typical distance, as a part of its largest one. With a tenth, the steps of five
// scans have a larger mean over vertices, but for one in 40. Where no collapse cares for the
// surface, much of a triangle is away from it.
constexpr double kWithCare = 0.1;
constexpr double kWithout = 0.5;

// A long triangle may have lost its area when the ends of its short edge moved, at a finer level:
// the tip of a spike goes with its whole area, though what is left of that is a needle. So a
// triangle that goes far counts as no narrower than this part of what is usual.
constexpr double kNarrowest = 0.25;

constexpr std::size_t kWidthStride = 32;

/// The root of the mean doubled area of one triangle in 32.
double usual_width(const TileMesh& mesh) {
  double sum = 0;
  double count = 0;
  for (const auto* triangles : {&mesh.interior, &mesh.border}) {
    for (std::size_t i = 0; i < triangles->size(); i += kWidthStride) {
      const auto at = [&](std::size_t k) {
        return mesh.vertices.positions[raw((*triangles)[i][k])];
      };
      sum += doubled_area(at(0), at(1), at(2));
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

double longest_edge(Vec3f a, Vec3f b, Vec3f c) {
  const auto between = [](Vec3f from, Vec3f to) { return length(to_double(to) - to_double(from)); };
  return std::max({between(a, b), between(b, c), between(c, a)});
}

/// `narrowest`: what is narrower counts as if it were not.
void add_moved(AreaMean& mean, const TileMesh& mesh, const TileTriangle& t,
               std::span<const double> moved, double narrowest) {
  const double a = moved[raw(t[0])], b = moved[raw(t[1])], c = moved[raw(t[2])];
  mean.add(std::max(std::max(a, b), c), [&] {
    const auto at = [&](std::size_t k) { return mesh.vertices.positions[raw(t[k])]; };
    const double area =
        std::max(doubled_area(at(0), at(1), at(2)), narrowest * longest_edge(at(0), at(1), at(2)));
    return AreaMean::Patch{area, (a * a + b * b + c * c) / 3};
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
  const double narrowest = kNarrowest * usual_width(joined);
  for (const auto* triangles : {&joined.interior, &joined.border}) {
    for (const TileTriangle& t : *triangles)
      add_moved(mean, joined, t, moved, narrowest);
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
