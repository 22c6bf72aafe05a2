#include "cluster_simplify/closest_point.h"

#include <algorithm>
#include <limits>

namespace meshhier::cluster_simplify {
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
  ClosestPoint best{{}, std::numeric_limits<double>::infinity(), Feature::inside};
  const auto offer = [&](double on_b, double on_c, Feature feature) {
    const Vec3d offset = t.ab * on_b + t.ac * on_c;
    const double distance = squared_length(in.ax - offset);
    if (distance < best.squared_distance)
      best = {t.a + offset, distance, feature};
  };
  if (in.inside()) {
    offer(in.v / in.area, in.w / in.area, Feature::inside);
    if (!in.is_thin(t))
      return best;
  }
  const auto on_edge = [](double part, Feature start, Feature edge, Feature end) {
    return part <= 0 ? start : part >= 1 ? end : edge;
  };
  const double on_0 = in.on_0(t);
  const double on_1 = in.on_1(t);
  const double on_2 = in.on_2(t);
  offer(on_0, 0, on_edge(on_0, Feature::corner_0, Feature::edge_0, Feature::corner_1));
  offer(1 - on_1, on_1, on_edge(on_1, Feature::corner_1, Feature::edge_1, Feature::corner_2));
  offer(0, on_2, on_edge(on_2, Feature::corner_0, Feature::edge_2, Feature::corner_2));
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

PlaneFoot plane_foot(Vec3d x, const TriangleFrame& t) {
  const InFrame in(x, t);
  if (!(in.area > 0))
    return {};
  const Vec3d offset = t.ab * (in.v / in.area) + t.ac * (in.w / in.area);
  return {t.a + offset, squared_length(in.ax - offset), in.inside()};
}

Encounter closest_at_ends(const SegmentPair& pair) {
  const auto& [d, e, r, dd, ee, de, dr, er] = pair;
  double s = part(de * er - dr * ee, dd * ee - de * de);
  double t = 0;
  const double on_line = de * s + er;
  if (!(on_line > 0)) {
    s = part(-dr, dd);
  } else if (on_line >= ee) {
    t = 1;
    s = part(de - dr, dd);
  } else {
    t = on_line / ee;
  }
  return {s, t, squared_length(r + d * s - e * t)};
}

}  // namespace meshhier::cluster_simplify
