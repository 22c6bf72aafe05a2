// One surface of a contraction, fine or coarse, as something to measure distances to.
#pragma once

#include "cluster_simplify/closest_point.h"
#include "hierarchy/tile_mesh.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// No vertex, no triangle: as an entry of a vertex map, a vertex whose image is not known.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Triangles around a tile's own vertices. The first own_count positions are own vertices, the
/// others context.
struct SurfacePatch {
  std::span<const Vec3f> positions;
  std::uint32_t own_count = 0;
  std::span<const Triangle> interior;
  std::span<const Triangle> border;  ///< interior and border form one list; the order is no matter
};

SurfacePatch patch_of(const TileMesh& mesh);

/// A patch with what finding a triangle takes. Triangles are looked up by *key*: the coarse vertex
/// that a corner is or becomes, so that one key names the same place on both surfaces.
class TargetSurface {
 public:
  using Corners = std::array<std::uint32_t, 3>;

  /// Takes a patch; memory of an earlier one is reused. `coarse_of`: vertex -> key, < key_count or
  /// kNone; empty if the vertices are the keys. Triangles with two equal corners are left out.
  /// Throws Error(internal) on an index out of range. `patch.positions` and `coarse_of` must
  /// outlive the use. O(n), O(n log n) with vertices of very many triangles.
  void assign(const SurfacePatch& patch, std::span<const std::uint32_t> coarse_of,
              std::uint32_t key_count);

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(positions_.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles_.size()); }
  Vec3d position(std::uint32_t vertex) const { return to_double(positions_[vertex]); }
  const Corners& corners(std::uint32_t triangle) const { return triangles_[triangle]; }
  bool is_own(std::uint32_t vertex) const { return vertex < own_count_; }
  bool has_own_corner(std::uint32_t triangle) const;
  std::uint32_t key(std::uint32_t vertex) const {
    return coarse_of_.empty() ? vertex : coarse_of_[vertex];
  }
  bool is_used(std::uint32_t vertex) const { return used_[vertex] != 0; }

  /// The triangles with a corner of this key, ascending; none for kNone.
  std::span<const std::uint32_t> around(std::uint32_t key) const {
    if (key == kNone)
      return {};
    return {star_.data() + start_[key], star_.data() + start_[key + 1]};
  }

  /// A triangle on the other side of the edge from corner `edge` to the next, or kNone. Where more
  /// than two triangles share an edge, the next of them in turn.
  std::uint32_t across(std::uint32_t triangle, unsigned edge) const {
    return across_[triangle][edge];
  }

  /// The edge of across(triangle, edge) that is meant.
  unsigned edge_across(std::uint32_t triangle, unsigned edge) const {
    return edge_across_[triangle][edge];
  }

  /// None of its edges has more than one other triangle, and none of those has the same corners.
  bool is_simple(std::uint32_t triangle) const { return simple_[triangle] != 0; }

  bool has_corner(std::uint32_t triangle, std::uint32_t vertex) const {
    const Corners& c = triangles_[triangle];
    return (c[0] == vertex) | (c[1] == vertex) | (c[2] == vertex);
  }
  Segment edge(std::uint32_t triangle, unsigned edge) const {
    const Corners& c = triangles_[triangle];
    const Vec3d start = position(c[edge]);
    return {start, position(c[edge == 2 ? 0 : edge + 1]) - start};
  }
  TriangleFrame frame(std::uint32_t triangle) const {
    const Corners& c = triangles_[triangle];
    return {position(c[0]), position(c[1]), position(c[2])};
  }

 private:
  void add(const Triangle& triangle, std::uint32_t key_count);
  void build_stars(std::uint32_t key_count);
  void build_neighbours();

  std::span<const Vec3f> positions_;
  std::span<const std::uint32_t> coarse_of_;
  std::uint32_t own_count_ = 0;
  std::vector<Corners> triangles_;
  std::vector<Corners> keys_;
  std::vector<Corners> across_;
  std::vector<std::array<std::uint8_t, 3>> edge_across_;
  std::vector<std::uint8_t> used_;
  std::vector<std::uint8_t> simple_;
  std::vector<std::uint32_t> start_, star_;  ///< key -> triangles, compressed rows
  std::vector<std::uint32_t> edge_start_;    ///< lower end -> half edges, compressed rows
  struct HalfEdge {
    std::uint32_t upper, triangle, edge;
  };
  void connect(std::span<const HalfEdge> around_edge);
  std::vector<HalfEdge> half_edges_;
};

}  // namespace meshhier::cluster_simplify
