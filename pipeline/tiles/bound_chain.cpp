#include "pipeline/tiles/bound_chain.h"

#include "partition/parallel_parts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace meshhier::pipeline {
namespace {

/// Returns a float that is certainly not below `value`, and above `below`.
float above(float below, double value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  auto result = static_cast<float>(value);
  if (result < value)
    result = std::nextafter(result, kInfinity);
  return std::max(result, std::nextafter(below, kInfinity));
}

}  // namespace

void TileSet::settle() {
  std::sort(numbers_.begin(), numbers_.end());
  numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
  numbers_.shrink_to_fit();
  if (numbers_.size() > kMost)
    add_all();
}

BoundChain::BoundChain(const Tree& tree, double diagonal)
    : tree_(tree), errors_(tree), diagonal_(diagonal) {
  const std::uint32_t count = tree.node_count(tree.depth());
  below_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    below_[i].reached.add(i);
}

void BoundChain::add(Level level, std::span<const StepDeviation> steps) {
  most_back_ = most_certain_ = 0;
  for (const Sum& sum : below_)
    most_back_ = std::max(most_back_, sum.back);
  for (const StepDeviation& step : steps)
    most_certain_ = std::max(most_certain_, step.certain);
  std::vector<Sum> sums(steps.size());
  constexpr std::uint64_t kPart = 64;
  partition::for_each_part(steps.size(), kPart, [&](std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t i = first; i < first + count; ++i)
      sums[i] = sum_of({level, static_cast<std::uint32_t>(i)}, steps);
  });
  for (std::uint32_t i = 0; i < steps.size(); ++i)
    note({level, i}, steps[i], sums[i]);
  below_ = std::move(sums);
}

std::uint32_t BoundChain::parent(Level level, std::uint32_t finer_tile) const {
  return tree_.parent({finer(level), finer_tile}).index;
}

/// Returns the largest way back from any of the tiles, which are of the level below.
double BoundChain::farthest_back(const TileSet& tiles) const {
  if (tiles.is_all())
    return most_back_;
  double farthest = 0;
  tiles.for_each([&](std::uint32_t tile) { farthest = std::max(farthest, below_[tile].back); });
  return farthest;
}

BoundChain::Sum BoundChain::sum_of(NodeId node, std::span<const StepDeviation> steps) const {
  const StepDeviation& step = steps[node.index];
  Sum sum;
  // The surface was measured against its children's and its neighbours' children's: a point's way
  // back may lead through any of them.
  sum.back = farthest_back(step.finer_neighbours);
  TileSet landed;  // in tiles of this level
  const auto add_parents = [&](const TileSet& finer_tiles, TileSet& to) {
    if (finer_tiles.is_all())
      return to.add_all();
    finer_tiles.for_each([&](std::uint32_t tile) { to.add(parent(node.level, tile)); });
  };
  const Tree::Children children = tree_.children(node);
  for (const NodeId child : children.span()) {
    const Sum& below = below_[child.index];
    sum.back = std::max(sum.back, below.back);
    sum.forth = std::max(sum.forth, below.forth);
    add_parents(below.reached, landed);
  }
  landed.settle();
  // A point from under this node may lie in any tile of `landed`, whose step moves it now: into
  // that tile or one beside it, which is where the next level finds it.
  sum.reached = landed;
  double farthest = 0;
  if (landed.is_all()) {
    farthest = most_certain_;
  } else {
    landed.for_each([&](std::uint32_t tile) {
      farthest = std::max(farthest, steps[tile].certain);
      add_parents(steps[tile].finer_neighbours, sum.reached);
    });
    sum.reached.settle();
  }
  sum.back += step.certain;
  sum.forth += farthest;
  return sum;
}

void BoundChain::note(NodeId node, const StepDeviation& step, const Sum& sum) {
  TileError below;
  const Tree::Children children = tree_.children(node);
  for (const NodeId child : children.span()) {
    below.error = std::max(below.error, errors_[child].error);
    below.bound = std::max(below.bound, errors_[child].bound);
  }
  TileError& own = errors_[node];
  if (tree_.is_early(node)) {
    own = below;
    return;
  }
  // Both must grow strictly towards the root, also where a step moved nothing: viewers rely on it.
  own.error = above(below.error, std::min(below.error + std::sqrt(step.mean_square), diagonal_));
  own.bound =
      std::max(above(below.bound, std::min(std::max(sum.back, sum.forth), diagonal_)), own.error);
  assert(std::isfinite(own.bound));
}

}  // namespace meshhier::pipeline
