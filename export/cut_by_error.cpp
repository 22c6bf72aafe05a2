#include "export/cut_by_error.h"

#include <utility>
#include <vector>

namespace meshhier::exporting {

Cut cut_by_error(const storage::HierarchyReader& reader, LargestError largest) {
  const Tree& tree = reader.tree();
  std::vector<NodeId> left{NodeId{}}, nodes;
  while (!left.empty()) {
    const NodeId node = left.back();
    left.pop_back();
    if (tree.is_partition(node) || tree.is_early(node) ||
        reader.record(node).error <= largest.error) {
      nodes.push_back(node);
      continue;
    }
    const Tree::Children children = tree.children(node);
    left.insert(left.end(), children.span().begin(), children.span().end());
  }
  return {tree, std::move(nodes)};
}

}  // namespace meshhier::exporting
