// A part of space that polygons seen from above bound, on whatever height.
#pragma once

#include "hierarchy/bounds.h"
#include "hierarchy/frame.h"
#include "hierarchy/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::exporting {

/// A place seen from above: to the east, to the north.
struct PlanPoint {
  double x = 0, y = 0;
  friend bool operator==(const PlanPoint&, const PlanPoint&) = default;
};

/// What lies at `p`: its x, and its y or, if y points up, -z.
constexpr PlanPoint plan_of(Vec3d p, UpAxis up) {
  const Vec3d z_up = to_z_up(p, up);
  return {z_up.x, z_up.y};
}

/// Corners in order, the last one joined to the first.
using PlanRing = std::vector<PlanPoint>;
/// Where an odd number of its rings runs around: the first one without those of its holes.
using PlanPolygon = std::vector<PlanRing>;

/// What a triangle has in a region.
struct TriangleCut {
  struct Vertex {
    /// On an edge: from this corner to the next one; else -1.
    int edge = -1;
    /// On an edge: the part of the way from its first corner to its second one, and the rest of it;
    /// else the weights of the second and the third corner. Rounded from exact numbers, so that
    /// both triangles at an edge have the same.
    double to = 0, rest = 0;
  };
  bool is_whole = false;
  std::vector<Vertex> vertices;  ///< besides the corners
  /// Corners are 0 to 2, vertices 3 and up; turned as the triangle is. Empty if it is whole or
  /// nothing of it lies in the region.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What lies in any of the polygons. Decisions are exact: about the numbers as they are, without
/// rounding.
class PlanRegion {
 public:
  /// Finite numbers. `check` is called before each cut and again and again in one, by any thread,
  /// and may throw. O(n log n).
  PlanRegion(
      const std::vector<PlanPolygon>& polygons, UpAxis up, std::function<void()> check = [] {});
  ~PlanRegion();
  PlanRegion(PlanRegion&&) noexcept;
  PlanRegion& operator=(PlanRegion&&) noexcept;

  /// False: no point of the box lies in it.
  bool may_meet(const BoundsD& box) const;
  bool contains(Vec3d p) const;
  /// Cuts a triangle where borders of polygons run over it, seen from above. Two triangles that
  /// share an edge are cut at the same places of it, and edges only where a border crosses them: no
  /// gap opens. A vertical triangle is cut into strips. O(n + k log k) for k borders in its box, as
  /// long as no corner is that of many borders.
  TriangleCut cut(const std::array<Vec3d, 3>& corners) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace meshhier::exporting
