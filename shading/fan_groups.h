// Finds the smooth pieces of surface that meet at a place: each has a normal of its own there.
//
//            sharp                    Triangles around the place, walked around once. They are cut
//          t1 | t2                    into fans at sharp edges: t1 t6 and t2 t3 t4 t5. A single
//        .    |    .                  sharp edge cuts nothing. Fans that face alike, though not
//      t6 ----o---- t3                neighbours, are one group.
//        .   / \   .
//          t5   t4
//          sharp at t5 | t6
//
// The walk takes O(n) where each edge has two triangles that turn alike, as inside a surface.
// Anywhere else triangles are joined over edges found by sorting, O(n log n).
#pragma once

#include "base/union_find.h"
#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::shading {

/// A triangle's corner at the place.
struct FanCorner {
  std::uint32_t next = 0, previous = 0;  ///< places of the triangle's other corners
  Vec3d area;                            ///< along the triangle's normal, twice its area long
};

struct FanGroups {
  std::vector<std::uint32_t> group_of;  ///< of each corner
  std::vector<Vec3d> normals;           ///< of each group, the largest first; of any length
  bool is_one_fan = false;              ///< one group then; its normal is the sum of all areas
};

/// Groups the corners of one place after another. Keeps its memory.
///
/// Triangles that share an edge of at most kCreaseAngle are one fan; fans whose normals differ by
/// no more are one group (leaders: Hartigan 1975; 32 at most). So a single sharp edge in a noisy
/// scan splits nothing: two must meet. An edge of other than two triangles is sharp. Triangles
/// without area go to the first group. At least one group.
class FanGrouper {
 public:
  /// `place_count`: the corners' places are less.
  explicit FanGrouper(std::size_t place_count) : corner_of_(place_count) {}

  /// The result holds until the next call. Finds fans in O(n) inside a surface, else in
  /// O(n log n); compares each with the groups.
  const FanGroups& group(std::span<const FanCorner> corners);

 private:
  std::size_t find_fans(std::span<const FanCorner> corners);
  bool walk_around(std::span<const FanCorner> corners);
  std::size_t divide_round();
  std::size_t join_neighbours(std::span<const FanCorner> corners);
  bool is_smooth(std::span<const FanCorner> corners, std::uint32_t a, std::uint32_t b) const;
  void join_fans(std::span<const FanCorner> corners);
  std::size_t nearest_or_new_group(const Vec3d& sum);

  std::vector<std::uint8_t> corner_of_;  ///< by the next corner's place, as last seen
  std::vector<double> sizes_;            ///< of the corners' areas
  std::vector<std::uint32_t> round_;     ///< corners, each followed by the one beyond its edge
  std::vector<std::size_t> sharp_;       ///< places in the round behind which there is a crease
  std::vector<std::uint64_t> sides_;
  UnionFind joined_{0};
  std::vector<std::uint32_t> fan_of_;  ///< of each corner the least one of its fan
  std::vector<Vec3d> sums_;            ///< of each fan's areas, by its name
  std::vector<std::uint32_t> fans_, group_of_fan_;
  std::vector<Vec3d> leaders_;
  FanGroups groups_;
};

}  // namespace meshhier::shading
