#include "cluster_simplify/cover_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

// A bound this much above what is needed at least is good enough.
constexpr double kTight = 1.25;

// Rounding of distances and of points on edges, relative.
constexpr double kDistanceRounding = 0x1p-40;

// Cuts are kept this part of an edge away from its ends: a cut at an end would cut nothing off.
constexpr double kMargin = 1.0 / 32;

constexpr double kNoDistance = -1;  // in place of a distance

double distance_to(Vec3d position, const Cover& cover) {
  return std::sqrt(squared_distance(position, cover.frame)) + cover.extra;
}

}  // namespace

void CoverDistance::set_covers(std::span<const Cover> covers) {
  covers_ = covers;
  pairs_.clear();
  for (std::size_t i = 0; i < covers.size(); i += 2)
    pairs_.emplace_back(covers[i].frame, covers[std::min(i + 1, covers.size() - 1)].frame);
}

CoverDistance::Point CoverDistance::measured(Vec3d position) {
  Point point{position, distances_.size(), 0};
  distances_.resize(point.row + row_size());
  double* const row = distances_.data() + point.row;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const TrianglePair::Two squared = squared_distances(position, pairs_[i]);
    row[2 * i] = std::sqrt(squared[0]) + covers_[2 * i].extra;
    row[2 * i + 1] = 2 * i + 1 < covers_.size() ? std::sqrt(squared[1]) + covers_[2 * i + 1].extra
                                                : std::numeric_limits<double>::infinity();
  }
  point.nearest = static_cast<std::size_t>(std::min_element(row, row + covers_.size()) - row);
  return point;
}

/// The edge, from that corner to the next, whose ends no cover reaches both; else the longest.
std::size_t CoverDistance::edge_to_cut(const Piece& piece, double reach) const {
  std::size_t best = 0;
  double longest = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& a = piece[k];
    const Point& b = piece[(k + 1) % 3];
    double nearest = std::numeric_limits<double>::infinity();  // of the farther end
    for (std::size_t i = 0; i < row_size(); ++i)
      nearest = std::min(nearest, std::max(distance(a, i), distance(b, i)));
    const Vec3d along = b.position - a.position;
    const double squared = dot(along, along) * (nearest <= reach ? 0x1p-20 : 1);
    if (squared > longest) {
      longest = squared;
      best = k;
    }
  }
  return best;
}

/// About where the cover nearest to one end becomes farther than that of the other: two steps of
/// regula falsi.
Vec3d CoverDistance::crossing(const Point& a, const Point& b) const {
  const Vec3d along = b.position - a.position;
  const std::size_t i = a.nearest;
  const std::size_t j = b.nearest;
  double low = 0, high = 1;
  double at_low = distance(a, i) - distance(a, j);   // <= 0
  double at_high = distance(b, i) - distance(b, j);  // >= 0
  double part = 0.5;
  for (int step = 0; step < 2 && at_high > at_low; ++step) {
    part = low + (high - low) * std::clamp(at_low / (at_low - at_high), kMargin, 1 - kMargin);
    const Vec3d x = a.position + along * part;
    const double difference = distance_to(x, covers_[i]) - distance_to(x, covers_[j]);
    (difference < 0 ? low : high) = part;
    (difference < 0 ? at_low : at_high) = difference;
  }
  return a.position + along * std::clamp(part, kMargin, 1 - kMargin);
}

/// The bound of one piece; or cuts it, keeps its halves for later and returns 0.
double CoverDistance::cut_or_bound(Piece piece, double enough) {
  double needed = 0;
  for (const Point& corner : piece)
    needed = std::max(needed, distance(corner, corner.nearest));
  const auto farthest = [&](std::size_t cover) {
    return std::max(
        {distance(piece[0], cover), distance(piece[1], cover), distance(piece[2], cover)});
  };
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < row_size(); ++i)
    least = std::min(least, farthest(i));
  // No cut can bring the bound below `needed`: the corners themselves are that far.
  const double reach = std::max(enough, kTight * needed);
  if (least <= reach || distances_.size() >= most_rows_ * row_size()) {
    std::size_t best = 0;
    while (best + 1 < covers_.size() && farthest(best) != least)
      ++best;
    landings_[best] = std::max(landings_[best], least);
    return least;
  }
  // Between ends of one nearest cover nothing crosses: halving makes the piece smaller at least.
  const std::size_t k = edge_to_cut(piece, reach);
  const Point& a = piece[k];
  const Point& b = piece[(k + 1) % 3];
  const Point middle =
      measured(a.nearest == b.nearest ? (a.position + b.position) * 0.5 : crossing(a, b));
  Piece first = piece;
  Piece second = piece;
  first[(k + 1) % 3] = middle;
  second[k] = middle;
  pieces_.push_back(first);
  pieces_.push_back(second);
  return 0;
}

double CoverDistance::near_one(const Corners& triangle, const Cover& cover, double enough) {
  double farthest = 0;
  for (const Vec3d& corner : triangle) {
    farthest = std::max(farthest, distance_to(corner, cover));
    if (!(farthest <= enough))
      return kNoDistance;
  }
  return farthest * (1 + kDistanceRounding);
}

double CoverDistance::operator()(const Corners& triangle, std::span<const Cover> covers,
                                 double enough) {
  if (covers.empty())
    return std::numeric_limits<double>::infinity();
  landings_.assign(covers.size(), kNoDistance);
  set_covers(covers);
  distances_.clear();
  return whole({measured(triangle[0]), measured(triangle[1]), measured(triangle[2])}, enough);
}

void CoverDistance::begin(std::span<const Cover> covers, std::span<const Vec3d> points) {
  set_covers(covers);
  distances_.clear();
  points_.clear();
  for (const Vec3d& point : points)
    points_.push_back(measured(point));
}

double CoverDistance::triangle(const std::array<std::size_t, 3>& corners, double enough) {
  if (covers_.empty())
    return std::numeric_limits<double>::infinity();
  landings_.assign(covers_.size(), kNoDistance);
  distances_.resize(points_.size() * row_size());
  return whole({points_[corners[0]], points_[corners[1]], points_[corners[2]]}, enough);
}

double CoverDistance::whole(const Piece& triangle, double enough) {
  most_rows_ = distances_.size() / row_size() + kMostPieces;
  pieces_.clear();
  pieces_.push_back(triangle);
  double largest = 0;
  while (!pieces_.empty()) {
    const Piece piece = pieces_.back();
    pieces_.pop_back();
    largest = std::max(largest, cut_or_bound(piece, std::max(enough, largest)));
  }
  return largest * (1 + kDistanceRounding);
}

}  // namespace meshhier::cluster_simplify
