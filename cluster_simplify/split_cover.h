// The slow and thorough way to bound a triangle's distance to a surface: by halving.
//
// Where the cuts of surface_cover.h do not work out (folds, triangles on top of each other,
// surfaces without connection), the triangle is split, worst piece first, until some one target
// triangle serves each piece. What is left when the pieces are used up is bounded by the best
// single triangle: certain always, tight nearly always.
#pragma once

#include "cluster_simplify/surface_cover.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

class SplitCover {
 public:
  /// The squared distance within which all points of triangle abc are of the target; not below
  /// `squared_reach`, at which the search ends. Every spot knows a triangle (whether within reach
  /// or not): looked at are the triangles around those.
  double bound(const TargetSurface& target, const Spot& a, const Spot& b, const Spot& c,
               double squared_reach);

  /// Point-triangle distances that calls of bound() may take together from now on; without any left
  /// they look at the spots' own triangles only, and split nothing: certain still, but looser.
  void allow(std::uint64_t distances) { distances_left_ = distances; }

 private:
  struct Piece {
    double reach;
    std::uint32_t corners[3];
  };
  struct Pair {
    double reach;
    std::size_t triangle;
  };

  void gather(const Spot& spot);
  std::uint32_t add_point(Vec3d point);
  std::span<const double> row(std::uint32_t point) const;
  void push(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  Pair served_both(std::uint32_t a, std::uint32_t b) const;
  double passage(std::uint32_t a, std::uint32_t b) const;
  void split(const Piece& piece);
  void split_inside(const Piece& piece, const Pair (&pairs)[3]);

  const TargetSurface* target_ = nullptr;
  double limit_ = 0;
  std::uint64_t distances_left_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<TriangleFrame> frames_;
  std::vector<Vec3d> points_;
  std::vector<double> rows_;  ///< point by point: squared distances to the triangles
  std::vector<Piece> pieces_;
};

}  // namespace meshhier::cluster_simplify
