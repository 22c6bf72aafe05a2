#include "cluster_simplify/split_cover.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

/// Triangles looked at; 40 to 60 are usual.
constexpr std::size_t kMostTriangles = 192;

/// Splits of one triangle. On folded surfaces ten to thirty are usual.
constexpr int kMostSplits = 96;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

}  // namespace

void SplitCover::gather(const Spot& spot) {
  if (distances_left_ == 0) {
    for (const std::uint32_t t : spot.near) {
      if (t != kNone)
        triangles_.push_back(t);
    }
    return;
  }
  for (const std::uint32_t vertex : target_->corners(spot.near[0])) {
    for (const std::uint32_t t : candidates_around(*target_, vertex))
      triangles_.push_back(t);
  }
}

std::span<const double> SplitCover::row(std::uint32_t point) const {
  return {rows_.data() + point * frames_.size(), frames_.size()};
}

/// Its distance to the nearest triangle is a lower bound of the result.
std::uint32_t SplitCover::add_point(Vec3d point) {
  points_.push_back(point);
  distances_left_ -= std::min<std::uint64_t>(distances_left_, frames_.size());
  double nearest = kInfinite;
  for (const TriangleFrame& frame : frames_) {
    rows_.push_back(squared_distance(point, frame));
    nearest = std::min(nearest, rows_.back());
  }
  limit_ = std::max(limit_, nearest);
  return static_cast<std::uint32_t>(points_.size() - 1);
}

void SplitCover::push(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto to_a = row(a);
  const auto to_b = row(b);
  const auto to_c = row(c);
  double reach = kInfinite;
  for (std::size_t i = 0; i < to_a.size(); ++i)
    reach = std::min(reach, std::max({to_a[i], to_b[i], to_c[i]}));
  if (reach <= limit_)
    return;
  pieces_.push_back({reach, {a, b, c}});
  std::push_heap(pieces_.begin(), pieces_.end(),
                 [](const Piece& x, const Piece& y) { return x.reach < y.reach; });
}

SplitCover::Pair SplitCover::served_both(std::uint32_t a, std::uint32_t b) const {
  const auto to_a = row(a);
  const auto to_b = row(b);
  Pair best{kInfinite, 0};
  for (std::size_t i = 0; i < to_a.size(); ++i) {
    const double reach = std::max(to_a[i], to_b[i]);
    if (reach < best.reach)
      best = {reach, i};
  }
  return best;
}

/// Where on the way from a to b the triangle that serves a best gives way to the one that serves b:
/// of those within reach of the one end the nearest to the other, taken as linear in between.
double SplitCover::passage(std::uint32_t a, std::uint32_t b) const {
  const auto to_a = row(a);
  const auto to_b = row(b);
  std::size_t at_a = frames_.size();
  std::size_t at_b = frames_.size();
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (to_a[i] <= limit_ && (at_a == frames_.size() || to_b[i] < to_b[at_a]))
      at_a = i;
    if (to_b[i] <= limit_ && (at_b == frames_.size() || to_a[i] < to_a[at_b]))
      at_b = i;
  }
  if (at_a == frames_.size() || at_b == frames_.size())
    return 0.5;
  const double gain_a = std::sqrt(to_a[at_b]) - std::sqrt(to_a[at_a]);
  const double gain_b = std::sqrt(to_b[at_a]) - std::sqrt(to_b[at_b]);
  const double part = gain_a / (gain_a + gain_b);
  constexpr double kProgress = 1e-3;  // a cut at the very end would change nothing
  return part > kProgress && part < 1 - kProgress ? part : 0.5;
}

void SplitCover::split(const Piece& piece) {
  Pair pairs[3];
  std::size_t worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    pairs[i] = served_both(piece.corners[i], piece.corners[(i + 1) % 3]);
    if (pairs[i].reach > pairs[worst].reach)
      worst = i;
  }
  if (pairs[worst].reach <= limit_) {
    split_inside(piece, pairs);
    return;
  }
  const std::uint32_t a = piece.corners[worst];
  const std::uint32_t b = piece.corners[(worst + 1) % 3];
  const std::uint32_t c = piece.corners[(worst + 2) % 3];
  const double part = passage(a, b);
  const std::uint32_t cut = add_point(points_[a] * (1 - part) + points_[b] * part);
  push(a, cut, c);
  push(cut, b, c);
}

/// Every edge is served by one triangle: three that meet in a vertex below the piece.
void SplitCover::split_inside(const Piece& piece, const Pair (&pairs)[3]) {
  const auto& [a, b, c] = piece.corners;
  Vec3d cut = (points_[a] + points_[b] + points_[c]) * (1.0 / 3);
  for (const std::uint32_t vertex : target_->corners(triangles_[pairs[0].triangle])) {
    if (!target_->has_corner(triangles_[pairs[1].triangle], vertex) ||
        !target_->has_corner(triangles_[pairs[2].triangle], vertex))
      continue;
    const PlaneFoot foot =
        plane_foot(target_->position(vertex), {points_[a], points_[b], points_[c]});
    if (foot.inside)
      cut = foot.point;
  }
  const std::uint32_t inner = add_point(cut);
  push(a, b, inner);
  push(b, c, inner);
  push(c, a, inner);
}

double SplitCover::bound(const TargetSurface& target, const Spot& a, const Spot& b, const Spot& c,
                         double squared_reach) {
  target_ = &target;
  limit_ = squared_reach;
  triangles_.clear();
  for (const Spot* spot : {&a, &b, &c})
    gather(*spot);
  std::sort(triangles_.begin(), triangles_.end());
  triangles_.erase(std::unique(triangles_.begin(), triangles_.end()), triangles_.end());
  triangles_.resize(std::min(triangles_.size(), kMostTriangles));
  frames_.clear();
  for (const std::uint32_t t : triangles_) {
    const TargetSurface::Corners& corners = target.corners(t);
    frames_.emplace_back(target.position(corners[0]), target.position(corners[1]),
                         target.position(corners[2]));
  }
  points_.clear();
  rows_.clear();
  pieces_.clear();
  for (const Spot* spot : {&a, &b, &c})
    add_point(spot->point);
  push(0, 1, 2);
  for (int splits = 0; !pieces_.empty() && pieces_.front().reach > limit_; ++splits) {
    if (splits == kMostSplits || distances_left_ == 0)
      return pieces_.front().reach;
    std::pop_heap(pieces_.begin(), pieces_.end(),
                  [](const Piece& x, const Piece& y) { return x.reach < y.reach; });
    const Piece worst = pieces_.back();
    pieces_.pop_back();
    split(worst);
  }
  return limit_;
}

}  // namespace meshhier::cluster_simplify
