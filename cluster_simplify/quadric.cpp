#include "cluster_simplify/quadric.h"

namespace meshhier::cluster_simplify {

void Quadric::add_triangle(Vec3d p0, Vec3d p1, Vec3d p2) {
  const Vec3d normal2 = cross(p1 - p0, p2 - p0);  // length: twice the area
  const double area2 = length(normal2);
  if (!(area2 > 0))
    return;
  const Vec3d n = normal2 * (1 / area2);
  const double w = area2 / 2;
  const double d = -dot(n, p0);
  xx += w * n.x * n.x;
  xy += w * n.x * n.y;
  xz += w * n.x * n.z;
  yy += w * n.y * n.y;
  yz += w * n.y * n.z;
  zz += w * n.z * n.z;
  b = b + n * (w * d);
  c += w * d * d;
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
