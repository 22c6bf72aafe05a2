// Where the vertices of a finer surface lie on a tile.
//
// Problem. Each vertex asks for a point of the tile. A search in all of its triangles takes longer
// than all else that is done for a vertex.
//
// Idea. The contraction leaves for each vertex the tile's vertex that it has become. The foot of
// its perpendicular is in one of the triangles around that, or a few steps away over edges:
//
//        ____ ____
//       /\  /\  /\     v has become p; of the triangles around p the one with v's foot is looked
//      /__\p__\/__\    for first; if none has it, the way goes over the edge that is nearest to v,
//      \  /\v /\  /    as long as that comes nearer
//       \/__\/__\/
//
// Cost. O(d + steps) a vertex, d being the triangles around one of the tile's; 60 ns.
#pragma once

#include "base/closest_point.h"
#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "texture/faces.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Vertices of a finer surface that lie near no vertex of the tile, as far as is known.
inline constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

struct VertexFoot {
  std::uint32_t triangle = kNoFace;  ///< of the tile
  Vec3d point;                       ///< in it
};

/// Finds feet on one tile. Immutable.
class FootFinder {
 public:
  /// `faces`: those of the triangles; it must outlive the finder. O(n).
  FootFinder(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles,
             const Faces& faces);

  /// Returns a foot of a point, from `vertex` of the tile on: that of its perpendicular in a
  /// triangle there, if one has it, else the nearest point that a walk over edges comes to. It has
  /// no triangle if the vertex has none.
  VertexFoot operator()(const Vec3d& point, std::uint32_t vertex) const;

 private:
  std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    return std::span(around_).subspan(begins_[vertex], begins_[vertex + 1] - begins_[vertex]);
  }
  VertexFoot walked(const Vec3d& point, std::uint32_t triangle) const;

  const Faces& faces_;
  std::vector<TriangleFrame> frames_;  ///< of triangles
  std::vector<std::uint32_t> begins_;  ///< of each vertex, in around_
  std::vector<std::uint32_t> around_;  ///< triangles of vertices, ascending
};

/// Returns the feet of all vertices of a finer surface. `beside`: for each of them a vertex of the
/// tile, or kNoVertex: it takes that of another corner of one of its triangles. Those without any
/// have no foot; all, if `beside` is empty.
std::vector<VertexFoot> feet_of(const FootFinder& tile, std::span<const Vec3f> positions,
                                std::span<const TileTriangle> triangles,
                                std::span<const std::uint32_t> beside);

}  // namespace meshhier::texture
