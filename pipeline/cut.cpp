#include "pipeline/cut.h"

#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::pipeline {
namespace {

std::string describe(PartitionRange range) {
  if (range.size() == 1)
    return fmt::format("partition {}", range.begin);
  return fmt::format("partitions {} to {}", range.begin, range.end - 1);
}

/// The nodes cover [0, end of the range before), then `next`.
void require_adjacent(NodeId before, std::uint32_t covered, NodeId next, PartitionRange range) {
  if (range.begin > covered) {
    throw Error(ErrorCode::usage, fmt::format("not a cut: no node covers {}",
                                              describe(PartitionRange{covered, range.begin})));
  }
  if (range.begin < covered) {
    throw Error(ErrorCode::usage, fmt::format("not a cut: nodes {} and {} both cover partition {}",
                                              to_text(before), to_text(next), range.begin));
  }
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos)
    return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size())
    return std::nullopt;
  return number;
}

NodeId parse_node(std::string_view text, const std::string& place) {
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto level = parse_number<std::uint8_t>(trimmed(text.substr(0, slash)));
    const auto index = parse_number<std::uint32_t>(trimmed(text.substr(slash + 1)));
    if (level && index)
      return {static_cast<Level>(*level), *index};
  }
  constexpr std::size_t kShown = 40;  // enough to recognise the entry; the file may be binary
  throw Error(ErrorCode::usage,
              fmt::format("{}: expected a node as level/index, such as 3/5; found \"{}\"", place,
                          plain_text(text, kShown)));
}

std::vector<NodeId> parse_json_nodes(std::string_view text, const std::string& name) {
  const auto shallow = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    return depth < 2;  // a list of strings needs no more; deeper values are dropped and then missed
  };
  const auto list = nlohmann::json::parse(text, shallow, /*allow_exceptions=*/false);
  if (!list.is_array()) {
    throw Error(ErrorCode::usage,
                name + ": expected a JSON array of strings such as [\"1/0\", \"2/2\"]");
  }
  std::vector<NodeId> nodes;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = fmt::format("{}: entry {}", name, i + 1);
    if (!list[i].is_string()) {
      throw Error(ErrorCode::usage,
                  place + ": expected a node as a string \"level/index\", such as \"3/5\"");
    }
    nodes.push_back(parse_node(trimmed(list[i].get_ref<const std::string&>()), place));
  }
  return nodes;
}

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

std::string to_text(NodeId node) {
  return fmt::format("{}/{}", raw(node.level), node.index);
}

void require_level(const Tree& tree, Level level) {
  if (level <= tree.depth())
    return;
  throw Error(ErrorCode::usage, fmt::format("there is no level {}: the levels are 0 to {}",
                                            raw(level), raw(tree.depth())));
}

void require_node(const Tree& tree, NodeId node) {
  if (tree.contains(node))
    return;
  if (node.level > tree.depth()) {
    throw Error(ErrorCode::usage, fmt::format("there is no node {}: the levels are 0 to {}",
                                              to_text(node), raw(tree.depth())));
  }
  throw Error(ErrorCode::usage,
              fmt::format("there is no node {}: the nodes of level {} are 0 to {}", to_text(node),
                          raw(node.level), tree.node_count(node.level) - 1));
}

Cut::Cut(const Tree& tree, std::vector<NodeId> nodes) : nodes_(std::move(nodes)) {
  for (NodeId& node : nodes_) {
    require_node(tree, node);
    node = tile_node(tree, node);
  }
  const auto first = [&](NodeId node) { return tree.partitions(node).begin; };
  std::sort(nodes_.begin(), nodes_.end(),
            [&](NodeId a, NodeId b) { return std::pair(first(a), a) < std::pair(first(b), b); });
  std::uint32_t covered = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const PartitionRange range = tree.partitions(nodes_[i]);
    require_adjacent(nodes_[i == 0 ? 0 : i - 1], covered, nodes_[i], range);
    first_partitions_.push_back(range.begin);
    covered = range.end;
  }
  if (covered < tree.partition_count()) {
    throw Error(ErrorCode::usage,
                fmt::format("not a cut: no node covers {}",
                            describe(PartitionRange{covered, tree.partition_count()})));
  }
}

Cut Cut::of_level(const Tree& tree, Level level) {
  assert(level <= tree.depth());
  std::vector<NodeId> nodes(tree.node_count(level));
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    nodes[i] = {level, i};
  return {tree, std::move(nodes)};
}

Cut Cut::random(const Tree& tree, std::uint64_t seed) {
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

std::size_t Cut::position_of(PartitionId partition) const {
  const auto after =
      std::upper_bound(first_partitions_.begin(), first_partitions_.end(), raw(partition));
  return static_cast<std::size_t>(after - first_partitions_.begin()) - 1;
}

std::vector<NodeId> parse_nodes(std::string_view text, const std::string& name) {
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start != std::string_view::npos && text[start] == '[')
    return parse_json_nodes(text, name);
  std::vector<NodeId> nodes;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view whole = text.substr(0, end);
    const std::string_view content = trimmed(whole.substr(0, whole.find('#')));
    if (!content.empty())
      nodes.push_back(parse_node(content, fmt::format("{}: line {}", name, line)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return nodes;
}

}  // namespace meshhier::pipeline
