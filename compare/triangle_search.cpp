#include "compare/triangle_search.h"

#include "hierarchy/closest_point.h"
#include "hierarchy/widest_corner.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>

namespace meshhier::comparing {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;

Kernel::Point_3 to_point(Vec3f p) {
  return {p.x, p.y, p.z};
}

/// The tree keeps a pointer a triangle, and makes CGAL's triangle of it when it wants its box.
class Primitive {
 public:
  using Id = const SurfaceTriangle*;
  using Point = Kernel::Point_3;
  using Datum = Kernel::Triangle_3;

  explicit Primitive(std::vector<SurfaceTriangle>::const_iterator triangle) : id_(&*triangle) {}
  Id id() const { return id_; }
  Datum datum() const { return {to_point((*id_)[0]), to_point((*id_)[1]), to_point((*id_)[2])}; }
  Point reference_point() const { return to_point((*id_)[0]); }

 private:
  Id id_;
};

/// Boxes of triangles, which CGAL wants at every level of a tree: straight from the corners.
class BoxOfTriangle {
 public:
  using key_type = const SurfaceTriangle*;
  using value_type = CGAL::Bbox_3;
  using reference = value_type;

  friend value_type get(const BoxOfTriangle& /*map*/, key_type triangle) {
    const auto& [a, b, c] = *triangle;
    return {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z}),
            std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
  }
};

using Traits = CGAL::AABB_traits<Kernel, Primitive, BoxOfTriangle>;
using BoxTree = CGAL::AABB_tree<Traits>;

double squared_distance(Vec3d p, const CGAL::Bbox_3& box) {
  const double x = std::max({box.xmin() - p.x, 0.0, p.x - box.xmax()});
  const double y = std::max({box.ymin() - p.y, 0.0, p.y - box.ymax()});
  const double z = std::max({box.zmin() - p.z, 0.0, p.z - box.zmax()});
  return x * x + y * y + z * z;
}

/// Goes down the tree, the nearer child first, keeping the nearest triangle so far. CGAL's own
/// distance query projects on the triangle's plane and so requires an area; this one does not.
class Descent {
 public:
  using Priority = double;  ///< CGAL visits the child with the higher one first

  Descent(double squared, const SurfaceTriangle* best) : squared_(squared), best_(best) {}

  bool go_further() const { return squared_ > 0; }
  void intersection(Vec3d point, const Primitive& primitive) {
    const double squared = comparing::squared_distance(point, *primitive.id());
    if (squared < squared_) {
      squared_ = squared;
      best_ = primitive.id();
    }
  }
  template <class Node>
  bool do_intersect(Vec3d point, const Node& node) const {
    return squared_distance(point, node.bbox()) < squared_;
  }
  template <class Node>
  std::pair<bool, Priority> do_intersect_with_priority(Vec3d point, const Node& node) const {
    const double squared = squared_distance(point, node.bbox());
    return {squared < squared_, -squared};
  }

  double squared() const { return squared_; }
  const SurfaceTriangle* best() const { return best_; }

 private:
  double squared_;
  const SurfaceTriangle* best_;
};

/// Finds the triangles with a corner at a point.
class CornerLookup {
 public:
  explicit CornerLookup(std::vector<const SurfaceTriangle*>& found) : found_(found) {}

  bool go_further() const { return true; }
  void intersection(Vec3f corner, const Primitive& primitive) {
    if (std::ranges::count(*primitive.id(), corner) > 0)
      found_.push_back(primitive.id());
  }
  template <class Node>
  bool do_intersect(Vec3f corner, const Node& node) const {
    return squared_distance(to_double(corner), node.bbox()) == 0;
  }

 private:
  std::vector<const SurfaceTriangle*>& found_;
};

}  // namespace

double squared_distance(Vec3d point, const SurfaceTriangle& triangle) {
  const auto [a, b, c] = widest_first(triangle[0], triangle[1], triangle[2]);
  return squared_distance(point, TriangleFrame(a, b, c));
}

struct TriangleSearch::Tree {
  explicit Tree(std::vector<SurfaceTriangle> list)
      : triangles(std::move(list)), boxes(Traits(BoxOfTriangle())) {
    boxes.insert(triangles.cbegin(), triangles.cend());
    boxes.do_not_accelerate_distance_queries();  // the caller has better hints
    boxes.build();
  }

  std::vector<SurfaceTriangle> triangles;
  BoxTree boxes;
};

TriangleSearch::TriangleSearch(std::vector<SurfaceTriangle> triangles)
    : tree_(std::make_unique<Tree>(std::move(triangles))) {}
TriangleSearch::TriangleSearch(TriangleSearch&&) noexcept = default;
TriangleSearch& TriangleSearch::operator=(TriangleSearch&&) noexcept = default;
TriangleSearch::~TriangleSearch() = default;

std::size_t TriangleSearch::size() const {
  return tree_->triangles.size();
}

std::uint64_t TriangleSearch::memory_bytes() const {
  constexpr std::uint64_t kEach =
      sizeof(SurfaceTriangle) + sizeof(Primitive) + sizeof(CGAL::AABB_node<Traits>);
  return sizeof(Tree) + size() * kEach;
}

double TriangleSearch::nearest(Vec3d point, double limit, std::uint32_t& hint) const {
  const std::vector<SurfaceTriangle>& triangles = tree_->triangles;
  if (triangles.empty())
    return limit;
  Descent descent(limit, nullptr);
  descent.intersection(point, Primitive(triangles.cbegin() + hint));
  tree_->boxes.traversal_with_priority(point, descent);
  if (descent.best() != nullptr)
    hint = static_cast<std::uint32_t>(descent.best() - triangles.data());
  return descent.squared();
}

const SurfaceTriangle& TriangleSearch::operator[](std::uint32_t triangle) const {
  return tree_->triangles[triangle];
}

std::vector<SurfaceTriangle> TriangleSearch::around(Vec3f corner) const {
  std::vector<const SurfaceTriangle*> found;
  CornerLookup lookup(found);
  if (!tree_->triangles.empty())
    tree_->boxes.traversal(corner, lookup);
  std::ranges::sort(found);
  std::vector<SurfaceTriangle> triangles;
  for (const SurfaceTriangle* triangle : found)
    triangles.push_back(*triangle);
  return triangles;
}

}  // namespace meshhier::comparing
