#include "pipeline/simplify_stage.h"

#include "hierarchy/error.h"
#include "pipeline/parallel.h"
#include "pipeline/size_text.h"

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using cluster_simplify::ContractedTile;

/// A chunk whose triangles alone exceed what a stage may hold: a vertex with an absurd number of
/// triangles.
void check_fits(const Chunks& chunks, std::uint32_t chunk, const MemoryPlan& plan) {
  const std::uint64_t needed = chunks.triangle_bytes(chunk) * 4;
  if (needed > plan.work_bytes + plan.pool_bytes / 2) {
    throw Error(ErrorCode::budget, fmt::format("a part of the mesh has {} triangles on {} "
                                               "vertices; it needs a memory_budget larger by {}",
                                               chunks.triangle_bytes(chunk) / 12,
                                               chunks.map().size(chunk), exact_size_text(needed)));
  }
}

struct ChunkReport {
  std::size_t partitions = 0;
  std::uint64_t unreferenced_vertices = 0;
};

/// Splits a chunk and puts its partition tiles.
ChunkReport put_leaves(Chunks& chunks, std::uint32_t index, partition::Axis axis, Forest& forest) {
  const Tree& tree = forest.tree();
  const partition::ChunkMesh chunk = chunks.take(index);
  const std::vector<PartitionId> partition_of = partition::split_chunk(chunk, tree, axis);
  const partition::ChunkLeaves leaves =
      partition::build_leaves(chunk, partition_of, tree, chunks.map());
  forest.put_places(index, leaves.places);
  const std::uint32_t first = tree.partitions(chunk.node).begin;
  for (std::uint32_t p = 0; p < leaves.tiles.size(); ++p)
    forest.put_tile({tree.depth(), first + p}, leaves.tiles[p]);
  return {leaves.tiles.size(), leaves.unreferenced_count};
}

ContractedTile contract_children(Forest& forest, const Tree::Children& children,
                                 const SimplifyOptions& options) {
  const BuildTile first = forest.load(children.nodes[0]);
  forest.put_band(children.nodes[0], first);
  if (children.count == 1)
    return cluster_simplify::keep(first);
  const BuildTile second = forest.load(children.nodes[1]);
  forest.put_band(children.nodes[1], second);
  const BuildTile joined =
      cluster_simplify::join(first, children.nodes[0].index, second, children.nodes[1].index);
  const std::uint32_t target =
      cluster_simplify::contraction_target(joined.mesh.own_count, options.vertices);
  return cluster_simplify::apply(
      joined, cluster_simplify::contract(joined, target, options.attributes, options.contraction));
}

/// Makes a node's tile out of its children's, and their maps to it.
void make_tile(Forest& forest, NodeId node, const SimplifyOptions& options) {
  const Tree::Children children = forest.tree().children(node);
  const ContractedTile contracted = contract_children(forest, children, options);
  std::size_t begin = 0;
  for (const NodeId child : children.span()) {
    const std::size_t count = forest.own_count(child);
    forest.put_parent_map(child, std::span(contracted.parent_map).subspan(begin, count));
    begin += count;
  }
  forest.put_tile(node, contracted.tile);
  forest.facts(node).torn_count = contracted.fallbacks.torn;
  forest.facts(node).forced_count = contracted.fallbacks.without_care();
}

}  // namespace

std::uint64_t make_leaves(Chunks& chunks, Forest& forest, partition::Axis axis,
                          const MemoryPlan& plan, Progress& progress, const CancelToken& cancel) {
  const Tree& tree = forest.tree();
  progress.stage("leaves", tree.partition_count(), "partitions");
  std::uint64_t unreferenced = 0;
  ordered_for(
      chunks.count(), plan.chunks_in_flight, cancel,
      [&](std::size_t i) {
        const auto index = static_cast<std::uint32_t>(i);
        check_fits(chunks, index, plan);
        return put_leaves(chunks, index, axis, forest);
      },
      [&](std::size_t, const ChunkReport& report) {
        unreferenced += report.unreferenced_vertices;
        progress.advance(report.partitions);
      });
  return unreferenced;
}

void simplify(Forest& forest, const SimplifyOptions& options, const MemoryPlan& plan,
              Progress& progress, const CancelToken& cancel) {
  const Tree& tree = forest.tree();
  std::uint64_t total = 0;
  for (int l = 0; l < raw(tree.depth()); ++l)
    total += tree.node_count(static_cast<Level>(l));
  progress.stage("simplify", total, "tiles");
  for (int l = raw(tree.depth()) - 1; l >= 0; --l) {
    const auto level = static_cast<Level>(l);
    ordered_for(
        tree.node_count(level), plan.tiles_in_flight, cancel,
        [&](std::size_t i) {
          make_tile(forest, {level, static_cast<std::uint32_t>(i)}, options);
          return std::size_t{1};
        },
        [&](std::size_t, std::size_t tiles) { progress.advance(tiles); });
  }
}

}  // namespace meshhier::pipeline
