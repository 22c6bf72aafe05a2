#include "base/closest_point.h"

#include <algorithm>
#include <limits>

namespace meshhier {
namespace {

/// numerator / denominator held in [0, 1]; 0 where there is nothing to divide by.
double part(double numerator, double denominator) {
  if (!(numerator > 0))
    return 0;
  return numerator < denominator ? numerator / denominator : denominator > 0 ? 1.0 : 0.0;
}

/// In a triangle thinner than this (the squared sine at a) the foot is lost in rounding: there the
/// edges are asked too, which are right up to the triangle's width.
constexpr double kThin = 1e-6;

double squared_length(Vec3d v) {
  return dot(v, v);
}

/// The point `x` in the frame of a triangle.
struct InFrame {
  Vec3d ax;
  double xb, xc;
  double v, w, area;  ///< barycentric coordinates of the foot: v / area and w / area

  InFrame(Vec3d x, const TriangleFrame& t)
      : ax(x - t.a),
        xb(dot(ax, t.ab)),
        xc(dot(ax, t.ac)),
        v(t.cc * xb - t.bc * xc),
        w(t.bb * xc - t.bc * xb),
        area(t.bb * t.cc - t.bc * t.bc) {}
  bool inside() const { return v > 0 && w > 0 && v + w < area; }
  bool is_thin(const TriangleFrame& t) const { return !(area > kThin * t.bb * t.cc); }
  double on_0(const TriangleFrame& t) const { return part(xb, t.bb); }
  double on_1(const TriangleFrame& t) const {
    return part(xc - xb - t.bc + t.bb, t.bb - 2 * t.bc + t.cc);
  }
  double on_2(const TriangleFrame& t) const { return part(xc, t.cc); }
};

}  // namespace

ClosestPoint closest_point(Vec3d x, const TriangleFrame& t) {
  const InFrame in(x, t);
  ClosestPoint best{{}, std::numeric_limits<double>::infinity(), 0, 0};
  const auto offer = [&](double on_b, double on_c) {
    const Vec3d offset = t.ab * on_b + t.ac * on_c;
    const double distance = squared_length(in.ax - offset);
    if (distance < best.squared_distance)
      best = {t.a + offset, distance, on_b, on_c};
  };
  if (in.inside()) {
    offer(in.v / in.area, in.w / in.area);
    if (!in.is_thin(t))
      return best;
  }
  const double on_1 = in.on_1(t);
  offer(in.on_0(t), 0);
  offer(1 - on_1, on_1);
  offer(0, in.on_2(t));
  return best;
}

double squared_distance(Vec3d x, const TriangleFrame& t) {
  const InFrame in(x, t);
  const auto to = [&](double on_b, double on_c) {
    return squared_length(in.ax - t.ab * on_b - t.ac * on_c);
  };
  const bool thin = in.is_thin(t);
  double least = std::numeric_limits<double>::infinity();
  if (in.inside()) {
    least = to(in.v / in.area, in.w / in.area);
    if (!thin)
      return least;
  }
  // From outside, the closest point is on an edge that has the foot on its other side.
  if (thin || in.w <= 0)
    least = std::min(least, to(in.on_0(t), 0));
  if (thin || in.v <= 0)
    least = std::min(least, to(0, in.on_2(t)));
  if (thin || in.v + in.w >= in.area) {
    const double on_1 = in.on_1(t);
    least = std::min(least, to(1 - on_1, on_1));
  }
  return least;
}

TrianglePair::Two squared_distances(Vec3d point, const TrianglePair& t) {
  using Two = TrianglePair::Two;
  const Two zero{};
  const Two x = point.x - t.ax, y = point.y - t.ay, z = point.z - t.az;
  const Two xb = x * t.bx + y * t.by + z * t.bz;
  const Two xc = x * t.cx + y * t.cy + z * t.cz;
  // Whatever parts of ab and ac come out, they lead to a point of the triangle.
  const auto to = [&](Two on_b, Two on_c) {
    const Two dx = x - t.bx * on_b - t.cx * on_c;
    const Two dy = y - t.by * on_b - t.cy * on_c;
    const Two dz = z - t.bz * on_b - t.cz * on_c;
    return dx * dx + dy * dy + dz * dz;
  };
  const auto part = [&](Two numerator, Two denominator) {
    const Two quotient = numerator > 0.0 ? numerator / denominator : zero;
    return quotient < 1.0 ? quotient : zero + 1.0;
  };
  const Two v = t.cc * xb - t.bc * xc;
  const Two w = t.bb * xc - t.bc * xb;
  const Two area = t.bb * t.cc - t.bc * t.bc;
  const auto inside = (v > 0.0) & (w > 0.0) & (v + w < area);
  const Two scale = 1.0 / area;
  const Two on_1 = part(xc - xb - t.bc + t.bb, t.bb - 2.0 * t.bc + t.cc);
  const Two at_foot = to(inside ? v * scale : zero, inside ? w * scale : zero);
  const Two at_0 = to(part(xb, t.bb), zero);
  const Two at_1 = to(1.0 - on_1, on_1);
  const Two at_2 = to(zero, part(xc, t.cc));
  const Two least = at_foot < at_0 ? at_foot : at_0;
  const Two other = at_1 < at_2 ? at_1 : at_2;
  return least < other ? least : other;
}

}  // namespace meshhier
