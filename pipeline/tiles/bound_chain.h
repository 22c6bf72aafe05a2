// Errors and bounds of tiles, from the distance that each level's contraction moved the surface.
#pragma once

#include "hierarchy/tree.h"

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::pipeline {

/// Tiles of one level. More than a few count as all of them: a vertex that all tiles touch makes
/// all of them neighbours of each other, and their number squared would be held.
class TileSet {
 public:
  /// The most tiles that are kept one by one; scans stay below a third of it.
  static constexpr std::size_t kMost = 1024;

  TileSet() = default;
  /// Takes what numbers() returned.
  TileSet(std::vector<std::uint32_t> numbers) : numbers_(std::move(numbers)) {}

  void add(std::uint32_t tile) {
    if (is_all() || (!numbers_.empty() && numbers_.back() == tile))
      return;
    numbers_.push_back(tile);
    if (numbers_.size() > 4 * kMost)
      settle();
  }
  void add_all() { numbers_ = {kAll}; }
  /// Sorts and removes repeats; required after the last add().
  void settle();

  bool is_all() const { return !numbers_.empty() && numbers_.back() == kAll; }
  /// Calls visit(tile) for each, ascending. Requires that it is not all of them.
  template <class Visit>
  void for_each(const Visit& visit) const {
    assert(!is_all());
    for (const std::uint32_t tile : numbers_)
      visit(tile);
  }
  /// All that must be kept to make the set again.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }

 private:
  static constexpr std::uint32_t kAll = ~0U;
  std::vector<std::uint32_t> numbers_;  ///< or kAll alone
};

/// The distance that the contraction of one tile moved the surface, its seams counted.
struct StepDeviation {
  double certain = 0;        ///< both ways; infinite if what was drawn is drawn nowhere near
  double mean_square = 0;    ///< infinite likewise
  TileSet finer_neighbours;  ///< tiles of the children's level that the drawn surface was held
                             ///< against
};

/// The distance of a tile from the original mesh. See TileRecord.
struct TileError {
  float error = 0;
  float bound = 0;
};

/// One TileError for each node of a tree; all 0 at first.
class TileErrors {
 public:
  explicit TileErrors(const Tree& tree) {
    for (int l = 0; l <= raw(tree.depth()); ++l)
      levels_.emplace_back(tree.node_count(static_cast<Level>(l)));
  }
  TileError& operator[](NodeId node) { return levels_[raw(node.level)][node.index]; }
  const TileError& operator[](NodeId node) const { return levels_[raw(node.level)][node.index]; }

 private:
  std::vector<std::vector<TileError>> levels_;
};

/// Adds steps up, level by level, into errors and bounds of the tiles. A step of a tile ends where
/// it may: in the tile or beside it. So two sums are kept per tile:
///   back   from any point the tile draws down to the original: the step of the tile, then back of
///          whichever finer tile it was measured against;
///   forth  from any original point under the tile up: the largest step of all tiles that the point
///          may have come to lie in.
class BoundChain {
 public:
  /// `diagonal`: that of the whole model; no distance counts for more. A float can hold it, as
  /// readers refuse coordinates with longer distances between them (mesh_io/coordinate_range.h).
  BoundChain(const Tree& tree, double diagonal);

  /// Adds the steps of a level, the next above the last call's, one per node. Works in parallel on
  /// the caller's TBB arena.
  void add(Level level, std::span<const StepDeviation> steps);

  /// The errors of the levels that were added so far; 0 for the partitions.
  const TileErrors& errors() const { return errors_; }

 private:
  struct Sum {
    double back = 0;
    double forth = 0;
    TileSet reached;  ///< tiles that points from under this one may lie in
  };

  std::uint32_t parent(Level level, std::uint32_t finer_tile) const;
  double farthest_back(const TileSet& tiles) const;
  Sum sum_of(NodeId node, std::span<const StepDeviation> steps) const;
  void note(NodeId node, const StepDeviation& step, const Sum& sum);

  Tree tree_;
  TileErrors errors_;
  double diagonal_;
  std::vector<Sum> below_;
  double most_back_ = 0;     ///< the largest in below_
  double most_certain_ = 0;  ///< the largest among the steps of the level that is added
};

}  // namespace meshhier::pipeline
