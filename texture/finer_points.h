// The points of finer surfaces that the texels of a tile show.
//
// Problem. Hundreds of thousands of texels ask for their point; a search takes 170 ns each.
//
// Idea. The finer triangles are drawn into the tile's charts. Each finer vertex has its foot on the
// tile (vertex_feet.h); a chart is a projection, so feet have places in it, and a triangle between
// three places covers its texels as on a screen:
//
//      finer   a_____b            chart   . . . . . .
//              |\    |\                   . a-------b     each texel inside of a, b, c has its
//      ________|_\___|_\_____             . . \ x x .     point by its shares of a, b and c
//      tile    a' \  b' \                 . . . \ x .
//                  c     d                . . . . c .
//
// That tells which triangle; its point is the foot of the texel's own perpendicular. A triangle
// over the border of two charts is drawn into both. Few texels are left: those whose foot is
// outside, those that no triangle covers, or two, where a fold is. They are searched for in a tree
// of the triangles that may be theirs: those that look away or overlap in a chart, and those around
// these texels.
//
// Invariant. Every point is one of a finer surface. The result does not depend on what is done
// when.
//
// Cost. O(n + texels), and O(log n) for each texel that is left, a tenth of them; 100 ns a
// triangle, 20 ns a texel.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "texture/nearest_triangle.h"
#include "texture/texel_samples.h"
#include "texture/vertex_feet.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::texture {

/// How far a surface that faces alike may be, in texels, so that it is taken before a nearer one
/// that does not.
inline constexpr double kFacingReach = 32;

/// A point of a triangle of finer surfaces, which are numbered through.
struct FinerPoint {
  static constexpr std::uint32_t kNone = NearestTriangle::kNone;
  std::uint32_t triangle = kNone;
  float on_b = 0, on_c = 0;  ///< a + on_b * (b - a) + on_c * (c - a)
};

/// A finer surface. `beside`: as feet_of() has it.
struct FinerShape {
  std::span<const Vec3f> positions;
  std::span<const TileTriangle> triangles;
  std::span<const std::uint32_t> beside;
};

template <class Surface>
std::vector<FinerShape> shapes_of(std::span<const Surface> surfaces) {
  std::vector<FinerShape> shapes;
  for (const Surface& one : surfaces)
    shapes.push_back({one.positions, one.triangles, one.beside});
  return shapes;
}

/// The foot of a point's perpendicular on a triangle is a + on_b * (b - a) + on_c * (c - a), on_b
/// being the product of the way from a to the point with `to_b`. A triangle without area has none.
struct FootShares {
  Vec3f a, to_b, to_c;

  explicit FootShares(const SurfaceTriangle& triangle);
};

/// A texel, and those right of it and below.
inline std::array<std::pair<std::uint32_t, std::uint32_t>, 4> four_texels(std::uint32_t x,
                                                                          std::uint32_t y) {
  return {std::pair(x, y), {x + 1, y}, {x, y + 1}, {x + 1, y + 1}};
}

/// Finer surfaces around one tile. Immutable; what its shapes and the tile name must outlive it.
class FinerSurfaces {
 public:
  /// `charts`: those of the tile, with any texels.
  FinerSurfaces(std::vector<FinerShape> shapes, const TexelSamples& charts);

  /// Returns the point of each texel that has a sample, row by row.
  std::vector<FinerPoint> points(const TexelSamples& samples) const;

  struct Amid {
    Vec3d point;  ///< of the tile
    FinerPoint finer;
  };
  /// Returns the points amid four_texels() of a chart: of the tile, and of those triangles that
  /// they and the texels around them show; nothing if one of the four is not inside of the chart.
  std::optional<Amid> amid_texels(const TexelSamples& samples, const TexelRange& chart,
                                  std::span<const FinerPoint> points, std::uint32_t x,
                                  std::uint32_t y) const;

  std::uint32_t triangle_count() const { return begins_.back(); }
  /// Returns the surface that a triangle is of.
  std::size_t surface_of(std::uint32_t triangle) const;
  std::uint32_t first_of(std::size_t surface) const { return begins_[surface]; }

 private:
  friend class PointDrawing;
  SurfaceTriangle corners(std::uint32_t triangle) const;
  static SurfaceTriangle corners(const FinerShape& shape, const TileTriangle& triangle);
  /// Whether the triangle has the foot of a point, and sets it then.
  bool has_foot(std::uint32_t triangle, const Vec3d& point, FinerPoint& foot) const;
  /// Returns the foot of a point in one of these triangles, in the nearest if several have one.
  std::optional<FinerPoint> foot_in(std::span<const std::uint32_t> triangles,
                                    const Vec3d& point) const;
  FinerPoint nearest_of(std::span<const std::uint32_t> triangles, const Vec3d& point) const;
  NearestTriangle tree_of(std::span<const SurfaceTriangle> triangles) const;

  std::vector<FinerShape> shapes_;
  std::vector<std::uint32_t> begins_;  ///< first triangles, and the end of all
  std::vector<std::vector<VertexFoot>> feet_;
  std::vector<FootShares> shares_;  ///< of triangles
  std::span<const Vec3f> tile_;
};

}  // namespace meshhier::texture
