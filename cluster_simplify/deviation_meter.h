// Measures how far a contraction moves the surface: certain bounds, triangle by triangle, and a
// mean (docs/decisions/006).
//
// Invariant. Each living triangle carries a deviation: none of its points is farther from the
// joined surface, and no point of the joined surface that has come to lie on it is farther from it.
// A collapse replaces the triangles around its edge, so only their deviations change: to the
// largest of those that they lie over, plus the distance between old and new.
//
//      what is around the edge                         who measures      share      instructions
//      a disc that shows its front along one normal    disc_gap.h        95-99 %           1,900
//      any other disc, with or without open border     fan_gap.h          1-5 %           10,000
//      anything: sheets that meet, a handle            cover_distance.h  0.3-3 %    some 100,000
//      more than 128 triangles                         motion of the edge's ends alone
//      nothing is left                                 lost_triangles(), measured at the end
//
// Each falls back on the next one. What is small against the largest deviation so far need not be
// known exactly: only the largest enters the tile's bound.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/cover_distance.h"
#include "cluster_simplify/disc_gap.h"
#include "cluster_simplify/edge_star.h"
#include "cluster_simplify/fan_gap.h"
#include "cluster_simplify/one_side.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Follows edge collapses. The bounds of successive collapses add up where they overlap.
class DeviationMeter {
 public:
  /// `weights`: one per own vertex. Coordinates as the collapses will have them.
  DeviationMeter(const CollapseMesh& mesh, std::span<const float> weights);

  /// Takes note that an edge is about to collapse to `place`; `positions` as they are before,
  /// `star` as seen from there if it is a disc. O(triangles around the edge). Of a mesh that has
  /// each triangle twice, once reversed, one side is measured.
  void note(std::span<const Vec3f> positions, const EdgeStar& star, Vec3f place);

  /// A triangle around which nothing was left: what lay on it lies nowhere.
  struct LostTriangle {
    std::array<Vec3f, 3> corners;
    float deviation = 0;
  };
  std::span<const LostTriangle> lost_triangles() const { return lost_triangles_; }

  /// An end of an edge that was lost with all around it, where it was, and for how many original
  /// vertices it stood: squared_sum() and moved() know nothing of it.
  struct LostVertex {
    std::uint32_t vertex = 0;
    Vec3f position;
    float weight = 0;
  };
  std::span<const LostVertex> lost_vertices() const { return lost_vertices_; }
  /// How many original vertices of the surface an own vertex stands for now: 0 if it had no
  /// triangle from the start, or if its surface was lost.
  float weight(std::uint32_t vertex) const { return weights_[vertex]; }

  float of_triangle(std::uint32_t triangle) const { return deviations_[triangle]; }
  /// Weight times squared distance, summed up over all collapses.
  double squared_sum() const { return squared_sum_; }
  /// The weight of all own vertices that had triangles from the start.
  double weight_sum() const { return weight_sum_; }
  /// The farthest that each own vertex, or what it stood for by then, was from the surface after
  /// one collapse.
  std::span<const float> moved() const { return moved_; }

 private:
  /// A triangle around the edge, its corners as places in points_.
  struct StarTriangle {
    std::array<std::size_t, 3> corners;
    std::uint32_t triangle;
  };

  void note_star(std::span<const Vec3f> positions, const EdgeStar& star, const StarCollapse& c);
  void note_one_side(std::span<const Vec3f> positions, const StarCollapse& whole);
  std::optional<DiscGap> measure(std::span<const Vec3f> positions, const EdgeStar& star,
                                 const StarCollapse& c);
  void note_any(std::span<const Vec3f> positions, const StarCollapse& c);
  void note_high_valence(std::span<const Vec3f> positions, const StarCollapse& c);
  void note_lost(std::span<const Vec3f> positions, const StarCollapse& c);
  void lose(std::span<const Vec3f> positions, std::uint32_t vertex);
  void collect(std::span<const Vec3f> positions, const StarCollapse& c);
  void cover(std::span<const StarTriangle> triangles, bool with_deviation);
  void set_deviation(std::uint32_t triangle, float deviation);
  void add_square(std::uint32_t vertex, float distance);

  DiscGapMeter discs_;
  FanGapMeter fans_;
  std::optional<OneSide> one_side_;  ///< of a mesh with two
  CoverDistance cover_distance_;
  std::vector<float> deviations_;  ///< per triangle
  std::vector<float> weights_;     ///< per own vertex
  std::vector<float> moved_;       ///< likewise
  std::vector<LostTriangle> lost_triangles_;
  std::vector<LostVertex> lost_vertices_;
  // Around one edge:
  std::vector<StarTriangle> before_, after_;
  std::vector<Vec3d> points_;
  std::vector<std::uint32_t> ring_;
  std::vector<Cover> covers_;
  std::vector<double> fresh_;  ///< deviations of after_
  double squared_sum_ = 0;
  double weight_sum_ = 0;
  float largest_ = 0;  ///< deviation of any triangle so far
};

}  // namespace meshhier::cluster_simplify
