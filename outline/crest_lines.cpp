#include "outline/crest_lines.h"

#include "base/tangent_frame.h"
#include "outline/polyline.h"
#include "outline/surface_normals.h"
#include "outline/tile_lines.h"
#include "outline/tile_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace meshhier::outline {
namespace {

/// Rounds of smoothing. With 2 hair and folds bring more short lines, with 8 eyes and lips are
/// lost.
constexpr int kCrestRounds = 3;

/// Weaker lines are waves that one hardly sees.
constexpr double kLeastStrength = 0.7;

/// How a surface bends at a vertex: by `most` in the direction `across`, by `other` at a right
/// angle to it; one over input units. All zero where nothing tells.
struct Bend {
  Vec3d across;
  double most = 0, other = 0;
  double slope = 0;  ///< how `most` grows in that direction

  /// A ball bends alike in all directions: it has no crest.
  double lead() const { return most - std::abs(other); }
};

/// The symmetric matrix (a b, b c), by the axes of a TangentFrame.
struct Tensor {
  double a = 0, b = 0, c = 0;
};

/// The one that takes steps (x, y) to changes (p, q) with the least squared
/// error.
class TensorFit {
 public:
  void add(double x, double y, double p, double q) {
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    xp_ += x * p;
    mixed_ += y * p + x * q;
    yq_ += y * q;
  }

  /// Zero where the steps do not tell.
  Tensor solve() const {
    if (!(xx_ > 0 && yy_ > 0))
      return {};
    const double divisor = xx_ + yy_ - xy_ * xy_ / xx_ - xy_ * xy_ / yy_;
    if (!(divisor > 1e-9 * (xx_ + yy_)))
      return {};
    const double b = (mixed_ - xy_ * xp_ / xx_ - xy_ * yq_ / yy_) / divisor;
    return {(xp_ - b * xy_) / xx_, b, (yq_ - b * xy_) / yy_};
  }

 private:
  double xx_ = 0, xy_ = 0, yy_ = 0, xp_ = 0, mixed_ = 0, yq_ = 0;
};

/// How the normal turns along the surface at each vertex.
std::vector<Tensor> curvatures(const TileMesh& tile, const Neighbours& neighbours,
                               std::span<const Vec3f> normals) {
  const auto position = [&](std::uint32_t v) { return to_double(tile.vertices.positions[v]); };
  std::vector<Tensor> tensors(tile.own_count);
  for (std::uint32_t v = 0; v < tile.own_count; ++v) {
    const Vec3d normal = to_double(normals[v]);
    const TangentFrame frame(normal);
    TensorFit fit;
    for (const std::uint32_t other : neighbours[v]) {
      const Vec3d step = position(other) - position(v);
      const Vec3d turn = to_double(normals[other]) - normal;
      fit.add(dot(step, frame.u), dot(step, frame.v), dot(turn, frame.u), dot(turn, frame.v));
    }
    tensors[v] = fit.solve();
  }
  return tensors;
}

class Crests {
 public:
  /// `side`: 1 for ridges, -1 for valleys.
  Crests(const TileMesh& tile, const Neighbours& neighbours, std::span<const Vec3f> normals,
         std::span<const Tensor> curvatures, double side)
      : tile_(tile), neighbours_(neighbours) {
    bends_.resize(tile.own_count);
    for (std::uint32_t v = 0; v < tile.own_count; ++v)
      bends_[v] = bend_of(curvatures[v], to_double(normals[v]), side);
    for (std::uint32_t v = 0; v < tile.own_count; ++v)
      bends_[v].slope = slope_at(v);
  }

  void append_lines(std::vector<CrestLine>& lines) {
    collect_segments();
    const Chains chains = trace_chains(static_cast<std::uint32_t>(points_.size()), segments_);
    for (std::size_t i = 0; i < chains.size(); ++i) {
      CrestLine line = line_of(chains[i]);
      if (line.strength >= kLeastStrength)
        lines.push_back(std::move(line));
    }
  }

 private:
  struct Point {
    std::uint32_t low, high;  ///< the edge it lies on
    friend constexpr auto operator<=>(const Point&, const Point&) = default;
  };

  Vec3d position(std::uint32_t v) const { return to_double(tile_.vertices.positions[v]); }

