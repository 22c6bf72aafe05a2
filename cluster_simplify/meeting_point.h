// Where two vertices meet: the kernel of quadric edge collapse, for one edge or four at a time.
#pragma once

#include "cluster_simplify/vertex_quadric.h"

namespace meshhier::cluster_simplify {

/// The quadrics of vertices, T at a time.
template <class T>
struct Planes {
  T xx, xy, xz, yy, yz, zz, bx, by, bz, c, area;
};

template <class T>
struct MeetingPoint {
  T x, y, z;  ///< from the edge's middle
  T cost;     ///< >= 0
};

// How strongly a point is drawn to its edge's middle, in parts of the quadric's mean curvature. On
// eight scans the mean distance falls by a twentieth from 1e-3 to 1e-5 and stays there; at 0 points
// on flat ground have nowhere to be.
constexpr float kMiddlePull = 1e-5F;

// A point further from its edge than twice the edge's length comes from planes that hardly meet: a
// spike.
constexpr float kReach = 2;

// A little for the edge's length: on flat ground, where planes cost nothing, short edges go first.
constexpr float kLengthCost = 1e-6F;

/// The point of least summed squared distance to the planes of two vertices, its cost that sum
/// weighted with twice the area. (hx, hy, hz): from the first vertex half the way to the second.
/// The middle where planes say nothing, or lead too far.
template <class T>
MeetingPoint<T> meeting_point(const Planes<T>& p, const Planes<T>& q, T hx, T hy, T hz) {
  const T zero = hx - hx;
  // Both quadrics about the middle.
  const T xx = p.xx + q.xx, xy = p.xy + q.xy, xz = p.xz + q.xz;
  const T yy = p.yy + q.yy, yz = p.yz + q.yz, zz = p.zz + q.zz;
  const T dxx = p.xx - q.xx, dxy = p.xy - q.xy, dxz = p.xz - q.xz;
  const T dyy = p.yy - q.yy, dyz = p.yz - q.yz, dzz = p.zz - q.zz;
  const T bx = p.bx + q.bx + (dxx * hx + dxy * hy + dxz * hz);
  const T by = p.by + q.by + (dxy * hx + dyy * hy + dyz * hz);
  const T bz = p.bz + q.bz + (dxz * hx + dyz * hy + dzz * hz);
  const T middle = p.c + q.c +
                   2.0F * ((p.bx - q.bx) * hx + (p.by - q.by) * hy + (p.bz - q.bz) * hz) +
                   (hx * (xx * hx + xy * hy + xz * hz) + hy * (xy * hx + yy * hy + yz * hz) +
                    hz * (xz * hx + yz * hy + zz * hz));

  // The minimum, by the adjugate of the pulled matrix.
  const T pull = kMiddlePull * (xx + yy + zz);
  const T a = xx + pull, d = yy + pull, f = zz + pull;
  const T m00 = d * f - yz * yz, m01 = xz * yz - xy * f, m02 = xy * yz - xz * d;
  const T m11 = a * f - xz * xz, m12 = xy * xz - a * yz, m22 = a * d - xy * xy;
  const T determinant = a * m00 + xy * m01 + xz * m02;
  const T r = -1.0F / determinant;
  T x = r * (m00 * bx + m01 * by + m02 * bz);
  T y = r * (m01 * bx + m11 * by + m12 * bz);
  T z = r * (m02 * bx + m12 * by + m22 * bz);

  const T squared_edge = 4.0F * (hx * hx + hy * hy + hz * hz);
  const T reach = determinant > zero ? kReach * kReach * squared_edge : zero - 1.0F;
  const T squared = x * x + y * y + z * z;
  x = squared <= reach ? x : zero;
  y = squared <= reach ? y : zero;
  z = squared <= reach ? z : zero;
  const T raw_cost = x * (xx * x + xy * y + xz * z) + y * (xy * x + yy * y + yz * z) +
                     z * (xz * x + yz * y + zz * z) + 2.0F * (bx * x + by * y + bz * z) + middle;
  const T plane_cost = raw_cost > zero ? raw_cost : zero;
  return {x, y, z, plane_cost + kLengthCost * (p.area + q.area) * squared_edge};
}

}  // namespace meshhier::cluster_simplify
