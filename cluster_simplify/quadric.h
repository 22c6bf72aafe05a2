// Area-weighted plane quadrics (Garland & Heckbert 1997).
#pragma once

#include "base/vec.h"

namespace meshhier::cluster_simplify {

/// The sum of squared distances of a point x to planes, each weighted by an area:
/// E(x) = x'Ax + 2 b'x + c, with x relative to an origin of the caller's choice. Input units to the
/// fourth.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< A
  Vec3d b;
  double c = 0;

  /// Adds the plane through p0, p1, p2 (relative to the origin), weighted with the triangle's area.
  void add_triangle(Vec3d p0, Vec3d p1, Vec3d p2);
  /// Adds a plane through p (relative to the origin).
  void add_plane(Vec3d unit_normal, double weight, Vec3d p);
  double at(Vec3d x) const;

  /// The point of least error, drawn towards `anchor` by `strength` times the mean curvature of E:
  /// where planes leave a direction open, the point stays at the anchor's place in it. Returns the
  /// anchor if there are no planes.
  Vec3d minimum(Vec3d anchor, double strength) const;
};

}  // namespace meshhier::cluster_simplify
