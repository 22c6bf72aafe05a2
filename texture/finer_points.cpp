#include "texture/finer_points.h"

#include "base/bounds.h"
#include "base/closest_point.h"
#include "texture/texel_raster.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace meshhier::texture {
namespace {

FinerPoint point_in(std::uint32_t triangle, double on_b, double on_c) {
  return {triangle, static_cast<float>(on_b), static_cast<float>(on_c)};
}

/// Of a texel, as long as surfaces are drawn, if two triangles cover it.
constexpr std::uint32_t kSeveral = FinerPoint::kNone - 1;
bool is_one(std::uint32_t triangle) {
  return triangle < kSeveral;
}

}  // namespace

FootShares::FootShares(const SurfaceTriangle& t) : a(t[0]) {
  const Vec3d b = to_double(t[1]) - to_double(a), c = to_double(t[2]) - to_double(a);
  const double bb = dot(b, b), bc = dot(b, c), cc = dot(c, c);
  const double area = bb * cc - bc * bc;
  if (!(area > 0))
    return;
  to_b = to_float((b * cc - c * bc) * (1 / area));
  to_c = to_float((c * bb - b * bc) * (1 / area));
}

/// Draws finer surfaces into the charts of a tile, with texels of one size.
class PointDrawing {
 public:
  PointDrawing(const FinerSurfaces& finer, const TexelSamples& samples)
      : finer_(finer),
        samples_(samples),
        layout_(samples.layout()),
        drawn_(std::size_t{layout_.width} * layout_.height, FinerPoint::kNone),
        is_kept_(finer.triangle_count()) {}

  std::vector<FinerPoint> operator()() && {
    for (std::size_t s = 0; s < finer_.shapes_.size(); ++s)
      draw(s);
    points_.resize(drawn_.size());
    std::ranges::sort(several_);
    const std::vector<TexelPlace> left = take_drawn();
    for (const TexelPlace& texel : left)
      keep_around(texel);
    search(left);
    return std::move(points_);
  }

 private:
  struct TexelPlace {
    const ChartPlane* chart;
    std::uint32_t x, y;
  };

  std::size_t index(std::uint32_t x, std::uint32_t y) const { return samples_.index(x, y); }
  std::uint32_t chart_of(const VertexFoot& foot) const { return samples_.chart_of(foot.triangle); }

  void draw(std::size_t surface) {
    const FinerShape& shape = finer_.shapes_[surface];
    const std::uint32_t first = finer_.begins_[surface];
    if (shape.beside.empty()) {
      std::fill_n(is_kept_.begin() + first, shape.triangles.size(), std::uint8_t{1});
      return;
    }
    const std::vector<VertexFoot>& feet = finer_.feet_[surface];
    std::vector<TexelPoint> places(feet.size());  // in their own charts
    for (std::size_t v = 0; v < feet.size(); ++v) {
      if (feet[v].triangle != kNoFace)
        places[v] = layout_.texel_of(layout_.planes[chart_of(feet[v])], feet[v].point);
    }
    for (std::uint32_t t = 0; t < shape.triangles.size(); ++t) {
      const auto [a, b, c] = shape.triangles[t];
      const std::array<const VertexFoot*, 3> on{&feet[raw(a)], &feet[raw(b)], &feet[raw(c)]};
      if (on[0]->triangle == kNoFace || on[1]->triangle == kNoFace || on[2]->triangle == kNoFace)
        continue;
      draw(first + t, on, {places[raw(a)], places[raw(b)], places[raw(c)]});
    }
  }

  void draw(std::uint32_t triangle, const std::array<const VertexFoot*, 3>& feet,
            const std::array<TexelPoint, 3>& places) {
    const std::array charts{chart_of(*feet[0]), chart_of(*feet[1]), chart_of(*feet[2])};
    if (charts[0] == charts[1] && charts[0] == charts[2]) {
      draw_into(layout_.planes[charts[0]], triangle, places);
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if ((k > 0 && charts[k] == charts[0]) || (k > 1 && charts[k] == charts[1]))
        continue;
      const ChartPlane& plane = layout_.planes[charts[k]];
      draw_into(plane, triangle,
                {layout_.texel_of(plane, feet[0]->point), layout_.texel_of(plane, feet[1]->point),
                 layout_.texel_of(plane, feet[2]->point)});
    }
  }

  void draw_into(const ChartPlane& plane, std::uint32_t triangle,
                 const std::array<TexelPoint, 3>& at) {
    const RasterTriangle raster(at);
    if (plane.is_point || raster.twice_area() <= 0) {  // it looks away
      is_kept_[triangle] = 1;
      return;
    }
    raster.for_each_span(TexelSamples::range_of(plane),
                         [&](std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
                           for (std::uint32_t x = begin; x < end; ++x)
                             show(triangle, index(x, y));
                         });
  }

