#include "texture/nearest_triangle.h"

#include "base/closest_point.h"

#include <algorithm>

namespace meshhier::texture {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr std::size_t kLeafSize = 4;

}  // namespace

NearestTriangle::NearestTriangle(std::span<const SurfaceTriangle> triangles, const Vec3d& centre,
                                 double unit)
    : centre_(centre),
      scale_(1 / unit),
      triangles_(moved(triangles)),
      tree_(triangles_, kLeafSize) {
  leaves_.reserve(tree_.leaf_count());
  for (std::uint32_t leaf = 0; leaf < tree_.leaf_count(); ++leaf)
    leaves_.push_back(leaf_of(tree_.triangles(leaf)));
}

std::vector<SurfaceTriangle> NearestTriangle::moved(
    std::span<const SurfaceTriangle> triangles) const {
  std::vector<SurfaceTriangle> there;
  there.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    there.push_back({moved(to_double(a)), moved(to_double(b)), moved(to_double(c))});
  return there;
}

/// The last triangle fills it up.
NearestTriangle::Leaf NearestTriangle::leaf_of(std::span<const std::uint32_t> triangles) const {
  Leaf leaf;
  for (std::size_t k = 0; k < kLeafSize; ++k) {
    const std::uint32_t t = triangles[std::min(k, triangles.size() - 1)];
    const auto& [a, end_b, end_c] = triangles_[t];
    const Vec3f b = end_b - a, c = end_c - a;
    leaf.ax[k] = a.x, leaf.ay[k] = a.y, leaf.az[k] = a.z;
    leaf.bx[k] = b.x, leaf.by[k] = b.y, leaf.bz[k] = b.z;
    leaf.cx[k] = c.x, leaf.cy[k] = c.y, leaf.cz[k] = c.z;
    leaf.triangles[k] = t;
  }
  return leaf;
}

void NearestTriangle::measure(std::uint32_t number, Asked& q) const {
  const Leaf& t = leaves_[number];
  const Four zero{};
  const Four x = q.at.low_x - t.ax, y = q.at.low_y - t.ay, z = q.at.low_z - t.az;
  const Four bb = t.bx * t.bx + t.by * t.by + t.bz * t.bz;
  const Four bc = t.bx * t.cx + t.by * t.cy + t.bz * t.cz;
  const Four cc = t.cx * t.cx + t.cy * t.cy + t.cz * t.cz;
  const Four xb = x * t.bx + y * t.by + z * t.bz;
  const Four xc = x * t.cx + y * t.cy + z * t.cz;
  const auto to = [&](Four on_b, Four on_c) {
    const Four dx = x - t.bx * on_b - t.cx * on_c;
    const Four dy = y - t.by * on_b - t.cy * on_c;
    const Four dz = z - t.bz * on_b - t.cz * on_c;
    return dx * dx + dy * dy + dz * dz;
  };
  const auto part = [&](Four numerator, Four denominator) {
    const Four quotient = numerator > 0.0f ? numerator / denominator : zero;
    return quotient < 1.0f ? quotient : zero + 1.0f;
  };
  // The nearest point is the foot of the perpendicular, if it is inside, else on one of the edges.
  // All four are measured for all lanes, without a branch; whatever parts of the edges come out,
  // they lead to a point of the triangle.
  const Four v = cc * xb - bc * xc;
  const Four w = bb * xc - bc * xb;
  const Four area = bb * cc - bc * bc;
  const auto inside = (v > 0.0f) & (w > 0.0f) & (v + w < area);
  const Four scale = 1.0f / area;
  const Four on_1 = part(xc - xb - bc + bb, bb - 2.0f * bc + cc);
  const Four at_foot = to(inside ? v * scale : zero, inside ? w * scale : zero);
  const Four at_0 = to(part(xb, bb), zero);
  const Four at_1 = to(1.0f - on_1, on_1);
  const Four at_2 = to(zero, part(xc, cc));
  const Four least = at_foot < at_0 ? at_foot : at_0;
  const Four other = at_1 < at_2 ? at_1 : at_2;
  Four distance = least < other ? least : other;
  if (!q.any) {
    const Four facing = (t.by * t.cz - t.bz * t.cy) * q.facing_x +
                        (t.bz * t.cx - t.bx * t.cz) * q.facing_y +
                        (t.bx * t.cy - t.by * t.cx) * q.facing_z;
    distance = facing > 0.0f ? distance : zero + kNever;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    if (distance[k] < q.nearest || (distance[k] == q.nearest && t.triangles[k] < q.triangle)) {
      q.nearest = distance[k];
      q.triangle = t.triangles[k];
      q.leaf = number;
    }
  }
}

void NearestTriangle::search(Asked& q) const {
  const std::uint32_t measured = q.leaf;
  tree_.look_nearest(q.at, q.nearest, [&](std::uint32_t leaf) {
    if (leaf != measured)
      measure(leaf, q);
  });
}

NearestTriangle::Found NearestTriangle::operator()(const Vec3d& point, const Vec3d& facing,
                                                   double reach) {
  if (triangles_.empty())
    return {};
  const Vec3f at = moved(point), to = to_float(facing);
  const Four zero{};
  Asked query{TriangleTree::Query(at), zero + to.x, zero + to.y, zero + to.z};
  query.nearest = static_cast<float>(reach * scale_ * (reach * scale_));
  // First those that face alike, within reach; only if there is none, any at any distance.
  for (const bool any : {false, true}) {
    query.any = any;
    if (any)
      query.nearest = kNever;
    if (last_leaf_ != kNone) {
      measure(last_leaf_, query);
      query.leaf = last_leaf_;
    }
    search(query);
    if (query.triangle != kNone)
      break;
  }
  if (query.triangle == kNone)
    return {0, 0, 0};  // farther than single precision has numbers for
  last_leaf_ = query.leaf;
  const auto& [a, b, c] = triangles_[query.triangle];
  const ClosestPoint closest =
      closest_point(to_double(at), {to_double(a), to_double(b), to_double(c)});
  return {query.triangle, closest.on_b, closest.on_c};
}

}  // namespace meshhier::texture
