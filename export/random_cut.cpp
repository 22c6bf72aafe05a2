#include "export/random_cut.h"

#include <random>
#include <utility>
#include <vector>

namespace meshhier::exporting {
namespace {

/// A cut's nodes below `node`; each node stops the descent unless a draw is below `descend`.
void choose_nodes(const Tree& tree, NodeId node, std::uint64_t descend, std::mt19937_64& random,
                  std::vector<NodeId>& chosen) {
  const Tree::Children children = tree.children(node);
  if (children.count == 0 || random() >= descend) {
    chosen.push_back(node);
    return;
  }
  for (NodeId child : children.span())
    choose_nodes(tree, child, descend, random, chosen);
}

}  // namespace

Cut random_cut(const Tree& tree, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // A cut's chance to descend is drawn from [1/2, 1): cuts that stay coarse, cuts that reach the
  // partitions nearly everywhere, and all between. The root alone is a cut, but tells little.
  const std::uint64_t descend = random() | std::uint64_t{1} << 63;
  std::vector<NodeId> nodes;
  const Tree::Children children = tree.children(tree.root());
  if (children.count == 0)
    nodes.push_back(tree.root());
  for (NodeId child : children.span())
    choose_nodes(tree, child, descend, random, nodes);
  return {tree, std::move(nodes)};
}

}  // namespace meshhier::exporting
