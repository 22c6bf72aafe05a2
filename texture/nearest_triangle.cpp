#include "texture/nearest_triangle.h"

#include "hierarchy/closest_point.h"

#include <algorithm>

namespace meshhier::texture {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

// Boxes are measured in single precision, too: those that are hardly too far are looked into.
constexpr float kRounding = 1.00001f;

/// Around a box with more leaves than these nothing is collected: the tree is as quick.
constexpr std::size_t kMostAround = 256;

}  // namespace

inline NearestTriangle::Four NearestTriangle::Node::distances(Four from_x, Four from_y, Four from_z,
                                                              Four to_x, Four to_y,
                                                              Four to_z) const {
  const Four zero{};
  const auto apart = [&](Four low, Four high, Four from, Four to) {
    const Four below = low - to, above = from - high;
    const Four outside = below > above ? below : above;
    return outside > 0.0f ? outside : zero;
  };
  const Four x = apart(low_x, high_x, from_x, to_x);
  const Four y = apart(low_y, high_y, from_y, to_y);
  const Four z = apart(low_z, high_z, from_z, to_z);
  return x * x + y * y + z * z;
}

/// Halves by the middles of triangles along the longest axis, twice for each node.
class NearestTriangle::Builder {
 public:
  Builder(NearestTriangle& tree) : tree_(tree) {
    order_.reserve(tree.corners_.size());
    for (const Corners& t : tree.corners_)
      order_.push_back({t[0] + t[1] + t[2], static_cast<std::uint32_t>(order_.size())});
  }

  std::uint32_t operator()() { return order_.empty() ? kNone : build(order_).name; }

 private:
  struct Item {
    Vec3f middle;  ///< three times that
    std::uint32_t triangle;
  };
  struct SpaceBox {
    std::array<float, 3> low{kNever, kNever, kNever}, high{-kNever, -kNever, -kNever};

    void add(const Vec3f& p) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        low[k] = std::min(low[k], p[axis]);
        high[k] = std::max(high[k], p[axis]);
      }
    }
    void add(const SpaceBox& box) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], box.low[k]);
        high[k] = std::max(high[k], box.high[k]);
      }
    }
    int longest_axis() const {
      const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
      return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    }
  };

  struct Child {
    std::uint32_t name = kNone;
    SpaceBox box;
  };

  Child build(std::span<Item> part) {
    if (part.size() <= 4)
      return leaf(part);
    const auto number = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    std::array<Child, 4> children;
    std::size_t count = 0;
    const std::size_t half = halve(part);
    for (const std::span<Item> side : {part.first(half), part.subspan(half)}) {
      if (side.size() <= 4) {
        children[count++] = leaf(side);
        continue;
      }
      const std::size_t quarter = halve(side);
      children[count++] = build(side.first(quarter));
      children[count++] = build(side.subspan(quarter));
    }
    Child result{number, {}};
    Node& node = tree_.nodes_[number];
    for (std::size_t k = 0; k < 4; ++k) {
      const Child& child = children[k];
      node.children[k] = child.name;
      node.low_x[k] = child.box.low[0], node.high_x[k] = child.box.high[0];
      node.low_y[k] = child.box.low[1], node.high_y[k] = child.box.high[1];
      node.low_z[k] = child.box.low[2], node.high_z[k] = child.box.high[2];
      result.box.add(child.box);
    }
    return result;
  }

  /// Sorts the lower half before the upper one, both of full leaves if that is possible.
  std::size_t halve(std::span<Item> part) {
    SpaceBox middles;
    for (const Item& item : part)
      middles.add(item.middle);
    const int axis = middles.longest_axis();
    const std::size_t half = ((part.size() + 3) / 4 + 1) / 2 * 4;
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                     [&](const Item& a, const Item& b) {
                       const float at_a = a.middle[axis], at_b = b.middle[axis];
                       return at_a != at_b ? at_a < at_b : a.triangle < b.triangle;
                     });
    return half;
  }

  Child leaf(std::span<const Item> part) {
    Child result{static_cast<std::uint32_t>(tree_.leaves_.size()) | kIsLeaf, {}};
    Leaf& leaf = tree_.leaves_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t t =
          part[std::min(k, part.size() - 1)].triangle;  // the last one fills it up
      const Corners& corners = tree_.corners_[t];
      const Vec3f& a = corners[0];
      const Vec3f b = corners[1] - a, c = corners[2] - a;
      leaf.ax[k] = a.x, leaf.ay[k] = a.y, leaf.az[k] = a.z;
      leaf.bx[k] = b.x, leaf.by[k] = b.y, leaf.bz[k] = b.z;
      leaf.cx[k] = c.x, leaf.cy[k] = c.y, leaf.cz[k] = c.z;
      leaf.triangles[k] = t;
      for (const Vec3f& corner : corners)
        result.box.add(corner);
    }
    return result;
  }

  NearestTriangle& tree_;
  std::vector<Item> order_;
};

NearestTriangle::NearestTriangle(const std::vector<Corners>& triangles, const Vec3d& centre,
                                 double unit)
    : centre_(centre), scale_(1 / unit) {
  corners_.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    corners_.push_back({moved(to_double(a)), moved(to_double(b)), moved(to_double(c))});
  root_ = Builder(*this)();
}

