// How far the farthest point of a surface is from another one: from the distances of its vertices,
// by branch and bound (as for the Hausdorff distance: Tang, Lee & Kim 2009; Guthe, Borodin & Klein
// 2005).
//
// Problem. Vertices have exact distances; the farthest point of the surface may lie between them.
//
// Idea. Distances change by no more than one goes: a point of a triangle whose longest edge is e is
// within e / sqrt(3) of a corner, so no farther than the farthest corner and that. A triangle whose
// bound says little above a known distance is settled; others are split at the middles of their
// edges, whose distances are measured:
//
//              c                 known:   the largest distance of a measured point
//             / \                bound:   max(da, db, dc) + e / sqrt(3)
//            /   \               enough:  max(1.01 known, largest bound of settled triangles)
//          ca-----bc             bound <= enough:  settled
//          / \   / \             else:    four triangles with half of e, whose
//         /   \ /   \                     bounds are smaller
//        a-----ab----b
//
// Invariant. No point of all triangles ever added is farther than max(enough, bounds of
// candidates): a triangle that is given up, for want of room or points, leaves its bound in
// `settled`.
//
// Cost. At most kMostPoints distances beside those of vertices; at most five times kMostCandidates
// triangles are held, whatever the surface.
#pragma once

#include "base/vec.h"

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// The bound of one surface. For one thread.
class FarthestBound {
 public:
  /// Adds a triangle: its corners and their distances, >= 0. `most`: a bound of the triangle that
  /// is known.
  void add(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& distances,
           double most = std::numeric_limits<double>::infinity());
  /// Returns whether add() would not keep the triangle even without a better bound.
  bool is_settled(const std::array<Vec3d, 3>& corners,
                  const std::array<double, 3>& distances) const {
    return candidate(corners, distances).bound <= enough();
  }
  /// Adds the distance of a point in no triangle.
  void add(double distance) { known_ = distance > known_ ? distance : known_; }

  /// Returns distances of points, in their order.
  using Measure = std::function<std::vector<double>(const std::vector<Vec3d>&)>;
  /// Returns a distance that no point of the triangles exceeds. It is at most a hundredth above the
  /// distance of some point, unless that takes more than kMostPoints more distances, or more than
  /// kMostCandidates triangles wait at a time. Deterministic. Throws as `measure`.
  double refine(const Measure& measure);

 private:
  static constexpr std::size_t kMostPoints = 400'000;
  static constexpr std::size_t kMostCandidates = 8'192;  ///< triangles that are kept
  static constexpr double kEnough = 1.01;                ///< times the largest known distance

  struct Candidate {
    std::array<Vec3d, 3> corners;
    std::array<double, 3> distances{};
    double bound = 0;
  };

  static Candidate candidate(const std::array<Vec3d, 3>& corners,
                             const std::array<double, 3>& distances,
                             double most = std::numeric_limits<double>::infinity());
  double enough() const;
  void drop_settled();
  void drop_nearest(std::size_t kept);
  std::vector<Vec3d> middles() const;
  void split(std::span<const double> distances);

  double known_ = 0;    ///< the largest distance of a measured point
  double settled_ = 0;  ///< bound of all triangles that are candidates no more
  std::vector<Candidate> candidates_;
};

}  // namespace meshhier::comparing
