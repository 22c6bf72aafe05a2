// The segments of all lines of an outline, over numbered points.
//
// Where sectors meet, a line runs through the triangles with corners in both:
//
//        two sectors in a triangle               three
//
//             A                                   A
//            / \                                 / \           A, B, C: sectors of the corners
//           m---m                               m   m          m: middle of a crossing edge
//          /     \                             / \ / \         o: centroid
//         /       \                           /   o   \        lines: m to m, m to o
//        B---------B                         B----m----C
//
// The same edge has the same middle in all triangles, so lines of neighbours meet: an edge is found
// in several triangles by sorting, and gets one number. A crossing edge that one triangle alone has
// is on the mesh's border, which runs over the middle as well.
//
// Invariant. Points are numbered by the names of the vertices they lie between, not in the order of
// arrival: equal meshes have equal networks.
#pragma once

#include "outline/placed_triangle.h"
#include "outline/tile_lines.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::outline {

/// The parts that a tile brings to the network.
struct SectorContent {
  /// Those in several sectors, sorted; of those in several tiles if it is the first.
  std::vector<PlacedTriangle> triangles;
  TileLines lines;
};

/// Segments of numbered points: first the vertices by tile and index, then the points of sector
/// lines by the corners they lie between: an edge's midpoint (a, b, b), a triangle's centroid
/// (a, b, c).
class Network {
 public:
  /// Takes what tiles hold, by ascending tile, and leaves nothing there. Without the segments.
  /// O(t log t) for t triangles.
  explicit Network(std::span<SectorContent*> sectors);

  /// How many there will be.
  std::size_t segment_count() const;

  /// Throws Error(internal) if a triangle refers to a vertex that is not in its tile's boundary.
  void make_segments();

  /// A line of its own, two points or more; a closed one repeats its first as its last.
  void add_form(std::span<const Vec3f> points);

  std::uint32_t count() const { return static_cast<std::uint32_t>(positions_.size()); }
  std::span<const Vec3f> positions() const { return positions_; }
  /// These leave none here.
  Edges take_segments() { return std::exchange(segments_, {}); }
  Edges take_forms() { return std::exchange(forms_, {}); }

 private:
  struct Tile {
    std::uint32_t tile, boundary_count, base;
    std::vector<std::uint32_t> inner;
  };
  /// Numbers of a triangle's points, as far as it has them.
  struct Points {
    std::array<std::uint32_t, 3> middles;
    std::uint32_t centroid;
  };
  /// An edge between two sectors, as one triangle has it.
  struct CrossingEdge {
    VertexKey low, high;
    std::uint32_t place;  ///< triangle * 3 + edge
    friend constexpr auto operator<=>(const CrossingEdge&, const CrossingEdge&) = default;
  };

  void add_lines(TileLines& lines);
  std::vector<CrossingEdge> crossing_edges() const;
  /// A triangle and its duplicates or mirror images make one line.
  bool is_repeated(std::size_t triangle) const;
  void number_points();
  std::uint32_t add_midpoint(const PlacedTriangle& triangle, std::size_t edge);
  std::uint32_t add_centroid(const PlacedTriangle& triangle);
  /// The line through one border triangle, which has two or three crossing edges.
  void add_line(const PlacedTriangle& triangle, const Points& points);
  /// The number of a vertex on the mesh's border that a triangle in several sectors uses.
  std::uint32_t number_of(VertexKey vertex) const;

  std::vector<Tile> tiles_;
  std::vector<Vec3f> positions_;
  Edges segments_;
  Edges forms_;  ///< creases, and what was added
  // Until segments are made:
  std::vector<PlacedTriangle> triangles_;  ///< sorted: a sector's come before the next one's
  std::vector<Points> points_;             ///< of each triangle
  std::vector<CrossingEdge> lonely_;       ///< ascending
};

}  // namespace meshhier::outline
