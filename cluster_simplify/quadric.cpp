#include "cluster_simplify/quadric.h"

namespace meshhier::cluster_simplify {

void Quadric::add_triangle(Vec3d p0, Vec3d p1, Vec3d p2) {
  const Vec3d normal2 = cross(p1 - p0, p2 - p0);  // length: twice the area
  const double area2 = length(normal2);
  if (!(area2 > 0))
    return;
  add_plane(normal2 * (1 / area2), area2 / 2, p0);
}

void Quadric::add_plane(Vec3d unit_normal, double weight, Vec3d p) {
  const Vec3d n = unit_normal * weight;
  const double d = -dot(unit_normal, p);
  xx += n.x * unit_normal.x;
  xy += n.x * unit_normal.y;
  xz += n.x * unit_normal.z;
  yy += n.y * unit_normal.y;
  yz += n.y * unit_normal.z;
  zz += n.z * unit_normal.z;
  b = b + n * d;
  c += weight * d * d;
}

double Quadric::at(Vec3d x) const {
  const Vec3d ax{xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z,
                 xz * x.x + yz * x.y + zz * x.z};
  return dot(x, ax) + 2 * dot(b, x) + c;
}

Vec3d Quadric::minimum(Vec3d anchor, double strength) const {
  // (A + s I) x = s anchor - b, by Cramer's rule; s > 0 keeps the determinant away from zero.
  const double s = strength * (xx + yy + zz) / 3;
  if (!(s > 0))
    return anchor;
  const Vec3d row0{xx + s, xy, xz};
  const Vec3d row1{xy, yy + s, yz};
  const Vec3d row2{xz, yz, zz + s};
  const Vec3d right = anchor * s - b;
  const Vec3d cross12 = cross(row1, row2);
  const double determinant = dot(row0, cross12);
  if (!(determinant > 0))
    return anchor;
  const Vec3d x = cross12 * right.x + cross(row2, row0) * right.y + cross(row0, row1) * right.z;
  return x * (1 / determinant);
}

}  // namespace meshhier::cluster_simplify
