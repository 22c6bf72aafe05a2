// Edges with all the triangles around them, of any shape, about to collapse.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/disc_gap.h"
#include "tests/cluster_simplify/sampling.h"

#include <cstdint>
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
  double noise = 0;   ///< of heights; rings are about 2 in radius
  double crease = 0;  ///< height is that times |x + y / 2|
  double bowl = 0;    ///< height is that times the squared distance from the middle
};

/// An edge, from 0 to 1 or back, and what is around it.
struct Star {
  TestMesh mesh;
  std::uint32_t from = 0, to = 1;
  Vec3f place;
  std::vector<float> drifts;  ///< per triangle
};

/// The place is at either end, between them or beside. Of open shapes some have an end without
/// triangles of its own. Drifts are 0 or up to `drift`.
Star make_star(StarShape shape, const StarRelief& relief, double drift, std::uint64_t seed);

/// A star in a CollapseMesh.
class StarMesh {
 public:
  explicit StarMesh(const Star& star);
  cluster_simplify::StarCollapse collapse() const {
    return {star_.from, star_.to, star_.place, around_from_, around_to_};
  }
  std::vector<Corners> before() const { return surface_of(star_.mesh); }
  /// Triangle by triangle; those that are gone have no area and no place.
  std::vector<Corners> after() const;
  bool survives(std::uint32_t triangle) const;

 private:
  const Star& star_;
  cluster_simplify::CollapseMesh mesh_;
  std::vector<cluster_simplify::CollapseMesh::Fan> around_from_, around_to_;
};

/// Holds what was measured against samples: every point of a new triangle is, with the drift of an
/// old one that it lies near, within its own drift; every point of an old triangle is within the
/// drift of some new one, its own counted. Returns the largest sampled distance between the two
/// surfaces.
double expect_covers(const Star& star, const StarMesh& mesh, const cluster_simplify::DiscGap& gap);

}  // namespace meshhier::tests
