#include "compare/surface_sides.h"

#include "base/angle.h"
#include "base/closest_point.h"
#include "base/widest_corner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

namespace meshhier::comparing {
namespace {

/// The feature that a nearest point lies on: a face has no corner, a vertex one, an edge two.
struct Feature {
  std::array<Vec3f, 2> corners{};
  int count = 0;
  Vec3d point;
};

/// The part of a triangle that is nearest to a point. A point of a face that is next to nothing
/// from an edge may be taken for one of the edge: the side is the same.
Feature feature_of(const SurfaceTriangle& triangle, Vec3d point) {
  constexpr double kEdge = 1e-12;
  const auto [a, b, c] = widest_first(triangle[0], triangle[1], triangle[2]);
  const ClosestPoint closest = closest_point(point, TriangleFrame(a, b, c));
  const double on_a = 1 - closest.on_b - closest.on_c;
  const std::array<std::pair<double, Vec3f>, 3> parts{
      {{on_a, to_float(a)}, {closest.on_b, to_float(b)}, {closest.on_c, to_float(c)}}};
  Feature feature{.point = closest.point};
  std::array<Vec3f, 3> corners{};
  for (const auto& [part, corner] : parts) {
    if (part > kEdge)
      corners[static_cast<std::size_t>(feature.count++)] = corner;
  }
  if (feature.count == 3 && doubled_area(triangle) > 0)
    return {.point = closest.point};
  feature.count = std::min(feature.count, 2);
  std::copy_n(corners.begin(), 2, feature.corners.begin());
  return feature;
}

Vec3d cross_of(const SurfaceTriangle& t) {
  return cross(to_double(t[1]) - to_double(t[0]), to_double(t[2]) - to_double(t[0]));
}

Vec3d unit(Vec3d v) {
  const double size = length(v);
  return size > 0 ? v * (1 / size) : Vec3d{};
}

double angle_at(const SurfaceTriangle& triangle, Vec3f corner) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (triangle[i] != corner)
      continue;
    const Vec3d next = unit(to_double(triangle[(i + 1) % 3]) - to_double(corner));
    const Vec3d last = unit(to_double(triangle[(i + 2) % 3]) - to_double(corner));
    return angle_of(dot(next, last), length(cross(next, last)));
  }
  return 0;
}

bool has_corner(const SurfaceTriangle& triangle, Vec3f corner) {
  return std::ranges::find(triangle, corner) != triangle.end();
}

/// Triangles around an edge or a vertex.
using Fan = std::vector<SurfaceTriangle>;

Fan fan_in(const TriangleSearch& tree, const Feature& feature) {
  Fan fan = tree.around(feature.corners[0]);
  if (feature.count == 2)
    std::erase_if(fan,
                  [&](const SurfaceTriangle& t) { return !has_corner(t, feature.corners[1]); });
  return fan;
}

/// Returns whether each edge at the feature has two triangles, or no triangle is missing that is
/// flat.
bool is_closed(const Fan& fan, const Feature& feature) {
  if (feature.count == 2)
    return fan.size() == 2;
  std::vector<Vec3f> ends;
  for (const SurfaceTriangle& triangle : fan) {
    for (const Vec3f corner : triangle) {
      if (corner != feature.corners[0])
        ends.push_back(corner);
    }
  }
  const auto key = [](Vec3f p) { return std::array{p.x, p.y, p.z}; };
  std::ranges::sort(ends, {}, key);
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const bool is_pair = i + 1 < ends.size() && ends[i] == ends[i + 1];
    const bool is_more = i + 2 < ends.size() && ends[i] == ends[i + 2];
    if (!is_pair || is_more)
      return false;
  }
  return !ends.empty();
}

Vec3d pseudo_normal(const Fan& fan, const Feature& feature) {
  Vec3d sum{};
  for (const SurfaceTriangle& triangle : fan) {
    const double weight = feature.count == 2 ? 1 : angle_at(triangle, feature.corners[0]);
    sum = sum + unit(cross_of(triangle)) * weight;
  }
  return sum;
}

