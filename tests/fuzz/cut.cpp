#include "hierarchy/cut.h"

#include "export/cut_file.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "support/memory_files.h"

#include <string>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

void check_cut(const Tree& tree, const Cut& cut) {
  std::uint32_t covered = 0;
  for (const NodeId node : cut.nodes()) {
    require(tree.contains(node) && !tree.is_early(node), "nodes have tiles");
    require(tree.partitions(node).begin == covered, "each partition is covered once");
    covered = tree.partitions(node).end;
  }
  require(covered == tree.partition_count(), "all partitions are covered");
}

void check_nodes(const std::vector<NodeId>& nodes) {
  std::string lines;
  for (const NodeId node : nodes)
    lines += to_text(node) + '\n';
  require(exporting::parse_nodes(lines, "again") == nodes, "what is written is read again");
}

}  // namespace

void cut(Bytes input) {
  Take take(input);
  const Tree tree = take_tree(take);
  const std::string text(text_of(take.rest()));
  std::vector<NodeId> nodes;
  const auto parse = [&] { nodes = exporting::parse_nodes(text, "nodes.txt"); };
  if (refusal({ErrorCode::usage}, "nodes.txt: ", parse).empty())
    check_nodes(nodes);
  MemoryFiles files;
  files.put("nodes.txt", text);
  refusal({ErrorCode::usage},
          "nodes.txt: ", [&] { check_cut(tree, exporting::read_cut(files, tree, "nodes.txt")); });
}

}  // namespace meshhier::tests::fuzz
