// Polygons as triangles that cover their shape.
//
// Problem. Files have polygons of any shape; a fan (0, i, i + 1) is right for convex ones and
// covers others twice, or covers what lies outside.
//
// Idea. Three ways, from the cheapest on, on the corners seen along the axis where the area is
// largest:
//
//   fan: all its triangles     ears, cut off one after another:     cover (polygon_cover.h):
//   turn as the polygon        corners that turn as the polygon     for more than kMostEars
//                              does, with no other corner in        corners
//        3-----2               their triangle
//        |   / |                    4---3
//        | /   |                    |   2---1     all are ears but 2, which turns the other way,
//        0-----1                    5-------0     and 5, on whose triangle 2 lies
//
// Invariant. The corners that are left and the triangles that were cut off cover the polygon
// together. Meisters ("Polygons have ears", 1975) proves that a simple polygon always has an ear; a
// slit to a hole is not simple, so corners in a place of the ear's own corners do not count, and a
// corner without area is cut off when nothing else can be.
//
// Cost. O(n) for fans, about O(n^2) for ears, O(n log n) for covers.
#pragma once

#include "base/error.h"
#include "base/vec.h"
#include "hierarchy/triangle.h"
#include "mesh_io/polygon_counts.h"
#include "mesh_io/polygon_turns.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// Cuts polygons one after another. Their corners are seen along the axis where their area is
/// largest, so they need not lie in a plane. For one thread.
class PolygonCut {
 public:
  /// Polygons of more corners are cut by cover_polygon(): the time of ears grows with the square.
  static constexpr std::size_t kMostEars = 1024;
  /// A polygon is held in memory as a whole: one of that many corners takes 40 MiB.
  static constexpr std::size_t kMostCorners = std::size_t{1} << 17;

  /// Returns the message for a face of more corners.
  static std::string limit_text();

  enum class Kind : std::uint8_t {
    fan,     ///< (0, i, i + 1) covers it: convex, or near enough; or it has no area
    cut,     ///< triangles() cover it exactly
    crossed  ///< no triangles cover it: it crosses itself, or winds more than once
  };

  /// Finds out how a polygon is cut. Requires 3 corners or more.
  Kind cut(std::span<const Vec3d> corners);
  /// Returns the triangles of the last polygon that was `cut`, by numbers of its corners; they turn
  /// as it does.
  std::span<const Triangle<std::uint32_t>> triangles() const { return triangles_; }

  /// Calls visit(a, b, c) for each triangle of a polygon, by numbers of its corners, and counts
  /// what it is. `place_at(i)` returns where corner i lies; none: that is not known, then the
  /// polygon is a fan. If a place is not finite, all triangles have that corner. Throws
  /// Error(input) beyond kMostCorners.
  template <class PlaceAt, class Visit>
  void for_each_triangle(std::size_t corners, const PlaceAt& place_at, PolygonCounts& counts,
                         const Visit& visit) {
    hub_ = 0;
    const Kind kind = corners > 3 ? kind_of(corners, place_at, counts) : Kind::fan;
    if (kind == Kind::cut) {
      for (const Triangle<std::uint32_t>& t : triangles_)
        visit(t[0], t[1], t[2]);
      return;
    }
    const auto from_hub = [&](std::size_t i) { return (hub_ + i) % corners; };
    for (std::size_t i = 1; i + 1 < corners; ++i)
      visit(hub_, from_hub(i), from_hub(i + 1));
  }

 private:
  template <class PlaceAt>
  Kind kind_of(std::size_t corners, const PlaceAt& place_at, PolygonCounts& counts) {
    if (corners > kMostCorners)
      throw Error(ErrorCode::input, limit_text());
    places_.clear();
    for (std::size_t i = 0; i < corners; ++i) {
      const std::optional<Vec3d> place = place_at(i);
      if (!place) {
        ++counts.unchecked;
        return Kind::fan;
      }
      if (!is_finite(*place)) {
        hub_ = i;
        return Kind::fan;
      }
      places_.push_back(*place);
    }
    const Kind kind = cut(places_);
    counts.concave += kind == Kind::cut ? 1 : 0;
    counts.crossed += kind == Kind::crossed ? 1 : 0;
    return kind;
  }

  int turn(std::size_t a, std::size_t b, std::size_t c) const {
    return sign_ * turn_of(points_[a], points_[b], points_[c]);
  }
  bool project(std::span<const Vec3d> corners);
  bool is_fan() const;
  bool is_ear(std::size_t place) const;
  void look_at(std::size_t place);
  std::size_t find_ear();
  std::size_t find_flat() const;
  void cut_off(std::size_t place);
  bool cut_ears();
  bool cut_many();

  std::vector<Vec3d> places_;
  std::size_t hub_ = 0;  ///< the corner that all triangles of a fan have
  std::vector<Point2> points_;
  int sign_ = 1;                     ///< sign of the polygon's area
  std::vector<std::uint32_t> left_;  ///< corners that are not cut off yet
  std::vector<char> ears_;           ///< per corner: it is known to be an ear
  std::vector<Triangle<std::uint32_t>> triangles_;
};

}  // namespace meshhier::mesh_io