  void show(std::uint32_t triangle, std::size_t texel) {
    std::uint32_t& drawn = drawn_[texel];
    if (drawn == FinerPoint::kNone) {
      drawn = triangle;
      return;
    }
    if (is_one(drawn))
      several_.emplace_back(static_cast<std::uint32_t>(texel), drawn);
    several_.emplace_back(static_cast<std::uint32_t>(texel), triangle);
    drawn = kSeveral;
  }

  /// Gives the texels that triangles cover their points, as far as these tell them, and returns the
  /// others.
  std::vector<TexelPlace> take_drawn() {
    std::vector<TexelPlace> left;
    for (const ChartPlane& plane : layout_.planes) {
      for_each_texel(TexelSamples::range_of(plane), [&](std::uint32_t x, std::uint32_t y) {
        prefetch_drawn(index(x, y) + kAhead);
        if (samples_.at(x, y).triangle != kNoFace && !takes_drawn(plane, x, y))
          left.push_back({&plane, x, y});
      });
    }
    return left;
  }

  /// Triangles are more than a cache holds: that of a texel which comes soon is asked for early.
  void prefetch_drawn(std::size_t texel) const {
    if (texel < drawn_.size() && is_one(drawn_[texel]))
      __builtin_prefetch(&finer_.shares_[drawn_[texel]]);
  }

  /// The foot of the texel's own point counts, as far as it is within the triangle: places in the
  /// chart are those of corners, and between them a little off. Else it may be in a triangle that a
  /// texel beside it shows.
  bool takes_drawn(const ChartPlane& plane, std::uint32_t x, std::uint32_t y) {
    const std::uint32_t triangle = drawn_[index(x, y)];
    const TexelSample& sample = samples_.at(x, y);
    if (triangle == FinerPoint::kNone || !sample.is_inside())
      return false;
    const Vec3d point = point_of(sample);
    if (triangle == kSeveral)
      return takes_one_of_several(point, index(x, y));
    FinerPoint& foot = points_[index(x, y)];
    if (finer_.has_foot(triangle, point, foot))
      return true;
    return any_texel(texels_near(TexelSamples::range_of(plane), x, y, 1, 1), [&](std::uint32_t i,
                                                                                 std::uint32_t j) {
      const std::uint32_t other = drawn_[index(i, j)];
      return is_one(other) && other != triangle && finer_.has_foot(other, point, foot);
    });
  }

  /// Returns a sample's point. Texels side by side have the same triangle more often than not.
  Vec3d point_of(const TexelSample& sample) {
    if (sample.triangle != plane_of_) {
      plane_of_ = sample.triangle;
      plane_ = samples_.plane_of(plane_of_);
    }
    return plane_.point(sample);
  }

  bool takes_one_of_several(const Vec3d& point, std::size_t texel) {
    const auto number = static_cast<std::uint32_t>(texel);
    candidates_.clear();
    for (auto at = std::ranges::lower_bound(several_, std::pair(number, std::uint32_t{0}));
         at != several_.end() && at->first == number; ++at)
      candidates_.push_back(at->second);
    if (const std::optional<FinerPoint> foot = finer_.foot_in(candidates_, point)) {
      points_[texel] = *foot;
      return true;
    }
    for (const std::uint32_t triangle : candidates_)
      is_kept_[triangle] = 1;
    return false;
  }

  /// Keeps the triangles that texels around show.
  void keep_around(const TexelPlace& texel) {
    constexpr std::uint32_t kAround = 2;
    const auto& [plane, x, y] = texel;
    for_each_texel(texels_near(TexelSamples::range_of(*plane), x, y, kAround, kAround),
                   [&](std::uint32_t i, std::uint32_t j) {
                     if (const std::uint32_t other = drawn_[index(i, j)]; is_one(other))
                       is_kept_[other] = 1;
                   });
  }

  void search(std::span<const TexelPlace> texels) {
    if (texels.empty())
      return;
    std::vector<std::uint32_t> numbers;
    std::vector<SurfaceTriangle> triangles;
    for (std::uint32_t t = 0; t < finer_.triangle_count(); ++t) {
      if (is_kept_[t] == 0)
        continue;
      numbers.push_back(t);
      triangles.push_back(finer_.corners(t));
    }
    NearestTriangle nearest = finer_.tree_of(triangles);
    for (const auto& [plane, x, y] : texels) {
      const TexelSample& sample = samples_.at(x, y);
      const NearestTriangle::Found found = nearest(
          samples_.point(sample), samples_.facing(*plane, sample), kFacingReach / layout_.density);
      if (found.triangle != NearestTriangle::kNone)
        points_[index(x, y)] = point_in(numbers[found.triangle], found.on_b, found.on_c);
    }
  }

  const FinerSurfaces& finer_;
  const TexelSamples& samples_;
  const ChartLayout& layout_;
  std::vector<std::uint32_t> drawn_;  ///< of texels: the triangle that covers it
  std::vector<std::pair<std::uint32_t, std::uint32_t>> several_;  ///< texels and their triangles
  std::vector<std::uint32_t> candidates_;
  std::vector<std::uint8_t> is_kept_;  ///< of finer triangles: texels that are left may show them
  std::vector<FinerPoint> points_;     ///< of texels
  std::uint32_t plane_of_ = kNoFace;   ///< the triangle that plane_ is of
  TexelSamples::Plane plane_;
};

