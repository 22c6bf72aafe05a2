#include "pipeline/simplify_stage.h"

#include "cluster_simplify/seam_strip.h"
#include "execution/allocator.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "hierarchy/error.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/tiles/bound_chain.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using cluster_simplify::ContractedTile;

// What chunks leave behind between the blobs that stay adds up over thousands of them, and so do
// the places of spooled blocks, too small for the tiles they turn into: some 3 MiB a chunk.
constexpr std::size_t kChunksBetweenReleases = 8;

/// A chunk whose triangles alone exceed what a stage may hold: a vertex with an absurd number of
/// triangles.
void check_fits(const Chunks& chunks, std::uint32_t chunk, const MemoryPlan& plan) {
  const std::uint64_t needed = chunks.triangle_bytes(chunk) * 4;
  if (needed > plan.work_bytes + plan.pool_bytes / 2) {
    throw Error(ErrorCode::budget,
                fmt::format("a part of the mesh has {} triangles on {} "
                            "vertices; it needs a memory_budget larger by {}",
                            chunks.triangle_bytes(chunk) / 12, chunks.map().size(chunk),
                            execution::exact_size_text(needed)));
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

/// How far a simplified tile's surface went when its level was made, now that the level is
/// complete.
Step measure_step(const Forest& forest, NodeId node, const LoadedTile& loaded) {
  const TileMesh& mesh = loaded.tile.mesh;
  const cluster_simplify::SeamStripOf own{node.index, forest.seam_strip(node)};
  Step step;
  const auto add_foreign = [&](const SeamStrip& of) {
    for (const FinerGhost& corner : of.foreign)
      step.finer_neighbours.add(corner.ref.tile);
  };
  add_foreign(own.seam_strip);
  const auto seam_strip_of_neighbour = [&](std::uint32_t tile) {
    SeamStrip seam_strip = forest.seam_strip({node.level, tile});
    add_foreign(seam_strip);
    const Tree::Children children = forest.tree().children({node.level, tile});
    for (const NodeId child : children.span())
      step.finer_neighbours.add(child.index);
    return seam_strip;
  };
  const double seam =
      cluster_simplify::seam_gap({mesh, own, loaded.mapped, seam_strip_of_neighbour});
  step.finer_neighbours.settle();
  const SeamStrip& seam_strip = own.seam_strip;
  step.certain = std::max(double{seam_strip.interior_deviation}, seam);
  if (seam_strip.lost > 0)
    step.certain = std::max(step.certain, double{seam_strip.lost} + seam);
  step.mean_square = seam_strip.weight_sum > 0 ? seam_strip.squared_sum / seam_strip.weight_sum : 0;
  return step;
}

/// Makes the levels one by one, finest first; a level's steps are measured while the next is made
/// of it.
class Simplifier {
 public:
  Simplifier(Forest& forest, const SimplifyOptions& options) : forest_(forest), options_(options) {}

  /// `known`: steps of the level that need not be measured again.
  void begin(Level level, std::vector<IndexedStep> known) {
    steps_.clear();
    steps_.resize(level < forest_.tree().depth() ? forest_.tree().node_count(level) : 0);
    for (IndexedStep& step : known)
      steps_.at(step.first) = std::move(step.second);
  }
  /// Of the level that begin() named, once all tiles above it are made.
  const std::vector<Step>& steps() const { return steps_; }
  /// Of the node's children, as far as they are simplified tiles.
  std::vector<IndexedStep> steps_below(NodeId node) const {
    std::vector<IndexedStep> steps;
    const Tree::Children children = forest_.tree().children(node);
    for (const NodeId child : children.span()) {
      if (!forest_.tree().is_partition(child))
        steps.emplace_back(child.index, steps_[child.index]);
    }
    return steps;
  }

  /// Loads a tile of the level that begin() named.
  BuildTile load(NodeId node) {
    LoadedTile loaded = forest_.load_with_mapped(node);
    if (!forest_.tree().is_partition(node))
      steps_[node.index] = measure_step(forest_, node, loaded);
    return std::move(loaded.tile);
  }

  /// Makes a node's tile out of its children's, and their maps to it.
  void make_tile(NodeId node) {
    const Tree::Children children = forest_.tree().children(node);
    const BuildTile joined = load_joined(children);
    const ContractedTile contracted = contract(joined, node);
    std::size_t begin = 0;
    for (const NodeId child : children.span()) {
      const std::size_t count = forest_.own_count(child);
      forest_.put_parent_map(child, std::span(contracted.parent_map).subspan(begin, count));
      begin += count;
    }
    forest_.put_tile(node, contracted.tile);
    forest_.put_seam_strip(node, cluster_simplify::make_seam_strip(joined, contracted));
    forest_.facts(node).torn_count = contracted.fallbacks.torn;
    forest_.facts(node).forced_count = contracted.fallbacks.without_care();
  }

 private:
  BuildTile load_joined(const Tree::Children& children) {
    BuildTile first = load(children.nodes[0]);
    if (children.count == 1)
      return first;
    return cluster_simplify::join(first, children.nodes[0].index, load(children.nodes[1]),
                                  children.nodes[1].index);
  }

  ContractedTile contract(const BuildTile& joined, NodeId node) const {
    if (forest_.tree().is_early(node))
      return cluster_simplify::keep(joined);
    const std::uint32_t target = options_.vertices.target(node.level, joined.mesh.own_count);
    return cluster_simplify::apply(
        joined,
        cluster_simplify::contract(joined, target, options_.attributes, options_.contraction));
  }

  Forest& forest_;
  const SimplifyOptions& options_;
  std::vector<Step> steps_;
};

/// Those of [0, count) that are not done.
template <class IsDone>
std::vector<std::uint32_t> left_to_do(std::uint32_t count, const IsDone& is_done) {
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!is_done(i))
      left.push_back(i);
  }
  return left;
}

}  // namespace

