// Charts seen along their mean normals, in small boxes.
//
// Problem. A chart is cut in halves again and again, and each time the plane is asked for in which
// its box is smallest: twelve turns of all corners would be most of what charts cost.
//
// Idea. A vertex is looked at once, however many triangles share it. Its place in the plane is
// found once, and then turned, two vertices at a time:
//
//              v ^   +------+            turn k of 12 over a quarter of a circle:
//                |   |  /\  |            low and high of x cos + y sin, y cos - x sin
//                |   | /__\ |
//                |   +------+
//                +-------------> u
//
// Invariant. The boxes are those of all corners, to the bit.
//
// Cost. O(triangles) a chart; 4 bytes a vertex of the surface.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "texture/chart_layout.h"
#include "texture/faces.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// The vertices of one chart after another, each once.
class ChartVertices {
 public:
  ChartVertices(std::size_t vertex_count, std::span<const TileTriangle> triangles)
      : triangles_(triangles), chart_of_(vertex_count) {}

  /// Returns them in the order of their first corners; valid up to the next call.
  std::span<const std::uint32_t> of(std::span<const std::uint32_t> chart);

 private:
  std::span<const TileTriangle> triangles_;
  std::vector<std::uint32_t> chart_of_;  ///< the last one asked for that has the vertex
  std::uint32_t chart_ = 0;
  std::vector<std::uint32_t> vertices_;
};

/// For charts of a surface that outlives it. Not for several threads.
class ChartProjector {
 public:
  ChartProjector(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles,
                 const Faces& faces)
      : positions_(positions), faces_(faces), vertices_(positions.size(), triangles) {}

  /// Returns the plane of the mean normal, turned so that the chart's box is small.
  ChartPlane operator()(std::span<const std::uint32_t> chart);

 private:
  struct Box;

  void place(std::span<const std::uint32_t> vertices, const Vec3d& u, const Vec3d& v);
  Box turned_box(double cosine, double sine) const;

  std::span<const Vec3f> positions_;
  const Faces& faces_;
  ChartVertices vertices_;
  std::vector<double> x_, y_;  ///< of the vertices in the plane, up to count_, which is even
  std::size_t count_ = 0;
};

}  // namespace meshhier::texture
