#include "export/cut_by_error.h"

#include <utility>
#include <vector>

namespace meshhier::exporting {

Cut coarsest_cut(const storage::HierarchyReader& reader,
                 const std::function<bool(const TileRecord&)>& is_fine_enough) {
  const Tree& tree = reader.tree();
  std::vector<NodeId> left{NodeId{}}, nodes;
  while (!left.empty()) {
    const NodeId node = left.back();
    left.pop_back();
    if (tree.is_partition(node) || tree.is_early(node) || is_fine_enough(reader.record(node))) {
      nodes.push_back(node);
      continue;
    }
    const Tree::Children children = tree.children(node);
    left.insert(left.end(), children.span().begin(), children.span().end());
  }
  return {tree, std::move(nodes)};
}

Cut cut_by_error(const storage::HierarchyReader& reader, LargestError largest) {
  return coarsest_cut(reader,
                      [&](const TileRecord& record) { return record.error <= largest.error; });
}

}  // namespace meshhier::exporting
