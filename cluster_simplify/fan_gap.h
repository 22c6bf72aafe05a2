// Bounds how far an edge collapse moves the surface around its edge, where that is a disc of any
// shape, with or without an open border through it.
//
// Problem. The edge from a to b becomes one vertex m. The old triangles around it and the new ones
// fill the same ring r0, r1, ... Each new triangle needs a number: none of its points is farther
// from the old triangles, and no old point that has come to lie on it is farther from it.
// disc_gap.h finds that number by looking from one side; at creases, spikes and borders there is no
// side from which all triangles show their front.
//
// Idea. Any map of one disc onto the other gives such numbers: how far points are from their
// images. A good map leads through the plane.
//
//      old triangles             new triangles: a fan          both, in the plane
//
//            r2                          r2                            r2
//         .'/  \'.                    .' | '.                      .' / | \ '.
//       .' /    \ '.                .'   m   '.                  .'  /  m  \  '.
//     .'  /      \  '.            .'  .' | '.  '.              .'  .x'  |  'x.  '.
//    r3--b--------a--r1    ->    r3.-'   |   '-.r1            r3.-'b----x----a'-.r1
//     '.  \      /  .'            '.     |     .'              '.   \   |   /   .'
//       '. \    / .'                '.   |   .'                  '.  \  |  /  .'
//         '.\  /.'                    '. | .'                      '. \ | / .'
//            r0                          r0                            r0
//
//                                               x: an old edge crosses a new one
//
//  1. Unfold the fan, which is here all new triangles around m: distances to m stay, the angles at
//     m are scaled to a full turn together (those of an open fan only if they are more than nine
//     tenths of one).
//  2. Lay a and b in the plane where the points of the fan that are nearest to them lie; ends on an
//     open border go onto the new border.
//  3. Draw the old triangles between a, b and the ring as straight ones. If none turns over, they
//     fill the same polygon as the fan: a point of the plane stands for one point of each disc.
//  4. Old and new triangles cut each other into convex pieces. Both maps are linear on a piece, so
//     the distance between the two points is convex there, and largest at a corner. The corners
//     are a, b, m, places where an old edge crosses a ray (a new edge, from m to the ring), and
//     ring vertices, which do not move.
//
// Invariant. Each corner that is visited tells the new triangles around it the deviation of the old
// triangles that meet there, and its own distance (overlap()). Each piece between two triangles has
// a corner that is no ring vertex: a new triangle has only two of these. So in the end a new
// triangle knows the largest deviation of all old triangles that it lies over, and the largest
// distance on it; their sum is its deviation. This holds whatever the unfolding did to lengths: a
// poor map only makes the numbers larger.
//
// Where an open border runs through the disc, the ring is open, and only the map at the border
// differs (Shape):
//
//       border_edge: the edge is border              border_end: one end, b, is on a border
//
//             .' r[turn] '.                               .'''''''.
//           .'   /    \    '.                         r[turn]--a--r[head]
//         .'    /      \     '.                         : '.   |   .' :
//    r[size]---b---m----a----r[0]                       :   '. | .'   :
//                                                     r[size]--b----r[0]
//
//    a lies on the ray to r[0], b on that to          b lies on m, a on the rays between r[head]
//    r[size]; m lies on the old edge                  and r[turn] or between them
//
// Cost. Each old edge may cross each ray: O(ring^2), with at most 32 triangles around the edge;
// some 10,000 instructions. No memory is allocated. On scans 1 to 5 % of all collapses come here
// (decision 006). DeviationMeter decides who measures: it takes no result above half of the
// largest deviation so far.
//
// Successive mappings are by Cohen, Manocha & Olano (1997); theirs look from one side.
#pragma once

#include "cluster_simplify/disc_gap.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::cluster_simplify {

/// Measures the collapses that DiscGapMeter gives up. One meter serves one thread.
class FanGapMeter {
 public:
  /// `deviations`: per triangle, before the collapse. Returns nothing if the triangles around the
  /// edge are no disc, or the old ones cannot be laid over the fan without a fold. In the result
  /// `from` and `to` are the distances of the edge's ends from their images on the fan, and the
  /// spans are valid until the next call. Certain: rounding is counted.
  std::optional<DiscGap> measure(std::span<const Vec3f> positions,
                                 std::span<const float> deviations, const StarCollapse& collapse);

