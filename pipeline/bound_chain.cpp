#include "pipeline/bound_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::pipeline {
namespace {

/// A float that is certainly not below `value`, and above `below`.
float above(float below, double value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  auto result = static_cast<float>(value);
  if (result < value)
    result = std::nextafter(result, kInfinity);
  return std::max(result, std::nextafter(below, kInfinity));
}

}  // namespace

void make_unique(std::vector<std::uint32_t>& tiles) {
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  tiles.shrink_to_fit();
}

BoundChain::BoundChain(Forest& forest, double diagonal) : forest_(forest), diagonal_(diagonal) {
  const Tree& tree = forest.tree();
  const std::uint32_t count = tree.node_count(tree.depth());
  below_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    below_[i].reached = {i};
}

void BoundChain::add(Level level, std::span<const Step> steps) {
  std::vector<Sum> sums(steps.size());
  for (std::uint32_t i = 0; i < steps.size(); ++i)
    sums[i] = sum_of({level, i}, steps);
  for (std::uint32_t i = 0; i < steps.size(); ++i)
    note({level, i}, steps[i], sums[i]);
  below_ = std::move(sums);
}

std::uint32_t BoundChain::parent(Level level, std::uint32_t finer_tile) const {
  return forest_.tree().parent({finer(level), finer_tile}).index;
}

BoundChain::Sum BoundChain::sum_of(NodeId node, std::span<const Step> steps) const {
  const Step& step = steps[node.index];
  Sum sum;
  for (const std::uint32_t tile : step.finer_neighbours)
    sum.back = std::max(sum.back, below_[tile].back);
  const Tree::Children children = forest_.tree().children(node);
  for (const NodeId child : children.span()) {
    const Sum& below = below_[child.index];
    sum.back = std::max(sum.back, below.back);
    sum.forth = std::max(sum.forth, below.forth);
    for (const std::uint32_t tile : below.reached)
      sum.reached.push_back(parent(node.level, tile));
  }
  make_unique(sum.reached);
  double farthest = 0;
  const std::size_t count = sum.reached.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Step& taken = steps[sum.reached[i]];
    farthest = std::max(farthest, taken.certain);
    for (const std::uint32_t tile : taken.finer_neighbours)
      sum.reached.push_back(parent(node.level, tile));
  }
  make_unique(sum.reached);
  sum.back += step.certain;
  sum.forth += farthest;
  return sum;
}

void BoundChain::note(NodeId node, const Step& step, const Sum& sum) {
  TileFacts below;
  const Tree::Children children = forest_.tree().children(node);
  for (const NodeId child : children.span()) {
    below.error = std::max(below.error, forest_.facts(child).error);
    below.bound = std::max(below.bound, forest_.facts(child).bound);
  }
  TileFacts& facts = forest_.facts(node);
  if (forest_.tree().is_early(node)) {
    facts.error = below.error;
    facts.bound = below.bound;
    return;
  }
  facts.error = above(below.error, below.error + std::sqrt(step.mean_square));
  facts.bound =
      std::max(above(below.bound, std::min(std::max(sum.back, sum.forth), diagonal_)), facts.error);
}

}  // namespace meshhier::pipeline
