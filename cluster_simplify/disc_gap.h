// Bounds how far an edge collapse moves the surface around its edge, where that surface is a plain
// disc.
//
// Problem. The edge between `from` and `to` becomes one vertex m, and nearly every collapse of a
// build must be measured: this is its most frequent computation (decision 006).
//
// Idea. Before and after the collapse the same ring of vertices bounds the disc. Seen along the
// ring's normal, both discs are heights over one polygon, if all triangles show their front:
//
//    seen from above: x are corners of the overlay         seen from the side
//
//                 r2                                       height
//              .' /|\ '.                                     ^       from     to
//            .'  / | \  '.                                   |       .-*-------*-.      old
//          .'   /  m  \   '.                                 |     .'  |       |  '.
//        .'  .x'   |   'x.   '.                              |   .'   gap     gap   '.
//     r3 .-' to----x----from '-. r1                          |  r3------m-------------r1  new
//         '.   \   |   /    .'                               +------------------------->
//           '.  \  |  /   .'
//             '. \ | /  .'
//                 r0
//
// Both heights are linear on their triangles, so their difference is linear on every piece of the
// overlay and largest at a corner of one: at the edge's ends, at m, or where an old edge crosses a
// new one. On the ring it is 0. Points one above the other are at most their heights apart, so that
// difference bounds the distance, both ways.
//
// Invariant. Each corner tells the new triangles that have it (overlap()) how high the gap is there
// and the largest deviation of the old triangles that meet there. After all corners each new
// triangle knows the largest of both over all that it covers; the sum is its new deviation.
//
// Cost. O(ring^2) at worst, at most 32 triangles around the edge; 1,900 instructions on scans. So
// four ring vertices at a time are computed in floats, and rounding is added at the end; where the
// whole disc is thinner than `enough`, no crossing is looked for (is_thin()).
//
// Cohen, Manocha & Olano, Simplifying Polygonal Models Using Successive Mappings, 1997. What shows
// its back goes to fan_gap.h.
#pragma once

#include "base/four_floats.h"
#include "base/vec.h"
#include "cluster_simplify/edge_star.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::cluster_simplify {

/// The deviations after a collapse.
struct DiscGap {
  std::span<const std::uint32_t> triangles;  ///< those of the disc after the collapse
  std::span<const float> deviations;         ///< one per triangle: the largest of the old ones that
                                             ///< it lies over, plus its distance from them
  float from = 0, to = 0;                    ///< heights of the edge's ends over the new disc
};

/// Measures discs. One meter serves one thread.
class DiscGapMeter {
 public:
  /// `deviations`: per triangle, before. `star`: a disc as seen from `place`. Nothing if it does
  /// not show its front everywhere along the ring's normal. Certain: rounding is counted.
  /// Deviations that are not above `enough` may be any up to that. The spans are valid until the
  /// next call.
  std::optional<DiscGap> measure(std::span<const Vec3f> positions,
                                 std::span<const float> deviations, const EdgeStar& star,
                                 Vec3f place, float enough);

 private:
  static constexpr std::uint32_t kMostLinks = EdgeStar::kMostLinks;
  using Row = EdgeStar::Row;

  /// The ring's vertices in order, relative to the new vertex: x, y across the normal, z along it.
  struct Ring {
    std::uint32_t size = 0;
    std::uint32_t to_begin = 0;  ///< `from` has the links [0, to_begin), `to` the rest
    Row x, y, z;                 ///< the first once more at the end
    Row doubled;                 ///< twice the area of link i's new triangle
    Row deviation;               ///< of link i's old triangle
    float first_deviation = 0, turn_deviation = 0;  ///< of the edge's triangles, at ring vertices 0
                                                    ///< and to_begin
    std::uint32_t next(std::uint32_t i) const { return i + 1 == size ? 0 : i + 1; }
    std::uint32_t previous(std::uint32_t i) const { return (i == 0 ? size : i) - 1; }
  };
  /// An end of the edge.
  struct End {
    float x = 0, y = 0, z = 0;
    int sector = -1;      ///< link whose new triangle it lies over; -1: it lies over the new vertex
    Row beside;           ///< ring vertex i x end: below 0 if the end is clockwise of the vertex
    float deviation = 0;  ///< the largest of the old triangles around it
  };

  /// An old edge on its way over the new disc.
  struct Way {
    float start = 0, rise = 0;  ///< height of its start, and what is added up to its end
    float turned = 0;           ///< start x end
    float deviation = 0;        ///< of the triangles at it
  };

  bool project(std::span<const Vec3f> positions, const EdgeStar& star, Vec3f place);
  std::array<FourFloats, 2> beside_own_ends(std::uint32_t i) const;
  bool faces_front() const;
  void look_up(std::span<const float> deviations, const EdgeStar& star);
  float lay_over_new(End& end);
  bool lay_middle();
  void lay_edges();
  bool is_thin(float enough);
  void cross_rays(const End& end, std::uint32_t target, float deviation);
  void cross_rays();
  void cross_ray(std::uint32_t ray, const Way& way, float beside, float behind);
  void overlap(std::uint32_t link, float deviation, float gap);
  void overlap_all(float deviation, float gap);
  bool add_up();

  Ring ring_;
  End from_, to_;
  float cross_ = 0;   ///< from_ x to_
  float radius_ = 0;  ///< no coordinate is larger
  std::array<std::uint32_t, kMostLinks> triangles_;
  Row deviations_, gaps_;                  ///< per link, the largest that its new triangle was told
  float all_deviation_ = 0, all_gap_ = 0;  ///< the largest that all of them were told
};

}  // namespace meshhier::cluster_simplify
