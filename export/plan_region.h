// A part of space that polygons seen from above bound, on whatever height.
//
// Problem. Triangles end where a polygon's border runs over them. Cut one by one, two triangles at
// an edge must get the same new vertices on it, or a gap opens; and a border may pass through
// corners, along edges or over itself.
//
// Idea. Seen from above, the borders within a triangle are inserted into a triangulation of it;
// then each small face lies wholly within or without:
//
//        2                          2
//        |\                         |\            1. borders near the triangle, by an R-tree
//        | \      border            |i\           2. their parts within it, as constraints
//        |  \    /                  |ii\          3. one face is tested: a ray to the east crosses
//        |   \  /                   |iii\            borders an odd number of times, or even
//        |    \/                    |iiii*        4. from face to face, each border that is crossed
//        |    /\                    |iii/o\          turns within to without (i, o), and back
//        |   /  \                   |ii/ooo\      5. the faces within are the cut
//        0--/----1                  0-*-----1
//
// Vertices that cutting makes are told by where they lie: on an edge, as a part of its way; else by
// weights of the corners. The caller mixes heights and attributes by these.
//
// Invariant. Decisions and places are exact numbers; only the parts of ways are rounded, once, at
// the end. On an edge they depend on the edge and the border alone, so both triangles there have
// the same, bit for bit. A triangle that no border touches is not cut.
//
// A vertical triangle is a line from above. It is cut along that line into strips, each within or
// without by its middle.
//
// Cost. O(log n) for a triangle away from borders; O(n + k log k) for k borders over it.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "hierarchy/frame.h"

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

/// Returns the place of `p` seen from above: its x, and its y or, if y points up, -z.
constexpr PlanPoint plan_of(Vec3d p, UpAxis up) {
  const Vec3d z_up = to_z_up(p, up);
  return {z_up.x, z_up.y};
}

/// The corners of a ring in order, the last one joined to the first.
using PlanRing = std::vector<PlanPoint>;
/// The places around which an odd number of its rings runs: within the first one, without its
/// holes.
using PlanPolygon = std::vector<PlanRing>;

/// The part of a triangle in a region.
struct TriangleCut {
  struct Vertex {
    /// The edge it lies on, from this corner to the next one; else -1.
    int edge = -1;
    /// The part of the way from the edge's first corner to its second one, and the rest of it;
    /// without an edge the weights of the second and the third corner. Rounded from exact numbers,
    /// so that both triangles at an edge have the same.
    double to = 0, rest = 0;
  };
  bool is_whole = false;
  std::vector<Vertex> vertices;  ///< vertices besides the corners
  /// Triangles of corners (0 to 2) and vertices (3 and up), turned as the triangle is. Empty if it
  /// is whole or nothing of it lies in the region.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The points that lie in any of the polygons. Decisions are exact: about the numbers as they are,
/// without rounding. Thread-safe.
class PlanRegion {
 public:
  /// Requires finite numbers. `check` is called before each cut and again and again in one, by any
  /// thread, and may throw. O(n log n).
  PlanRegion(
      const std::vector<PlanPolygon>& polygons, UpAxis up, std::function<void()> check = [] {});
  ~PlanRegion();
  PlanRegion(PlanRegion&&) noexcept;
  PlanRegion& operator=(PlanRegion&&) noexcept;

  /// Returns false only if no point of the box lies in it.
  bool may_meet(const BoundsD& box) const;
  bool contains(Vec3d p) const;
  /// Returns the least and the greatest corner of the box around all polygons; the first one is
  /// beyond the second one if there are none.
  std::array<PlanPoint, 2> corners() const;
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
