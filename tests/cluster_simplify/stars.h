// Edges with all the triangles around them, of any shape, about to collapse.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/disc_gap.h"
#include "cluster_simplify/edge_star.h"
#include "tests/cluster_simplify/sampling.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::tests {

/// How a star lies in the plane, seen from above.
enum class StarShape {
  closed,       ///< the edge inside of a ring
  border_edge,  ///< the edge on an open border
  border_end,   ///< one of its ends on a border
};

struct StarRelief {
  std::string name;
  double noise = 0;   ///< noise of heights; rings are about 2 in radius
  double crease = 0;  ///< height is that times |x + y / 2|
  double bowl = 0;    ///< height is that times the squared distance from the middle
};

/// An edge, from 0 to 1 or back, and what is around it.
struct Star {
  TestMesh mesh;
  std::uint32_t from = 0, to = 1;
  Vec3f place;
  std::vector<float> deviations;  ///< per triangle
};

/// The place is at either end, between them or beside. Of open shapes some have an end without
/// triangles of its own. Deviations are 0 or up to `deviation`.
Star make_star(StarShape shape, const StarRelief& relief, double deviation, std::uint64_t seed);

struct RoundRing {
  std::uint32_t size = 4;
  std::uint32_t from_links = 1;  ///< how many of its links are opposite vertex 0
};

/// A closed star, its ring a regular polygon of radius 2 and its place near the middle; triangles
/// in any order. Deviations are 0.
Star round_star(RoundRing ring, const StarRelief& relief, std::uint64_t seed);

/// A star in a CollapseMesh.
class StarMesh {
 public:
  explicit StarMesh(const Star& star);
  StarMesh(const StarMesh&) = delete;
  StarMesh& operator=(const StarMesh&) = delete;

  /// As seen from the place if it is a disc.
  const cluster_simplify::EdgeStar& edge_star() const { return edge_star_; }
  cluster_simplify::StarCollapse collapse() const {
    return {star_.from, star_.to, star_.place, edge_star_.around_from(), edge_star_.around_to()};
  }
  std::vector<Corners> before() const { return surface_of(star_.mesh); }
  /// Triangle by triangle; those that are gone have no area and no place.
  std::vector<Corners> after() const;
  bool survives(std::uint32_t triangle) const;

 private:
  const Star& star_;
  cluster_simplify::CollapseMesh mesh_;
  cluster_simplify::EdgeStar edge_star_;
};

/// Holds what was measured against samples: every point of a new triangle is, with the deviation of
/// an old one that it lies near, within its own deviation; every point of an old triangle is within
/// the deviation of some new one, its own counted. Returns the largest sampled distance between the
/// two surfaces.
double expect_covers(const Star& star, const StarMesh& mesh, const cluster_simplify::DiscGap& gap);

float largest_deviation(const cluster_simplify::DiscGap& gap);

using MeasureStar =
    std::function<std::optional<cluster_simplify::DiscGap>(const Star&, const StarMesh&)>;

/// Holds what is measured of the stars of seeds 0, 1, ... below `seeds`, every other one deviated,
/// against samples, up to the first failure. Returns how many were measured: others are refused.
int expect_all_covered(StarShape shape, const StarRelief& relief, std::uint64_t seeds,
                       const MeasureStar& measure);

/// The largest deviation of a star over its largest sampled distance: at most, and on average.
struct Looseness {
  int stars = 0;  ///< that were measured
  double largest = 0;
  double mean = 0;
};

/// Returns the looseness of the stars of seeds 0, 1, ... below `seeds`, none of them deviated.
Looseness looseness_of(StarShape shape, const StarRelief& relief, std::uint64_t seeds,
                       const MeasureStar& measure);

}  // namespace meshhier::tests