Side side_of(Vec3d point, Vec3d nearest, Vec3d normal) {
  const double height = dot(point - nearest, normal);
  return height < 0 ? Side::inside : Side::outside;
}

/// A point whose own tile does not have all triangles at its feature.
struct OpenFan {
  Feature feature;
  Fan fan;
};

using OpenFans = std::vector<std::unique_ptr<OpenFan>>;

/// The other tiles that may have triangles at open fans; by tile.
std::vector<TileQuery> other_tiles(const CutSurface& surface, const OpenFans& open,
                                   std::span<const NearestOnSurface> nearest) {
  std::vector<TileQuery> queries;
  for (std::size_t first = 0; first < open.size(); first += kSearchedPoints) {
    const std::size_t end = std::min(first + kSearchedPoints, open.size());
    Bounds box;
    for (std::size_t i = first; i < end; ++i) {
      if (open[i])
        box.add(open[i]->feature.corners[0]);
    }
    for (std::uint32_t tile = 0; tile < surface.size(); ++tile) {
      const Bounds& bounds = surface.facts(tile).bounds;
      if (bounds.empty() || box.empty() || squared_gap(bounds, box) > 0)
        continue;
      for (std::size_t i = first; i < end; ++i) {
        if (open[i] && tile != nearest[i].tile &&
            squared_distance(to_double(open[i]->feature.corners[0]), bounds) == 0)
          queries.push_back({tile, static_cast<std::uint32_t>(i)});
      }
    }
  }
  return by_tile(queries, surface.size());
}

/// Adds the triangles of other tiles, in the order of the tiles.
void complete(const CutSurface& surface, TreeCache& trees,
              std::span<const NearestOnSurface> nearest, OpenFans& open,
              const execution::CancelToken& cancel) {
  const std::vector<TileQuery> queries = other_tiles(surface, open, nearest);
  std::vector<Fan> fans(queries.size());
  look_up(trees, queries, cancel,
          [&](const TileTree& tree, std::size_t number, const TileQuery& query) {
            fans[number] = fan_in(tree.search, open[query.point]->feature);
          });
  for (std::size_t i = 0; i < queries.size(); ++i) {
    Fan& fan = open[queries[i].point]->fan;
    fan.insert(fan.end(), fans[i].begin(), fans[i].end());
  }
}

}  // namespace

std::vector<Side> surface_sides(const CutSurface& surface, TreeCache& trees,
                                std::span<const Vec3d> points,
                                std::span<const NearestOnSurface> nearest,
                                const execution::CancelToken& cancel) {
  std::vector<Side> sides(points.size(), Side::outside);
  std::vector<TileQuery> queries;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(nearest[i].squared))
      sides[i] = Side::unknown;
    else if (nearest[i].squared > 0)
      queries.push_back({nearest[i].tile, static_cast<std::uint32_t>(i)});
  }
  queries = by_tile(queries, surface.size());
  const auto take = [&](std::size_t point, const Feature& feature, Vec3d normal) {
    sides[point] = side_of(points[point], feature.point, normal);
  };
  OpenFans open(points.size());
  look_up(trees, queries, cancel, [&](const TileTree& tree, std::size_t, const TileQuery& query) {
    const std::uint32_t point = query.point;
    const SurfaceTriangle& triangle = tree.search[nearest[point].triangle];
    const Feature feature = feature_of(triangle, points[point]);
    if (feature.count == 0)
      return take(point, feature, cross_of(triangle));
    Fan fan = fan_in(tree.search, feature);
    if (is_closed(fan, feature))
      return take(point, feature, pseudo_normal(fan, feature));
    open[point] = std::make_unique<OpenFan>(OpenFan{feature, std::move(fan)});
  });
  complete(surface, trees, nearest, open, cancel);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!open[i])
      continue;
    const auto& [feature, fan] = *open[i];
    sides[i] = Side::unknown;
    if (is_closed(fan, feature))
      take(i, feature, pseudo_normal(fan, feature));
  }
  return sides;
}

}  // namespace meshhier::comparing
