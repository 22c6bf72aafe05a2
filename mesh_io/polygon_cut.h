// Polygons as triangles that cover their shape.
#pragma once

#include "hierarchy/triangle.h"
#include "hierarchy/vec.h"
#include "mesh_io/polygon_turns.h"

#include <cstddef>
#include <cstdint>
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

 private:
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

  std::vector<Point2> points_;
  int sign_ = 1;                     ///< of the polygon's area
  std::vector<std::uint32_t> left_;  ///< corners that are not cut off yet
  std::vector<char> ears_;           ///< of each corner: whether it is known to be one
  std::vector<Triangle<std::uint32_t>> triangles_;
};

}  // namespace meshhier::mesh_io
