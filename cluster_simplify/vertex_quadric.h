// The quadric of one vertex during edge collapse: compact, in single precision, about the vertex
// itself.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "hierarchy/vec.h"

#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// E(x) = x'Ax + 2 b'x + c with x relative to the vertex it belongs to; area-weighted planes
/// (Garland & Heckbert 1997). Centred at its vertex, where all its planes pass nearby, single
/// precision loses nothing that matters; three cache lines hold four of them.
struct VertexQuadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< A
  Vec3f b;
  float c = 0;
  float area = 0;  ///< twice that of the surface it was made of, without what holds borders

  /// A plane through the centre.
  void add_plane(Vec3f unit_normal, float weight) {
    const Vec3f n = unit_normal * weight;
    xx += n.x * unit_normal.x;
    xy += n.x * unit_normal.y;
    xz += n.x * unit_normal.z;
    yy += n.y * unit_normal.y;
    yz += n.y * unit_normal.z;
    zz += n.z * unit_normal.z;
  }

  Vec3f times(Vec3f x) const {
    return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z,
            xz * x.x + yz * x.y + zz * x.z};
  }

  float at(Vec3f x) const { return dot(x, times(x)) + 2 * dot(b, x) + c; }

  /// The same function about a centre that lies at `offset` from this one's.
  VertexQuadric about(Vec3f offset) const {
    VertexQuadric moved = *this;
    const Vec3f ax = times(offset);
    moved.c = c + 2 * dot(b, offset) + dot(offset, ax);
    moved.b = b + ax;
    return moved;
  }

  VertexQuadric& operator+=(const VertexQuadric& q) {
    xx += q.xx;
    xy += q.xy;
    xz += q.xz;
    yy += q.yy;
    yz += q.yz;
    zz += q.zz;
    b = b + q.b;
    c += q.c;
    area += q.area;
    return *this;
  }

  /// The point of least E, drawn towards the centre by `strength` times E's mean curvature; the
  /// centre where planes say nothing.
  Vec3f minimum(float strength) const {
    const float s = strength * (xx + yy + zz);
    const float a = xx + s;
    const float d = yy + s;
    const float f = zz + s;
    // Adjugate of the symmetric matrix (a xy xz; xy d yz; xz yz f).
    const float m00 = d * f - yz * yz;
    const float m01 = xz * yz - xy * f;
    const float m02 = xy * yz - xz * d;
    const float determinant = a * m00 + xy * m01 + xz * m02;
    if (!(determinant > 0))
      return {};
    const float m11 = a * f - xz * xz;
    const float m12 = xy * xz - a * yz;
    const float m22 = a * d - xy * xy;
    const float r = -1 / determinant;
    return {r * (m00 * b.x + m01 * b.y + m02 * b.z), r * (m01 * b.x + m11 * b.y + m12 * b.z),
            r * (m02 * b.x + m12 * b.y + m22 * b.z)};
  }
};

/// The sum of all areas.
float total_area(std::span<const VertexQuadric> quadrics);

/// The quadrics of all vertices: the planes of their triangles, each weighted with twice its area,
/// and planes upright on open borders and on sharp folds. `positions`: one per vertex. O(t).
std::vector<VertexQuadric> vertex_quadrics(const CollapseMesh& mesh,
                                           std::span<const Vec3f> positions);

}  // namespace meshhier::cluster_simplify
