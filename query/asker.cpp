#include "query/asker.h"

#include "base/closest_point.h"
#include "base/ray.h"
#include "base/widest_corner.h"
#include "compare/surface_distance.h"
#include "compare/surface_rays.h"
#include "compare/surface_sides.h"
#include "compare/tile_trees.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace meshhier::querying {
namespace {

using comparing::CutSurface;
using comparing::ShownTriangle;
using comparing::Side;

Vec3d vector_at(std::span<const double> numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

/// Squares of farther places, and their sums, are no numbers.
constexpr double kFarthest = 1e150;

bool is_place(Vec3d place) {
  return std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) <= kFarthest &&
         is_finite(place);
}

void put_triangle(const CutSurface& surface, const ShownTriangle& triangle, Answer& answer) {
  const NodeId node = surface.cut()[triangle.tile];
  answer.level = raw(node.level);
  answer.index = node.index;
  answer.triangle = triangle.number_in_tile;
  answer.object = triangle.object ? std::int64_t{*triangle.object} : -1;
}

class PointAsker final : public Asker {
 public:
  PointAsker(const CutSurface& surface, const AskerOptions& options)
      : surface_(surface), options_(options), search_(surface, options.cache_bytes) {}

  bool can_ask(std::span<const double> row) const override { return is_place(vector_at(row, 0)); }
  Vec3d start_of(std::span<const double> row, const BoundsD&) const override {
    return vector_at(row, 0) - options_.origin;
  }
  std::uint64_t tiles_read() const override { return search_.tiles_read(); }

  void ask(std::span<const double> rows, std::span<Answer> answers,
           const execution::CancelToken& cancel) override {
    std::vector<Vec3d> points;
    points.reserve(answers.size());
    for (std::size_t i = 0; i < answers.size(); ++i)
      points.push_back(vector_at(rows, 3 * i) - options_.origin);
    const auto take = [&](std::size_t i, const ShownTriangle& triangle) {
      const auto& [a, b, c] = triangle.corners;
      const auto [first, second, third] = widest_first(a, b, c);
      const ClosestPoint closest = closest_point(points[i], TriangleFrame(first, second, third));
      answers[i].place = closest.point + options_.origin;
      put_triangle(surface_, triangle, answers[i]);
    };
    const auto nearest = search_.nearest(points, cancel, comparing::Ties::first, take);
    for (std::size_t i = 0; i < answers.size(); ++i)
      answers[i].distance = std::sqrt(nearest[i].squared);
    if (options_.has_sides)
      put_sides(surface_sides(surface_, search_.trees(), points, nearest, cancel), answers);
  }

 private:
  static void put_sides(std::span<const Side> sides, std::span<Answer> answers) {
    for (std::size_t i = 0; i < answers.size(); ++i) {
      answers[i].side = sides[i] == Side::inside ? -1 : sides[i] == Side::outside ? 1 : 0;
      if (sides[i] == Side::inside)
        answers[i].distance = -answers[i].distance;
    }
  }

  const CutSurface& surface_;
  AskerOptions options_;
  comparing::SurfaceDistance search_;
};

class RayAsker final : public Asker {
 public:
  RayAsker(const CutSurface& surface, const AskerOptions& options)
      : surface_(surface),
        options_(options),
        trees_(surface, options.cache_bytes),
        rays_(surface, trees_) {}

  bool can_ask(std::span<const double> row) const override {
    return is_place(vector_at(row, 0)) && is_finite(vector_at(row, 3)) &&
           vector_at(row, 3) != Vec3d{};
  }
  /// The place where the ray enters the box.
  Vec3d start_of(std::span<const double> row, const BoundsD& box) const override {
    const Ray ray = ray_of(row);
    const Ray::Span span = ray.span(box.min, box.max);
    return span.is_empty() ? ray.origin() : ray.at(std::max(span.entry, 0.0));
  }
  std::uint64_t tiles_read() const override { return trees_.tiles_read(); }

  void ask(std::span<const double> rows, std::span<Answer> answers,
           const execution::CancelToken& cancel) override {
    std::vector<Ray> rays;
    rays.reserve(answers.size());
    for (std::size_t i = 0; i < answers.size(); ++i)
      rays.push_back(ray_of(rows.subspan(6 * i, 6)));
    const auto take = [&](std::size_t i, const ShownTriangle& triangle) {
      answers[i].normal = normal_of(triangle.corners);
      put_triangle(surface_, triangle, answers[i]);
    };
    const auto hits = rays_.first_hits(rays, take, cancel);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      answers[i].distance = std::numeric_limits<double>::infinity();
      if (!hits[i].is_there())
        continue;
      answers[i].distance = hits[i].distance;
      answers[i].place = rays[i].at(hits[i].distance) + options_.origin;
    }
  }

 private:
  /// Directions of any length, however large or small.
  Ray ray_of(std::span<const double> row) const {
    const Vec3d given = vector_at(row, 3);
    const double most = std::max({std::abs(given.x), std::abs(given.y), std::abs(given.z)});
    const Vec3d direction{given.x / most, given.y / most, given.z / most};
    return {vector_at(row, 0) - options_.origin, direction * (1 / length(direction))};
  }
  static Vec3d normal_of(const SurfaceTriangle& triangle) {
    const auto [a, b, c] = widest_first(triangle[0], triangle[1], triangle[2]);
    const Vec3d normal = cross(b - a, c - a);
    return normal * (1 / length(normal));
  }

  const CutSurface& surface_;
  AskerOptions options_;
  comparing::TreeCache trees_;
  comparing::SurfaceRays rays_;
};

}  // namespace

std::unique_ptr<Asker> make_asker(const CutSurface& surface, const AskerOptions& options) {
  if (options.kind == RowKind::points)
    return std::make_unique<PointAsker>(surface, options);
  return std::make_unique<RayAsker>(surface, options);
}

}  // namespace meshhier::querying
