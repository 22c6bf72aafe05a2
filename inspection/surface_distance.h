// The exact distance of points to the surface that a cut shows, without holding all of it.
#pragma once

#include "execution/cancel.h"
#include "hierarchy/bounds.h"
#include "hierarchy/vec.h"
#include "inspection/cut_surface.h"
#include "inspection/triangle_search.h"

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::inspection {

/// Square of the distance of a point to a box; 0 inside. `bounds` must not be empty.
double squared_distance(Vec3d point, const Bounds& bounds);

/// Trees of a surface's tiles; the least recently used go first.
class TreeCache {
 public:
  TreeCache(const CutSurface& surface, std::uint64_t limit_bytes)
      : surface_(surface), limit_bytes_(limit_bytes) {}

  /// The trees of some tiles, built in parallel as far as they are not there. Positions without
  /// repeats.
  std::vector<std::shared_ptr<const TriangleSearch>> get(std::span<const std::uint32_t> positions);

 private:
  struct Entry {
    std::uint32_t position = 0;
    std::shared_ptr<const TriangleSearch> tree;
  };

  void insert(std::uint32_t position, std::shared_ptr<const TriangleSearch> tree);

  const CutSurface& surface_;
  std::uint64_t limit_bytes_;
  std::uint64_t used_bytes_ = 0;
  std::list<Entry> entries_;  ///< most recently used first
  std::map<std::uint32_t, std::list<Entry>::iterator> places_;
};

class SurfaceDistance {
 public:
  /// `cache_bytes`: for the trees of tiles; a few are held at a time whatever it is. `surface` must
  /// outlive it.
  SurfaceDistance(const CutSurface& surface, std::uint64_t cache_bytes)
      : surface_(surface), trees_(surface, cache_bytes) {}

  /// The distance of each point, in the order of the points: infinite if the surface has no
  /// triangle. Points that follow each other should be near each other (curve_order()), for speed
  /// only. Holds some 50 bytes a point; parallel; the result depends on the points and the surface
  /// alone, to the bit. Throws Error(io | corrupt) if a tile cannot be read, Error(interrupted).
  std::vector<double> distances(std::span<const Vec3d> points,
                                const execution::CancelToken& cancel);

 private:
  /// A point to be looked up in a tile.
  struct Query {
    std::uint32_t tile = 0;
    std::uint32_t point = 0;
    friend auto operator<=>(const Query&, const Query&) = default;
  };

  /// The tiles that may hold the nearest triangle of one of a block of points, nearest box first.
  struct Candidate {
    double squared = 0;  ///< distance between the boxes
    std::uint32_t tile = 0;
    friend auto operator<=>(const Candidate&, const Candidate&) = default;
  };

  std::vector<Candidate> candidates(std::span<const Vec3d> block) const;
  std::uint32_t likely_tile(Vec3d point, std::span<const Candidate> candidates) const;
  std::vector<Query> take_batch(std::span<const Vec3d> points, std::span<const double> squared,
                                std::span<const Query>& queries) const;
  std::vector<double> answer_batch(std::span<const Vec3d> points, std::span<const double> squared,
                                   std::span<const Query> batch);
  void answer(std::span<const Vec3d> points, std::vector<Query> queries,
              std::vector<double>& squared, const execution::CancelToken& cancel);

  const CutSurface& surface_;
  TreeCache trees_;
};

}  // namespace meshhier::inspection
