#include "cluster_simplify/collapse_costs.h"

#include "base/four_floats.h"
#include "cluster_simplify/vanishing.h"

#include <algorithm>
#include <cstddef>
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

constexpr float kLeastCosine = 0.2F;

/// Whether no triangle around one end turns.
bool keeps_sides(std::span<const Vec3f> positions, std::uint32_t vertex, std::uint32_t other,
                 Vec3f place, Fans fans) {
  const Vec3f old = positions[vertex];
  for (const CollapseMesh::Fan& fan : fans) {
    if (fan.is_at(other))
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

/// The same for links [begin, end) of a disc, four at a time. `old`: their end of the edge as seen
/// from its new place.
bool links_keep_sides(const EdgeStar& star, Vec3f old, std::uint32_t begin, std::uint32_t end) {
  FourInts turned{};
  for (std::uint32_t i = begin; i < end; i += 4) {
    const auto px = load_four(&star.x()[i]);
    const auto py = load_four(&star.y()[i]);
    const auto pz = load_four(&star.z()[i]);
    const FourFloats sx = load_four(&star.x()[i + 1]) - px;
    const FourFloats sy = load_four(&star.y()[i + 1]) - py;
    const FourFloats sz = load_four(&star.z()[i + 1]) - pz;
    const FourFloats ox = old.x - px, oy = old.y - py, oz = old.z - pz;
    const FourFloats bx = sy * oz - sz * oy, by = sz * ox - sx * oz, bz = sx * oy - sy * ox;
    const FourFloats ax = sz * py - sy * pz, ay = sx * pz - sz * px, az = sy * px - sx * py;
    const FourFloats squared_before = bx * bx + by * by + bz * bz;
    const FourFloats squared_after = ax * ax + ay * ay + az * az;
    const FourFloats cosine = bx * ax + by * ay + bz * az;
    const FourInts keeps =
        (cosine > 0.0F) &
        (cosine * cosine >= kLeastCosine * kLeastCosine * squared_before * squared_after);
    turned |= ~keeps & (squared_before > 0.0F) & first_lanes(static_cast<std::int32_t>(end - i));
  }
  return !any_of(turned);
}

}  // namespace

bool keeps_sides(std::span<const Vec3f> positions, const EdgeStar& star, Vec3f place) {
  if (star.is_disc()) {
    const Vec3f from = positions[star.from()] - place;
    const Vec3f to = positions[star.to()] - place;
    return links_keep_sides(star, from, 0, star.to_begin()) &&
           links_keep_sides(star, to, star.to_begin(), star.size());
  }
  return keeps_sides(positions, star.from(), star.to(), place, star.around_from()) &&
         keeps_sides(positions, star.to(), star.from(), place, star.around_to());
}

TopologyPrices::TopologyPrices(const TileMesh& tile, const LocalFrame& frame, float area)
    : tile_(tile),
      frame_(frame),
      least_area_(kLeastShare * area /
                  static_cast<float>(std::max<std::size_t>(1, tile.vertices.size()))) {}

const std::vector<float>& TopologyPrices::vanishing() const {
  if (!vanishing_)
    vanishing_ = vanishing_distances(tile_, frame_.to_local(tile_.vertices.positions));
  return *vanishing_;
}

float TopologyPrices::of(TopologyChange change, std::uint32_t vertex, Vec3f along,
                         float area) const {
  switch (change) {
    case TopologyChange::none:
      return 0;
    case TopologyChange::tears:
      return kTearing * area * dot(along, along);
    case TopologyChange::vanishes: {
      const float lost = vanishing()[vertex];
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
