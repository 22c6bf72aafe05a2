// The frames of all corners of a surface in charts.
//
// Problem. A frame takes as long as a texel, and a triangle has three corners.
//
// Idea. It follows from the chart and the normal, and of a vertex the corners in one chart show the
// same normal but at creases. So each vertex remembers its last frame:
//
//        chart 1    |  chart 2        vertex v: frame 7 for the corners of chart 1,
//         \  7 | 7 / \ 9 /            frame 9 for those of chart 2
//          \ __v__/ __v__
//
// Cost. O(triangles); about as many frames as the picture's vertices, not one a corner.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "texture/chart_layout.h"
#include "texture/corners.h"
#include "texture/normal_bake.h"
#include "texture/vertex_frame.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

class CornerFrames {
 public:
  /// `normals`: one entry a triangle. Both must outlive it.
  CornerFrames(std::size_t vertex_count, std::span<const TileTriangle> triangles,
               std::span<const CornerNormals> normals);

  /// Finds the frames of a chart's triangles; each triangle is in one chart.
  void add_chart(const ChartPlane& plane, std::span<const std::uint32_t> chart);

  const VertexFrame& at(std::uint32_t triangle, std::size_t corner) const {
    return frames_[numbers_[triangle][corner]];
  }
  /// Returns one entry a triangle.
  std::vector<CornerTangents> tangents() const;

 private:
  /// The last frame of a vertex.
  struct Last {
    std::uint32_t chart = 0, number = 0;
    Vec3f normal;
  };

  std::uint32_t frame_of_corner(const ChartPlane& plane, std::uint32_t vertex, const Vec3f& normal);

  std::span<const TileTriangle> triangles_;
  std::span<const CornerNormals> normals_;
  std::vector<Last> last_;  ///< of vertices
  std::uint32_t chart_ = 0;
  std::vector<VertexFrame> frames_;
  std::vector<TangentCode> tangents_;
  std::vector<std::array<std::uint32_t, 3>> numbers_;  ///< of the corners' frames
};

}  // namespace meshhier::texture
