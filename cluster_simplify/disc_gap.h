// How far an edge collapse moves the surface around its edge, where that surface is a plain disc.
//
// Before and after the collapse the same ring of vertices bounds the disc (Cohen, Manocha & Olano,
// Simplifying Polygonal Models Using Successive Mappings, 1997). Seen along the ring's normal, both
// are heights over one polygon, each linear on its triangles; their difference is linear on every
// piece of the overlay and so is largest at a corner of one: at the ends of the edge, at the new
// vertex, or where an old edge crosses a new one.
#pragma once

#include "cluster_simplify/edge_star.h"
#include "hierarchy/four_floats.h"
#include "hierarchy/vec.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::cluster_simplify {

/// What became of a disc.
struct DiscGap {
  std::span<const std::uint32_t> triangles;  ///< of the disc after the collapse
  std::span<const float> deviations;  ///< of each, the most of those that it lies over, and how far
                                      ///< it is from them
  float from = 0, to = 0;             ///< heights of the edge's ends over the new disc
};

/// Measures discs. Keeps its memory from one to the next.
class DiscGapMeter {
 public:
  /// `deviations`: per triangle, before. `star`: a disc as seen from `place`. Nothing if it does
  /// not show its front everywhere along the ring's normal. Certain: rounding is counted.
  /// Deviations that are not above `enough` may be any up to that. The spans are valid until the
  /// next call. O(ring).
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
    Row doubled;                 ///< area of link i's new triangle
    Row deviation;               ///< of link i's old triangle
    float first_deviation = 0, turn_deviation = 0;  ///< of the edge's triangles, at ring vertices 0
                                                    ///< and to_begin
    std::uint32_t next(std::uint32_t i) const { return i + 1 == size ? 0 : i + 1; }
    std::uint32_t previous(std::uint32_t i) const { return (i == 0 ? size : i) - 1; }
  };
  /// An end of the edge.
  struct End {
    float x = 0, y = 0, z = 0;
    int sector = -1;      ///< link whose new triangle it lies over; -1: none
    Row beside;           ///< ring vertex i x end
    float deviation = 0;  ///< the most of the old triangles around it
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
  // Of what each new triangle lies over, so far:
  std::array<std::uint32_t, kMostLinks> triangles_;
  Row deviations_, gaps_;
  float all_deviation_ = 0, all_gap_ = 0;  ///< what counts for every one
};

}  // namespace meshhier::cluster_simplify
