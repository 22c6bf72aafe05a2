// Errors and bounds of tiles, from how far each level's contraction moved the surface.
#pragma once

#include "pipeline/forest.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::pipeline {

/// How far one contraction moved the surface: that of a tile, its seams counted.
struct Step {
  double certain = 0;  ///< both ways; infinite if what was drawn is drawn nowhere near
  double mean_square = 0;
  std::vector<std::uint32_t> finer_neighbours;  ///< tiles of the children's level that the drawn
                                                ///< surface was held against, ascending
};

void make_unique(std::vector<std::uint32_t>& tiles);

/// Adds steps up, level by level, into the tiles' facts. A step of a tile ends where it may: in the
/// tile or beside it. So two sums are kept per tile:
///   back   from any point the tile draws down to the original: the step of the tile, then back of
///          whichever finer tile it was measured against;
///   forth  from any original point under the tile up: the largest step of all tiles that the point
///          may have come to lie in.
class BoundChain {
 public:
  /// No distance counts for more than `diagonal`, of the whole model.
  BoundChain(Forest& forest, double diagonal);

  /// `steps`: one per node of the level, the next above the last call's.
  void add(Level level, std::span<const Step> steps);

 private:
  struct Sum {
    double back = 0;
    double forth = 0;
    std::vector<std::uint32_t> reached;  ///< tiles that points from under this one may lie in
  };

  std::uint32_t parent(Level level, std::uint32_t finer_tile) const;
  Sum sum_of(NodeId node, std::span<const Step> steps) const;
  void note(NodeId node, const Step& step, const Sum& sum);

  Forest& forest_;
  double diagonal_;
  std::vector<Sum> below_;
};

}  // namespace meshhier::pipeline
