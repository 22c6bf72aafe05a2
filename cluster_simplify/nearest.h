// Nearest neighbours among points.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Finds the nearest of a few points: a tree of boxes around runs of them, as they are given.
///
/// A query takes O(log n) if points that follow each other are near each other, as the vertices of
/// a tile are, and O(n) in the worst order. Equal points, however many, do no harm.
class NearestPoints {
 public:
  /// `candidates`: at least one, indices into `positions`. Copies what it needs. O(n).
  NearestPoints(std::span<const Vec3f> positions, std::span<const std::uint32_t> candidates);

  /// The candidate nearest to a point; of equally near ones the first.
  std::uint32_t nearest(Vec3f asked) const;

 private:
  struct Search;

  double some_distance(Vec3d asked) const;
  void look_through(std::size_t level, std::size_t index, Search& search) const;

  std::vector<std::uint32_t> candidates_;
  std::vector<Vec3f> points_;                ///< of the candidates
  std::vector<std::vector<Bounds>> levels_;  ///< finest first; the last one is the root's
};

/// The nearest of the vertices that are drawn, for those that ask how far what is lost is from it.
class NearestDrawn {
 public:
  /// `drawn`: indices into `positions`; there may be none.
  NearestDrawn(std::span<const Vec3f> positions, std::span<const std::uint32_t> drawn) {
    if (!drawn.empty())
      points_.emplace(positions, drawn);
  }

  /// Returns measure(the drawn vertex nearest to a point); infinite if nothing is drawn.
  template <class Measure>
  double from(Vec3f lost, const Measure& measure) const {
    return points_ ? double{measure(points_->nearest(lost))}
                   : std::numeric_limits<double>::infinity();
  }

 private:
  std::optional<NearestPoints> points_;
};

/// For each of `asked` the nearest of `candidates` (at least one), both indices into `positions`;
/// of equally near ones the first.
std::vector<std::uint32_t> nearest_of(std::span<const Vec3f> positions,
                                      std::span<const std::uint32_t> candidates,
                                      std::span<const std::uint32_t> asked);

}  // namespace meshhier::cluster_simplify
