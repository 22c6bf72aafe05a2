// Polygons as triangles that cover their shape.
#pragma once

#include "hierarchy/triangle.h"
#include "hierarchy/vec.h"
#include "mesh_io/polygon_counts.h"
#include "mesh_io/polygon_turns.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Cuts polygons one after another. Their corners are looked at along that axis along which their
/// area is largest; so they need not lie in a plane.
class PolygonCut {
 public:
  /// One with more corners is a fan, whatever its shape: cutting takes the square of them.
  static constexpr std::size_t kMostCorners = 1024;

  enum class Kind : std::uint8_t {
    fan,     ///< (0, i, i + 1) covers it: convex, or near enough; or it has no area
    ears,    ///< triangles() do (Meisters, "Polygons have ears", 1975), exactly
    crossed  ///< no triangles do: it crosses itself, or winds more than once
  };

  /// Requires 3 to kMostCorners finite corners. O(n) if a fan will do, else O(n^2).
  Kind cut(std::span<const Vec3d> corners);
  /// n - 2 of numbers of corners, as the last polygon of `ears` turns.
  std::span<const Triangle<std::uint32_t>> triangles() const { return triangles_; }

  /// Calls visit(a, b, c) for each triangle of a polygon, by numbers of its corners, and counts
  /// what it is. `place_at(i)`: of corner i; none: not known, then it is a fan.
  template <class PlaceAt, class Visit>
  void for_each_triangle(std::size_t corners, const PlaceAt& place_at, PolygonCounts& counts,
                         const Visit& visit) {
    const Kind kind = corners > 3 ? kind_of(corners, place_at, counts) : Kind::fan;
    if (kind == Kind::ears) {
      for (const Triangle<std::uint32_t>& t : triangles_)
        visit(t[0], t[1], t[2]);
      return;
    }
    for (std::size_t i = 1; i + 1 < corners; ++i)
      visit(0, i, i + 1);
  }

 private:
  template <class PlaceAt>
  Kind kind_of(std::size_t corners, const PlaceAt& place_at, PolygonCounts& counts) {
    places_.clear();
    for (std::size_t i = 0; i < corners && corners <= kMostCorners; ++i) {
      const std::optional<Vec3d> place = place_at(i);
      if (!place)
        break;
      places_.push_back(*place);
    }
    if (places_.size() < corners) {
      ++counts.large;
      return Kind::fan;
    }
    const Kind kind = cut(places_);
    counts.concave += kind == Kind::ears ? 1 : 0;
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

  std::vector<Vec3d> places_;
  std::vector<Point2> points_;
  int sign_ = 1;                     ///< of the polygon's area
  std::vector<std::uint32_t> left_;  ///< corners that are not cut off yet
  std::vector<char> ears_;           ///< of each corner: whether it is known to be one
  std::vector<Triangle<std::uint32_t>> triangles_;
};

}  // namespace meshhier::mesh_io
