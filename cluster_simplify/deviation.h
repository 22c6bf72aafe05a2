// How far a contraction moves the surface: a certain upper bound, and a mean for the estimate.
//
// A contraction maps the vertices of a fine surface to those of a coarse one; the coarse triangles
// are the images of the fine ones. How far vertices move bounds the distance between the surfaces,
// but counts motion within the surface, twenty times what matters. Here another map is built, from
// the fine surface to nearby points of the coarse one (surface_cover.h), and bounded:
//
// Forward. Every fine triangle is mapped piece by piece, no point farther than the reach. The reach
// starts with the largest distance of a fine vertex to the coarse surface, which no bound can be
// below, and is widened only where a triangle cannot be mapped (split_cover.h).
//
// Backward. Neighbouring triangles agree on their common edge, so the map is continuous, and the
// pieces that land on a coarse triangle cover all of it equally often, signs counted (its degree),
// unless an open edge of what was mapped lands on it. A coarse triangle of degree one lies within
// reach of the fine surface: each of its points is the image of one. The others are certified
// themselves, as fine triangles are.
#pragma once

#include "cluster_simplify/split_cover.h"
#include "cluster_simplify/surface_cover.h"
#include "cluster_simplify/target_surface.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// What of a triangle with own and context corners is certified.
enum class BorderShare {
  whole,     ///< all of it: each tile's bound holds for all it draws and for all it stands for
  own_part,  ///< what is nearer to own corners in barycentric coordinates: tiles share the triangle
};

struct DeviationInput {
  SurfacePatch fine;
  SurfacePatch coarse;
  std::span<const std::uint32_t> coarse_of;  ///< one per fine vertex: a coarse vertex, or kNone
  std::span<const float> weights;            ///< one per own fine vertex, >= 0
  BorderShare border = BorderShare::whole;
};

struct Deviation {
  /// No point of the fine triangles (collapsed ones apart) is farther from the coarse triangles,
  /// and no point of the coarse ones farther from the fine ones. Infinite if a coarse triangle is
  /// not the image of any fine one; 0 if there is nothing to measure.
  double bound = 0;
  /// Over own fine vertices that have coarse triangles around their image: the sum of weight times
  /// squared distance to the nearest of these, and the sum of weights.
  double squared_sum = 0;
  double weight_sum = 0;
  /// Fine triangles with an own corner of which nothing is drawn any more: no coarse triangle is
  /// around the images of their corners. Border triangles count in every tile they touch.
  std::uint64_t collapsed_triangles = 0;
};

/// Measures contractions. Keeps its memory from one to the next; results do not depend on what was
/// measured before. One per thread.
class DeviationMeter {
 public:
  /// Triangles without an own corner are not certified, but others may be near them. Coordinates
  /// are finite. Throws Error(internal) on an index out of range or on spans that do not fit.
  /// Deterministic; about linear time.
  Deviation measure(const DeviationInput& input);

 private:
  /// The fine surface on its way to the coarse one, or the other way round.
  struct Course {
    TargetSurface surface;
    std::vector<Spot> spots;  ///< vertex -> where it lands on the other surface
    std::vector<std::array<Passage, 3>> passages;  ///< triangle, edge
    std::vector<std::uint8_t> mapped;              ///< triangle: mapped as a whole
  };

  void land_fine_vertices(const DeviationInput& input, Deviation& deviation);
  void land(Course& course, const TargetSurface& target, std::uint32_t vertex, bool counts);
  bool land_corners(Course& course, const TargetSurface& target, std::uint32_t triangle);
  std::uint64_t certify_fine();
  std::uint64_t certify_coarse();
  void certify(Course& course, const TargetSurface& target, std::uint32_t triangle);
  void certify_whole(Course& course, const TargetSurface& target, std::uint32_t triangle);
  void certify_part(const Course& course, const TargetSurface& target, std::uint32_t triangle);
  SurfaceCover::Side side_of(Course& course, std::uint32_t triangle, unsigned edge);
  Spot spot_between(const TargetSurface& target, Vec3d point, const Spot& start);
  void widen(const TargetSurface& target, const Spot& a, const Spot& b, const Spot& c);
  void mark_open_edges();
  void mark_below(const Spot& from, const Spot& to);
  bool is_matched(std::uint32_t triangle, unsigned edge) const;
  bool is_covered(std::uint32_t coarse_triangle) const;

  Course fine_, coarse_;
  SurfaceCover cover_;
  SplitCover split_;
  BorderShare border_ = BorderShare::whole;
  std::vector<double> mapped_area_;  ///< coarse triangle -> degree times squared normal
  std::vector<std::uint8_t> open_;   ///< coarse triangle: an open edge of the map may land on it
  double largest_coordinate_ = 0;
  double reach_ = 0;  ///< squared
};

}  // namespace meshhier::cluster_simplify