void NearestTriangle::measure(std::uint32_t number, Query& q) const {
  const Leaf& t = leaves_[number];
  const Four zero{};
  const Four x = q.x - t.ax, y = q.y - t.ay, z = q.z - t.az;
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

void NearestTriangle::search(Query& q) const {
  struct Open {
    float distance;
    std::uint32_t name;
  };
  std::array<Open, 128> open;
  std::size_t count = 0;
  open[count++] = {0, root_};
  const std::uint32_t measured = q.leaf;
  while (count > 0) {
    const Open next = open[--count];
    if (next.distance > q.nearest * kRounding)
      continue;
    if ((next.name & kIsLeaf) != 0) {
      if ((next.name & ~kIsLeaf) != measured)
        measure(next.name & ~kIsLeaf, q);
      continue;
    }
    const Node& node = nodes_[next.name];
    const Four distance = node.distances(q.x, q.y, q.z, q.x, q.y, q.z);
    const std::size_t first = count;
    for (std::size_t k = 0; k < 4; ++k) {
      if (node.children[k] == kNone || distance[k] > q.nearest * kRounding)
        continue;
      std::size_t place = count++;  // the nearest is taken first
      for (; place > first && open[place - 1].distance < distance[k]; --place)
        open[place] = open[place - 1];
      open[place] = {distance[k], node.children[k]};
    }
  }
}

void NearestTriangle::look_around(const BoundsD& box) {
  around_.low = moved(box.min), around_.high = moved(box.max);
  around_.clear();
  // Half as far again as the last answers, and some of the box, whose points are no nearer to them.
  const Vec3f size = around_.high - around_.low;
  around_.reach = 2.25f * farthest_ + dot(size, size) / 64;
  farthest_ = 0;
  if (nodes_.empty())
    return;
  const Four zero{};
  const Vec3f &from = around_.low, &to = around_.high;
  const Four from_x = zero + from.x, from_y = zero + from.y, from_z = zero + from.z;
  const Four to_x = zero + to.x, to_y = zero + to.y, to_z = zero + to.z;
  std::array<std::uint32_t, 128> open;
  std::size_t count = 0;
  open[count++] = root_;
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    const Four distance = node.distances(from_x, from_y, from_z, to_x, to_y, to_z);
    for (std::size_t k = 0; k < 4; ++k) {
      if (node.children[k] == kNone || distance[k] > around_.reach * kRounding)
        continue;
      if ((node.children[k] & kIsLeaf) == 0)
        open[count++] = node.children[k];
      else
        add_around(node, k);
    }
    if (around_.count > kMostAround)
      return around_.clear();
  }
}

/// The child is a leaf.
void NearestTriangle::add_around(const Node& node, std::size_t child) {
  const std::size_t k = around_.count++ % 4;
  if (k == 0) {
    const Four nowhere = Four{} + kNever;
    around_.leaves.push_back({nowhere, nowhere, nowhere, nowhere, nowhere, nowhere, {}});
  }
  Node& four = around_.leaves.back();
  four.low_x[k] = node.low_x[child], four.high_x[k] = node.high_x[child];
  four.low_y[k] = node.low_y[child], four.high_y[k] = node.high_y[child];
  four.low_z[k] = node.low_z[child], four.high_z[k] = node.high_z[child];
  four.children[k] = node.children[child];
}

bool NearestTriangle::is_around(const Vec3f& point) const {
  const Vec3f &low = around_.low, &high = around_.high;
  return around_.count > 0 && point.x >= low.x && point.y >= low.y && point.z >= low.z &&
         point.x <= high.x && point.y <= high.y && point.z <= high.z;
}

void NearestTriangle::measure_around(Query& q) const {
  const std::uint32_t measured = q.leaf;
  for (const Node& four : around_.leaves) {
    const Four distance = four.distances(q.x, q.y, q.z, q.x, q.y, q.z);
    for (std::size_t k = 0; k < 4; ++k) {
      if (distance[k] <= q.nearest * kRounding && (four.children[k] & ~kIsLeaf) != measured)
        measure(four.children[k] & ~kIsLeaf, q);
    }
  }
}

NearestTriangle::Found NearestTriangle::operator()(const Vec3d& point, const Vec3d& facing,
                                                   double reach) {
  if (corners_.empty())
    return {};
  const Vec3f at = moved(point), to = to_float(facing);
  const Four zero{};
  Query query{zero + at.x, zero + at.y, zero + at.z, zero + to.x, zero + to.y, zero + to.z};
  query.nearest = static_cast<float>(reach * scale_ * (reach * scale_));
  const bool has_around = is_around(at);
  // First those that face alike, within reach; only if there is none, any at any distance.
  for (const bool any : {false, true}) {
    query.any = any;
    if (any)
      query.nearest = kNever;
    if (last_leaf_ != kNone) {
      measure(last_leaf_, query);
      query.leaf = last_leaf_;
    }
    if (has_around)
      measure_around(query);
    if (!has_around || query.nearest > around_.reach)  // a nearer one may not have been collected
      search(query);
    if (query.triangle != kNone)
      break;
  }
  if (query.triangle == kNone)
    return {0, 0, 0};  // farther than single precision has numbers for
  last_leaf_ = query.leaf;
  farthest_ = std::max(farthest_, query.nearest);
  const Corners& corners = corners_[query.triangle];
  const ClosestPoint closest = closest_point(
      to_double(at), {to_double(corners[0]), to_double(corners[1]), to_double(corners[2])});
  return {query.triangle, closest.on_b, closest.on_c};
}

}  // namespace meshhier::texture
