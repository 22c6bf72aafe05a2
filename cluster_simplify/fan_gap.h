// How far an edge collapse moves the surface around its edge, where that is a disc of any shape,
// an open border through it or not.
//
// As disc_gap.h, but the new disc, a fan of triangles, is unfolded into the plane instead of looked
// at from one direction: steep and folded places have a fan, too. The edge's ends are laid on the
// nearest points of the fan, an open border on the new border, and the old triangles between them;
// where old edges cross new ones, both discs have a point each. How far these are from each other
// bounds the distance of the discs, whatever the unfolding did to lengths.
#pragma once

#include "cluster_simplify/disc_gap.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::cluster_simplify {

/// Measures what DiscGapMeter gives up. O(ring^2), some microseconds.
class FanGapMeter {
 public:
  /// Likewise; `from` and `to` of the result are distances. Nothing if what is around the edge is
  /// no disc, or the old triangles cannot be laid over the fan without a fold.
  std::optional<DiscGap> measure(std::span<const Vec3f> positions,
                                 std::span<const float> deviations, const StarCollapse& collapse);

 private:
  static constexpr std::uint32_t kMostLinks = EdgeStar::kMostLinks;

  struct Flat {
    double x = 0, y = 0;
  };
  static double turn(Flat a, Flat b) { return a.x * b.y - a.y * b.x; }
  static Flat between(Flat a, Flat b) { return {b.x - a.x, b.y - a.y}; }

  /// One end of the edge and the links opposite to it, a run [begin, end) along the ring.
  struct End {
    std::uint32_t vertex = 0;
    Vec3d place;               ///< relative to the new vertex
    Flat flat;                 ///< where it is laid
    Vec3d image;               ///< the fan's point there
    std::uint32_t sector = 0;  ///< link
    double deviation = 0;      ///< the most of the triangles around it
  };

  enum class Shape : std::uint8_t {
    closed,       ///< first_ has the links [0, turn_), second_ the rest
    border_edge,  ///< likewise; the edge is a border, and the ring open
    border_end,   ///< second_ is on a border: first_ has the links [head_, turn_), second_ the
                  ///< others
  };

  bool order_links(const StarCollapse& c);
  bool find_shape(const StarCollapse& c);
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
  std::array<std::uint32_t, 2> apexes_, edge_triangles_;  ///< of the triangles at the edge: from's
                                                          ///< previous corner first, then next
  std::uint32_t edge_triangle_count_ = 0;
  std::array<Vec3d, kMostLinks + 1> ring_;
  std::array<Flat, kMostLinks + 1> flat_;
  std::array<double, kMostLinks> deviation_, fresh_, gap_;
  std::array<double, 2> edge_deviation_{};
  End first_, second_;
  double radius_ = 0;
  std::array<std::uint32_t, kMostLinks> triangles_;
  std::array<float, kMostLinks> deviations_;
};

}  // namespace meshhier::cluster_simplify
