#include "partition/chunk.h"

#include "partition/graph_split.h"
#include "partition/split_plane.h"

#include <algorithm>
#include <numeric>

namespace meshhier::partition {
namespace {

// A surface is split into the nodes so many levels below in one go, and these again; or one level
// more if that is all.
constexpr int kGraphLevels = 5;

/// Splits by planes at exact medians.
class PlaneSplitter {
 public:
  PlaneSplitter(const ChunkMesh& chunk, const Tree& tree, Axis axis)
      : positions_(chunk.vertices.positions),
        tree_(tree),
        axis_(axis),
        partition_of_(positions_.size()) {}

  std::vector<PartitionId> run(NodeId node) {
    std::vector<std::uint32_t> vertices(positions_.size());
    std::iota(vertices.begin(), vertices.end(), 0U);
    split(node, vertices);
    return std::move(partition_of_);
  }

 private:
  void split(NodeId node, std::span<std::uint32_t> vertices) {
    if (tree_.is_partition(node)) {
      for (const std::uint32_t v : vertices)
        partition_of_[v] = static_cast<PartitionId>(node.index);
      return;
    }
    const Tree::Children children = tree_.children(node);
    if (children.count == 1) {
      split(children.nodes[0], vertices);
      return;
    }
    const std::size_t left_count = tree_.ranks(children.nodes[0]).size();
    split_vertices(vertices, left_count, choose(vertices, left_count));
    split(children.nodes[0], vertices.first(left_count));
    split(children.nodes[1], vertices.subspan(left_count));
  }

  Vec3d choose(std::span<const std::uint32_t> vertices, std::size_t left_count) const {
    std::vector<Vec3f> points(vertices.size());
    std::transform(vertices.begin(), vertices.end(), points.begin(),
                   [this](std::uint32_t v) { return positions_[v]; });
    const double fraction = static_cast<double>(left_count) / static_cast<double>(vertices.size());
    return thinnest_direction(points, fraction, candidate_directions(points, axis_));
  }

  /// Puts the `left_count` lowest vertices first, each side ascending by number.
  void split_vertices(std::span<std::uint32_t> vertices, std::size_t left_count,
                      Vec3d direction) const {
    const auto key = [&](std::uint32_t v) { return key_along(direction, positions_[v], v); };
    std::vector<SplitKey> keys(vertices.size());
    std::transform(vertices.begin(), vertices.end(), keys.begin(), key);
    std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(left_count),
                     keys.end());
    const SplitKey first_right = keys[left_count];
    std::stable_partition(vertices.begin(), vertices.end(),
                          [&](std::uint32_t v) { return key(v) < first_right; });
  }

  std::span<const Vec3f> positions_;
  const Tree& tree_;
  Axis axis_;
  std::vector<PartitionId> partition_of_;
};

/// Splits along the shortest lines on the surface.
class SurfaceSplitter {
 public:
  SurfaceSplitter(const Tree& tree, std::size_t vertex_count)
      : tree_(tree), partition_of_(vertex_count) {}

  std::vector<PartitionId> run(NodeId node, const Surface& surface) {
    std::vector<std::uint32_t> vertices(partition_of_.size());
    std::iota(vertices.begin(), vertices.end(), 0U);
    split(node, surface, vertices);
    return std::move(partition_of_);
  }

 private:
  /// `vertices`: of the chunk, one per vertex of `surface`.
  void split(NodeId node, const Surface& surface, std::span<const std::uint32_t> vertices) {
    const std::vector<NodeId> nodes = nodes_below(node);
    std::vector<std::uint32_t> sizes;
    for (const NodeId& below : nodes)
      sizes.push_back(static_cast<std::uint32_t>(tree_.ranks(below).size()));
    const std::vector<std::uint32_t> part_of = split_surface(surface, sizes);
    if (tree_.is_partition(nodes[0])) {
      for (std::size_t i = 0; i < vertices.size(); ++i)
        partition_of_[vertices[i]] = static_cast<PartitionId>(nodes[part_of[i]].index);
      return;
    }
    std::vector<std::vector<std::uint32_t>> members(nodes.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
      members[part_of[i]].push_back(vertices[i]);
    const std::vector<Surface> parts =
        separate(surface, part_of, static_cast<std::uint32_t>(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i)
      split(nodes[i], parts[i], members[i]);
  }

  /// The nodes a graph is split into at once.
  std::vector<NodeId> nodes_below(NodeId node) const {
    const int left = raw(tree_.depth()) - raw(node.level);
    const int levels = left <= kGraphLevels + 1 ? left : kGraphLevels;
    static_assert(1U << (kGraphLevels + 1) <= kMostParts);
    std::vector<NodeId> nodes{node};
    for (int i = 0; i < levels; ++i) {
      std::vector<NodeId> children;
      for (const NodeId& parent : nodes) {
        const Tree::Children below = tree_.children(parent);
        children.insert(children.end(), below.span().begin(), below.span().end());
      }
      nodes = std::move(children);
    }
    return nodes;
  }

  const Tree& tree_;
  std::vector<PartitionId> partition_of_;
};

}  // namespace

ChunkMap::ChunkMap(const Tree& tree, Level chunks) {
  for (std::uint32_t i = 0; i < tree.node_count(chunks); ++i)
    starts_.push_back(tree.ranks({chunks, i}).begin);
  starts_.push_back(tree.vertex_count());
}

std::uint32_t ChunkMap::chunk_of(std::uint32_t rank) const {
  // Chunks are nearly of one size: a guess by proportion is off by a few at most.
  auto chunk = static_cast<std::uint32_t>(std::uint64_t{rank} * count() / starts_.back());
  while (rank < starts_[chunk])
    --chunk;
  while (rank >= starts_[chunk + 1])
    ++chunk;
  return chunk;
}

std::vector<PartitionId> split_chunk(const ChunkMesh& chunk, const Tree& tree, Axis axis) {
  if (axis == Axis::compactness) {
    const auto first = static_cast<std::uint32_t>(tree.ranks(chunk.node).begin);
    // Triangles cut off by the chunk's own border matter to no split.
    const Surface surface = make_surface(chunk.vertices.positions, chunk.triangles, first);
    if (!surface.triangles.empty())
      return SurfaceSplitter(tree, surface.size()).run(chunk.node, surface);
  }
  return PlaneSplitter(chunk, tree, axis).run(chunk.node);
}

}  // namespace meshhier::partition
