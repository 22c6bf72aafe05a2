// The quadric of one vertex during edge collapse: compact, in single precision, about the vertex
// itself.
#pragma once

#include "base/vec.h"
#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/collapse_mesh.h"

#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// E(x) = x'Ax + 2 b'x + c with x relative to the vertex it belongs to; area-weighted planes
/// (Garland & Heckbert 1997). Centred at its vertex, where all its planes pass nearby, single
/// precision loses nothing that matters. Padded to three groups of four floats.
struct alignas(16) VertexQuadric {
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
};

/// The sum of all areas.
float total_area(std::span<const VertexQuadric> quadrics);

/// The quadrics of all vertices: the planes of their triangles, each weighted with twice its area,
/// and planes upright on open borders, on sharp folds and on `seams` (ascending). A seam is held at
/// vertices where it is a line: not where more than half of the edges are seams, as if each
/// triangle were a chart. `positions`: one per vertex. O(t), with seams O(t log t).
std::vector<VertexQuadric> vertex_quadrics(const CollapseMesh& mesh,
                                           std::span<const Vec3f> positions,
                                           std::span<const PlaceEdge> seams = {});

}  // namespace meshhier::cluster_simplify
