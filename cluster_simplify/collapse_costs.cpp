#include "cluster_simplify/collapse_costs.h"

#include "cluster_simplify/vanishing.h"

#include <algorithm>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

// In parts of the area times the squared edge: its ends move by half the edge, and not all of their
// surface with them. Between 0.03 and 0.3 the mean distances hardly change (head, dragon); above,
// specks fill the coarse tiles.
constexpr float kTearing = 0.1F;

// In parts of the area times the squared distance to the next surface. Ten times its plain
// share in the mean: a lost piece shows, and makes the largest distance.
constexpr float kVanishing = 3;

// However small a piece is, it counts for a hundredth of what a vertex stands for on average: a
// stray triangle far away from everything is no area, but makes the largest distance there is.
constexpr float kLeastShare = 0.01F;

}  // namespace

bool keeps_sides(std::span<const Vec3f> positions, std::uint32_t vertex, std::uint32_t other,
                 Vec3f place, Fans fans) {
  constexpr float kLeastCosine = 0.2F;
  const Vec3f old = positions[vertex];
  for (const CollapseMesh::Fan& fan : fans) {
    if (fan.next == other || fan.previous == other)
      continue;
    const Vec3f p = positions[fan.next];
    const Vec3f side = positions[fan.previous] - p;
    const Vec3f before = cross(side, old - p);
    const Vec3f after = cross(side, place - p);
    const float squared_before = dot(before, before);
    const float cosine = dot(before, after);
    const bool keeps = cosine > 0 && cosine * cosine >= kLeastCosine * kLeastCosine *
                                                            squared_before * dot(after, after);
    if (!keeps && squared_before > 0)  // a triangle without area has no side
      return false;
  }
  return true;
}

TopologyPrices::TopologyPrices(const CollapseMesh& mesh, std::span<const Vec3f> positions,
                               float area)
    : least_area_(kLeastShare * area / static_cast<float>(std::max(1U, mesh.vertex_count()))),
      vanishing_(vanishing_distances(mesh, positions)) {}

float TopologyPrices::of(TopologyChange change, std::uint32_t vertex, Vec3f along,
                         float area) const {
  switch (change) {
    case TopologyChange::none:
      return 0;
    case TopologyChange::tears:
      return kTearing * area * dot(along, along);
    case TopologyChange::vanishes: {
      const float lost = vanishing_[vertex];
      if (lost == std::numeric_limits<float>::infinity())
        break;  // whatever its area, which may be zero
      return kTearing * area * dot(along, along) + kVanishing * std::max(area, least_area_) * lost;
    }
    case TopologyChange::pinches:
      break;
  }
  return std::numeric_limits<float>::infinity();
}

}  // namespace meshhier::cluster_simplify