 private:
  static constexpr std::uint32_t kMostLinks = EdgeStar::kMostLinks;

  /// A point of the plane; the new vertex is its origin.
  struct Flat {
    double x = 0, y = 0;
  };
  /// Positive if b lies counter-clockwise of a: twice the area of the triangle (origin, a, b).
  static double turn(Flat a, Flat b) { return a.x * b.y - a.y * b.x; }
  static Flat between(Flat a, Flat b) { return {b.x - a.x, b.y - a.y}; }

  /// One end of the edge and the links opposite to it, a run [begin, end) along the ring.
  struct End {
    std::uint32_t vertex = 0;
    Vec3d place;               ///< relative to the new vertex
    Flat flat;                 ///< where it is laid
    Vec3d image;               ///< the fan's point there
    std::uint32_t sector = 0;  ///< the link whose new triangle holds it
    double deviation = 0;      ///< the largest of the old triangles around it
  };

  enum class Shape : std::uint8_t {
    closed,       ///< first_ has the links [0, turn_), second_ the rest
    border_edge,  ///< likewise; the edge is a border, and the ring open
    border_end,   ///< second_ is on a border: first_ has the links [head_, turn_), second_ the
                  ///< others
  };

  /// An edge opposite to an end of the collapsing one, in a triangle at that end.
  struct Link {
    std::uint32_t start, end, triangle;
    std::uint8_t is_of_to;
  };
  using Links = std::array<Link, kMostLinks>;

  bool collect_links(const StarCollapse& c, Links& found);
  bool order_links(std::span<const Link> found);
  void swap_edge_triangles();
  std::uint32_t run_end(std::uint32_t i) const;
  void name_ends(const StarCollapse& c, bool first_is_to);
  bool find_shape(const StarCollapse& c);
  bool find_closed(const StarCollapse& c);
  bool find_border_edge(const StarCollapse& c);
  bool find_border_end(const StarCollapse& c);
  bool unfold(std::span<const Vec3f> positions, const StarCollapse& c);
  void lay_nearest(End& end, std::uint32_t begin, std::uint32_t until);
  void lay_on_ray(End& end, std::uint32_t ray, std::uint32_t sector);
  bool lay_ends(std::span<const Vec3f> positions, const StarCollapse& c);
  bool lies_flat() const;
  bool run_lies_flat(const End& end, std::uint32_t begin, std::uint32_t until) const;
  void look_up(std::span<const float> deviations);
  bool lay_middle();
  void lay_edges();
  void cross_rays(const End& end, std::uint32_t target, double deviation);
  void cross_between_ends();
  void cross_ray(std::uint32_t ray, const End& end, Flat to, Vec3d to_place, double deviation);
  void overlap(std::uint32_t link, double deviation, double gap);
  void overlap_all(double deviation, double gap);
  double run_deviation(std::uint32_t begin, std::uint32_t until) const;
  std::uint32_t ray_after(std::uint32_t i) const { return is_open() || i + 1 < size_ ? i + 1 : 0; }
  bool is_open() const { return shape_ != Shape::closed; }

  Shape shape_ = Shape::closed;
  std::uint32_t size_ = 0;  ///< links; vertices are one more if open
  std::uint32_t head_ = 0, turn_ = 0;
  std::array<std::uint32_t, kMostLinks + 1> vertices_;
  std::array<std::uint8_t, kMostLinks> is_of_to_;
  /// The third corners and numbers of the triangles at the edge: of two, first the one where
  /// first_'s links begin, then the one where they end.
  std::array<std::uint32_t, 2> apexes_, edge_triangles_;
  std::uint32_t edge_triangle_count_ = 0;
  std::array<Vec3d, kMostLinks + 1> ring_;  ///< relative to the new vertex
  std::array<Flat, kMostLinks + 1> flat_;   ///< the same, unfolded
  /// Per link: deviation of the old triangle; the largest of those that the new one lies over, and
  /// the largest distance on it, as far as is known.
  std::array<double, kMostLinks> deviation_, fresh_, gap_;
  std::array<double, 2> edge_deviation_{};  ///< of edge_triangles_
  End first_, second_;
  double radius_ = 0;
  std::array<std::uint32_t, kMostLinks> triangles_;
  std::array<float, kMostLinks> deviations_;
};

}  // namespace meshhier::cluster_simplify