std::uint64_t make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal,
                          partition::Axis axis, const MemoryPlan& plan,
                          execution::Progress& progress, const execution::CancelToken& cancel) {
  const Tree& tree = forest.tree();
  const std::vector<std::uint32_t> left =
      left_to_do(chunks.count(), [&](std::uint32_t chunk) { return journal.has_leaves(chunk); });
  std::uint64_t partitions = 0;
  for (const std::uint32_t chunk : left)
    partitions += tree.partitions({chunks.level(), chunk}).size();
  progress.stage("leaves", partitions, "partitions");
  std::uint64_t unreferenced = journal.unreferenced_vertices();
  execution::ordered_for(
      left.size(), plan.chunks_in_flight, cancel,
      [&](std::size_t i) {
        check_fits(chunks, left[i], plan);
        return put_leaves(chunks, left[i], axis, forest);
      },
      [&](std::size_t i, const ChunkReport& report) {
        journal.note_leaves(left[i], report.unreferenced_vertices);
        unreferenced += report.unreferenced_vertices;
        progress.advance(report.partitions);
        if (i % kChunksBetweenReleases == kChunksBetweenReleases - 1)
          execution::release_free_memory();
      });
  return unreferenced;
}

void simplify(Forest& forest, BuildJournal& journal, const SimplifyOptions& options,
              const MemoryPlan& plan, execution::Progress& progress,
              const execution::CancelToken& cancel) {
  const Tree& tree = forest.tree();
  std::vector<std::vector<std::uint32_t>> left;
  std::uint64_t total = 0;
  for (int l = 0; l < raw(tree.depth()); ++l) {
    const auto level = static_cast<Level>(l);
    left.push_back(left_to_do(tree.node_count(level), [&](std::uint32_t index) {
      return journal.has_tile({level, index});
    }));
    total += left.back().size();
  }
  progress.stage("simplify", total, "tiles");
  Simplifier simplifier(forest, options);
  BoundChain chain(forest, options.diagonal);
  simplifier.begin(tree.depth(), {});
  for (int l = raw(tree.depth()) - 1; l >= 0; --l) {
    const auto level = static_cast<Level>(l);
    const TileRoom room = room_for(forest, plan, heaviest_contracted(forest, level));
    execution::ordered_for(
        left[l].size(), room.in_flight(), cancel,
        [&](std::size_t i) {
          const NodeId node{level, left[l][i]};
          simplifier.make_tile(node);
          return node;
        },
        [&](std::size_t i, NodeId node) {
          journal.note_tile(node, simplifier.steps_below(node));
          progress.advance(1);
          if ((i + 1) % room.items_between_releases() == 0)
            execution::release_free_memory();
        });
    if (!simplifier.steps().empty())
      chain.add(finer(level), simplifier.steps());
    simplifier.begin(level, journal.take_steps(level));
  }
  if (tree.depth() > Level{0}) {
    simplifier.load({Level{0}, 0});
    chain.add(Level{0}, simplifier.steps());
  }
}

}  // namespace meshhier::pipeline
