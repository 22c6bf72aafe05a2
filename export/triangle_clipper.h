// Triangles cut where a region ends.
#pragma once

#include "export/clipped_corner.h"
#include "export/region.h"

#include <vector>

namespace meshhier::exporting {

/// Cuts triangles. Thread-safe.
class TriangleClipper {
 public:
  /// Both must outlive it.
  TriangleClipper(const Region& region, const CornerMixer& mixer)
      : region_(region), mixer_(mixer) {}

  /// Returns the pieces of a triangle in the region, turned as it is; the triangle itself if all of
  /// it lies there. Triangles that share an edge, with the same values at its ends, get the same
  /// corners on it, bit for bit. On a side of a box a corner has the side's coordinate, rounded to
  /// float.
  std::vector<ClippedPolygon> pieces(ClippedPolygon triangle) const;

  /// Returns whether a point of the triangle lies in the region; a corner or an edge on a side of a
  /// box is enough.
  bool touches(const ClippedPolygon& triangle) const;

 private:
  ClippedPolygon within_box(ClippedPolygon polygon) const;
  ClippedCorner cut(const ClippedCorner& one, const ClippedCorner& other,
                    const HalfSpace& half) const;
  void add_within_plan(const std::array<const ClippedCorner*, 3>& triangle,
                       std::vector<ClippedPolygon>& pieces) const;
  ClippedCorner corner_of(const std::array<const ClippedCorner*, 3>& triangle,
                          const TriangleCut::Vertex& vertex) const;

  const Region& region_;
  const CornerMixer& mixer_;
};

}  // namespace meshhier::exporting