FinerSurfaces::FinerSurfaces(std::vector<FinerShape> shapes, const TexelSamples& charts)
    : shapes_(std::move(shapes)), begins_{0}, tile_(charts.tile().positions) {
  const FootFinder finder(charts.tile().positions, charts.tile().triangles, charts.faces());
  for (const FinerShape& shape : shapes_) {
    begins_.push_back(begins_.back() + static_cast<std::uint32_t>(shape.triangles.size()));
    feet_.push_back(feet_of(finder, shape.positions, shape.triangles, shape.beside));
    for (const TileTriangle& t : shape.triangles)
      shares_.emplace_back(corners(shape, t));
  }
}

std::vector<FinerPoint> FinerSurfaces::points(const TexelSamples& samples) const {
  return PointDrawing(*this, samples)();
}

std::optional<FinerSurfaces::Amid> FinerSurfaces::amid_texels(const TexelSamples& samples,
                                                              const TexelRange& chart,
                                                              std::span<const FinerPoint> points,
                                                              std::uint32_t x,
                                                              std::uint32_t y) const {
  const auto four = four_texels(x, y);
  const auto is_inside = [&](const auto& at) {
    return samples.at(at.first, at.second).is_inside();
  };
  if (!std::ranges::all_of(four, is_inside))
    return std::nullopt;
  Vec3d middle;
  for (const auto& [i, j] : four)
    middle = middle + samples.point(samples.at(i, j)) * 0.25;
  std::array<std::uint32_t, 16> around;
  std::size_t count = 0;
  for_each_texel(texels_near(chart, x, y, 1, 2), [&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t triangle = points[samples.index(i, j)].triangle;
    const auto end = around.begin() + static_cast<std::ptrdiff_t>(count);
    if (triangle != FinerPoint::kNone && std::find(around.begin(), end, triangle) == end)
      around[count++] = triangle;
  });
  const std::span<const std::uint32_t> triangles = std::span(around).first(count);
  const std::optional<FinerPoint> foot = foot_in(triangles, middle);
  return Amid{middle, foot ? *foot : nearest_of(triangles, middle)};
}

bool FinerSurfaces::has_foot(std::uint32_t triangle, const Vec3d& point, FinerPoint& foot) const {
  const FootShares& shares = shares_[triangle];
  const Vec3f to = to_float(point - to_double(shares.a));
  const float on_b = dot(to, shares.to_b), on_c = dot(to, shares.to_c);
  constexpr float kBeside = 1.0f / 64;  // of the triangle: rounding
  if (!(on_b >= -kBeside && on_c >= -kBeside && on_b + on_c <= 1 + kBeside))
    return false;
  const float b = std::max(on_b, 0.0f), c = std::max(on_c, 0.0f);
  const float scale = b + c > 1 ? 1 / (b + c) : 1;
  foot = {triangle, b * scale, c * scale};
  return true;
}

std::optional<FinerPoint> FinerSurfaces::foot_in(std::span<const std::uint32_t> triangles,
                                                 const Vec3d& point) const {
  std::optional<FinerPoint> nearest;
  for (const std::uint32_t t : triangles) {
    if (FinerPoint foot; has_foot(t, point, foot))
      nearest = nearest ? nearest_of(std::array{nearest->triangle, t}, point) : foot;
  }
  return nearest;
}

FinerPoint FinerSurfaces::nearest_of(std::span<const std::uint32_t> triangles,
                                     const Vec3d& point) const {
  FinerPoint nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : triangles) {
    const auto [a, b, c] = corners(t);
    const ClosestPoint there = closest_point(point, {to_double(a), to_double(b), to_double(c)});
    if (!(there.squared_distance < least))
      continue;
    least = there.squared_distance;
    nearest = point_in(t, there.on_b, there.on_c);
  }
  return nearest;
}

std::size_t FinerSurfaces::surface_of(std::uint32_t triangle) const {
  const auto behind = std::upper_bound(begins_.begin(), begins_.end(), triangle);
  return static_cast<std::size_t>(behind - begins_.begin()) - 1;
}

SurfaceTriangle FinerSurfaces::corners(std::uint32_t triangle) const {
  const std::size_t s = surface_of(triangle);
  return corners(shapes_[s], shapes_[s].triangles[triangle - begins_[s]]);
}

SurfaceTriangle FinerSurfaces::corners(const FinerShape& shape, const TileTriangle& triangle) {
  const auto [a, b, c] = triangle;
  return {shape.positions[raw(a)], shape.positions[raw(b)], shape.positions[raw(c)]};
}

NearestTriangle FinerSurfaces::tree_of(std::span<const SurfaceTriangle> triangles) const {
  const Bounds box = bounds_of(tile_);
  const Vec3d low = to_double(box.min), high = to_double(box.max);
  const double size = length(high - low);
  return {triangles, (low + high) * 0.5, size > 0 ? size : 1};
}

}  // namespace meshhier::texture
