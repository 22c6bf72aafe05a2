// Bounds how far a triangle is from a few others that cover it together.
//
// Problem. Where old and new triangles cannot be laid over each other (fan_gap.h gives up), or a
// border triangle is compared with what is drawn in its place (seam_strip.h), no map is known. Each
// point of the triangle is near *some* cover, but different points near different ones.
//
// Idea. The distance to one cover is a convex function, so on a whole piece it is nowhere larger
// than at the piece's farthest corner. If one cover is near all corners of a piece, the piece is
// done; else it is cut in two where one cover becomes nearer than another along an edge:
//
//         c                         c
//        / \                       /|\          left piece:  near cover A, bound known
//       /   \         ->          / | \         right piece: near cover B, bound known
//      /     \                   /  |  \        A and B are equally far from x
//     a-------b                 a---x---b
//    near A   near B
//
// Invariant. The pieces at hand and those done cover the triangle; `largest` bounds all done ones.
// `enough` rises with it: a piece that decides nothing need not be known better.
//
// Cost. At most 32 cuts; each makes a corner that is measured against all covers, two at a time:
// O(cuts * covers). Some 100,000 instructions around one edge.
#pragma once

#include "base/closest_point.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// A triangle that may cover another, and the distance that counts in addition where it does.
struct Cover {
  TriangleFrame frame;
  double extra = 0;  ///< >= 0
};

/// Finds d such that every point of a triangle is within d - extra of one of the covers.
///
/// The distance to one triangle is convex, so that of the farthest corner holds for a whole piece.
/// A triangle that no single cover is near enough to is cut in two where one cover becomes nearer
/// than another along an edge, and so on, until each piece's bound is within a quarter of what its
/// corners need at least, or below `enough`, or kMostPieces are there. Keeps its memory from one
/// triangle to the next.
class CoverDistance {
 public:
  using Corners = std::array<Vec3d, 3>;

  /// How far the triangle is from one cover, if that is no more than `enough`; else negative. Most
  /// triangles are near enough to one of two or three covers that are well chosen.
  static double near_one(const Corners& triangle, const Cover& cover, double enough);

  /// Infinite if there are no covers. Where the result is not above `enough` it may be any value up
  /// to that, however near the covers are. O(pieces * covers).
  double operator()(const Corners& triangle, std::span<const Cover> covers, double enough);

  /// Many triangles with common corners and the same covers: first the covers and the points, then
  /// triangles by the places of their corners among the points. `covers` must outlive the calls.
  void begin(std::span<const Cover> covers, std::span<const Vec3d> points);
  double triangle(const std::array<std::size_t, 3>& corners, double enough);
  /// From one of the points to the nearest cover.
  double nearest(std::size_t point) const {
    return distance(points_[point], points_[point].nearest);
  }

  /// After a call: for each cover the largest distance of a piece that was said to be near it;
  /// negative if none was. Valid until the next call.
  std::span<const double> landings() const { return landings_; }

  static constexpr int kMostPieces = 32;

 private:
  struct Point {
    Vec3d position;
    std::size_t row = 0;      ///< of distances_
    std::size_t nearest = 0;  ///< cover
  };
  using Piece = std::array<Point, 3>;

  Point measured(Vec3d position);
  double whole(const Piece& triangle, double enough);
  double cut_or_bound(Piece piece, double enough);
  std::size_t edge_to_cut(const Piece& piece, double reach) const;
  Vec3d crossing(const Point& a, const Point& b) const;
  double distance(const Point& point, std::size_t cover) const {
    return distances_[point.row + cover];
  }

  void set_covers(std::span<const Cover> covers);
  std::size_t row_size() const { return 2 * pairs_.size(); }

  std::span<const Cover> covers_;
  std::vector<TrianglePair> pairs_;  ///< the same; an odd one is there twice
  std::vector<double> distances_;    ///< a row per point: to each cover; infinite after an odd one
  std::vector<double> landings_;
  std::vector<Point> points_;
  std::vector<Piece> pieces_;
  std::size_t most_rows_ = 0;  ///< of distances_
};

}  // namespace meshhier::cluster_simplify