  static Bend bend_of(const Tensor& curvature, Vec3d normal, double side) {
    if (!(dot(normal, normal) > 0))
      return {};
    const TangentFrame frame(normal);
    const double a = side * curvature.a, b = side * curvature.b, c = side * curvature.c;
    const double mean = (a + c) / 2, half = (a - c) / 2;
    const double radius = std::sqrt(half * half + b * b);
    if (!(radius > 0) || !std::isfinite(radius))
      return {};
    // The direction of the larger value, by whichever row is not nearly zero.
    const double x = half > 0 ? half + radius : b;
    const double y = half > 0 ? b : radius - half;
    return {to_double(of_length_one(frame.u * x + frame.v * y)), mean + radius, mean - radius, 0};
  }

  double slope_at(std::uint32_t v) const {
    double up = 0, squared = 0;
    for (const std::uint32_t other : neighbours_[v]) {
      const double step = dot(position(other) - position(v), bends_[v].across);
      up += (bends_[other].most - bends_[v].most) * step;
      squared += step * step;
    }
    return squared > 0 ? up / squared : 0;
  }

  /// Whether the bend has a maximum between the ends.
  bool has_crest(std::uint32_t a, std::uint32_t b) const {
    const Bend &at = bends_[a], &to = bends_[b];
    if (!(at.lead() + to.lead() > 0))
      return false;
    const double same = dot(at.across, to.across) < 0 ? -1 : 1;
    const double along = dot(at.across + to.across * same, position(b) - position(a));
    const double start = along < 0 ? -at.slope : at.slope;
    const double end = along < 0 ? -to.slope * same : to.slope * same;
    return start > 0 && end <= 0;
  }

  void collect_segments() {
    std::vector<std::array<Point, 2>> found;
    for_each_triangle(tile_, [&](const TileTriangle& t) {
      std::array<Point, 3> crossed;
      std::size_t count = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [a, b] = std::minmax({raw(t[i]), raw(t[(i + 1) % 3])});
        if (a != b && b < tile_.own_count && has_crest(a, b))
          crossed[count++] = {a, b};
      }
      if (count == 2)
        found.push_back({std::min(crossed[0], crossed[1]), std::max(crossed[0], crossed[1])});
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    for (const auto& ends : found)
      points_.insert(points_.end(), ends.begin(), ends.end());
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    const auto number = [&](const Point& p) {
      return static_cast<std::uint32_t>(std::lower_bound(points_.begin(), points_.end(), p) -
                                        points_.begin());
    };
    for (const auto& [a, b] : found)
      segments_.push_back({number(a), number(b)});
  }

  std::pair<Vec3d, double> place_of(const Point& p) const {
    const Bend &low = bends_[p.low], &high = bends_[p.high];
    const double sum = std::abs(low.slope) + std::abs(high.slope);
    const double part = sum > 0 ? std::abs(low.slope) / sum : 0.5;
    const auto between = [&](auto a, auto b) { return a + (b - a) * part; };
    return {between(position(p.low), position(p.high)), between(low.lead(), high.lead())};
  }

  CrestLine line_of(std::span<const std::uint32_t> nodes) const {
    CrestLine line;
    std::pair<Vec3d, double> last;
    for (const std::uint32_t node : nodes) {
      const auto here = place_of(points_[node]);
      if (!line.points.empty())
        line.strength += length(here.first - last.first) * (here.second + last.second) / 2;
      line.points.push_back(to_float(here.first));
      last = here;
    }
    return line;
  }

  const TileMesh& tile_;
  const Neighbours& neighbours_;
  std::vector<Bend> bends_;
  std::vector<Point> points_;
  Edges segments_;
};

}  // namespace

std::vector<CrestLine> crest_lines(const TileMesh& tile) {
  const Neighbours neighbours(tile);
  const std::vector<Vec3f> normals = smooth_normals(tile, neighbours, kCrestRounds);
  const std::vector<Tensor> tensors = curvatures(tile, neighbours, normals);
  std::vector<CrestLine> lines;
  for (const double side : {1.0, -1.0})
    Crests(tile, neighbours, normals, tensors, side).append_lines(lines);
  return lines;
}

}  // namespace meshhier::outline
