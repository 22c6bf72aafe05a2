// Strong ids of the hierarchy: mixing two of them does not compile.
#pragma once

#include <compare>
#include <cstdint>
#include <type_traits>

namespace meshhier {

/// A vertex in the order of the input file, in [0, N).
enum class VertexId : std::uint32_t {};

/// A leaf of the kd-tree, in [0, P).
enum class PartitionId : std::uint32_t {};

/// Depth in the tree: 0 is the root, Tree::depth() the level of all partitions.
enum class Level : std::uint8_t {};

/// A vertex of one tile: its own vertices first, its ghosts after them.
enum class TileVertex : std::uint32_t {};

template <class Id>
requires std::is_enum_v<Id>
constexpr std::underlying_type_t<Id> raw(Id id) {
  return static_cast<std::underlying_type_t<Id>>(id);
}

constexpr Level finer(Level level) {
  return static_cast<Level>(raw(level) + 1);
}
constexpr Level coarser(Level level) {
  return static_cast<Level>(raw(level) - 1);
}

/// A node of the tree. Below the last level `index` counts the nodes of a level from left to right,
/// 0 to 2^level - 1; on the last level it is the number of the partition.
struct NodeId {
  Level level{};
  std::uint32_t index = 0;
  friend constexpr auto operator<=>(const NodeId&, const NodeId&) = default;
};

}  // namespace meshhier
