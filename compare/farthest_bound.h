// How far the farthest point of a surface is from another one: from the distances of its vertices,
// by branch and bound (as for the Hausdorff distance: Tang, Lee & Kim 2009; Guthe, Borodin & Klein
// 2005).
//
// Distances change by no more than one goes: a point of a triangle whose longest edge is e is
// within e / sqrt(3) of a corner, so no farther than the farthest corner and that. Triangles that
// may hold the farthest point are split until that says little.
#pragma once

#include "hierarchy/vec.h"

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::comparing {

class FarthestBound {
 public:
  /// Corners and their distances, >= 0. `most`: a bound of the triangle that is known.
  void add(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& distances,
           double most = std::numeric_limits<double>::infinity());
  /// Whether add() would not keep it, for want of a better bound.
  bool is_settled(const std::array<Vec3d, 3>& corners,
                  const std::array<double, 3>& distances) const {
    return candidate(corners, distances).bound <= enough();
  }
  /// Of a point in no triangle.
  void add(double distance) { known_ = distance > known_ ? distance : known_; }

  /// Distances of points, in their order.
  using Measure = std::function<std::vector<double>(const std::vector<Vec3d>&)>;
  /// No point of the triangles is farther; at most a hundredth above what some point is, unless
  /// that takes more than kMostPoints more distances. Deterministic. Passes on what `measure`
  /// throws.
  double refine(const Measure& measure);

 private:
  static constexpr std::size_t kMostPoints = 400'000;
  static constexpr std::size_t kMostCandidates = 8'192;  ///< triangles that are kept
  static constexpr double kEnough = 1.01;                ///< times what is known

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

  double known_ = 0;    ///< of some point
  double settled_ = 0;  ///< bound of all triangles that are candidates no more
  std::vector<Candidate> candidates_;
};

}  // namespace meshhier::comparing
