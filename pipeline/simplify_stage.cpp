#include "pipeline/simplify_stage.h"

#include "cluster_simplify/contraction.h"
#include "cluster_simplify/seam_strip.h"
#include "cluster_simplify/wedges.h"
#include "execution/allocator.h"
#include "execution/parallel.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/tiles/bound_chain.h"
#include "shading/own_normals.h"
#include "storage/format/work_tile.h"

#include <algorithm>
#include <utility>

namespace meshhier::pipeline {
namespace {

using cluster_simplify::ContractedTile;

/// Returns how far a simplified tile's surface went when its level was made. Requires that the
/// level is complete.
StepDeviation measure_step(const Forest& forest, NodeId node, const LoadedTile& loaded) {
  const TileMesh& mesh = loaded.tile.mesh;
  const cluster_simplify::SeamStripOf own{node.index, forest.seam_strip(node)};
  StepDeviation step;
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
  // A piece that is drawn no more is near the surface that was drawn beside it, which may have
  // moved at the seam, too.
  if (seam_strip.lost > 0)
    step.certain = std::max(step.certain, double{seam_strip.lost} + seam);
  step.mean_square = seam_strip.mean_square;
  return step;
}

/// Returns the part of a map for the places [begin, begin + count).
WedgeMap part_of(const WedgeMap& map, std::size_t begin, std::size_t count) {
  const auto at = [&](std::size_t place) {
    return std::lower_bound(map.places.begin(), map.places.end(), place) - map.places.begin();
  };
  const std::ptrdiff_t first = at(begin);
  const std::ptrdiff_t end = at(begin + count);
  const auto low = static_cast<std::ptrdiff_t>(begin);
  const auto high = static_cast<std::ptrdiff_t>(begin + count);
  WedgeMap part;
  part.firsts.assign(map.firsts.begin() + low, map.firsts.begin() + high);
  part.copies.assign(map.copies.begin() + first, map.copies.begin() + end);
  part.places.assign(map.places.begin() + first, map.places.begin() + end);
  for (std::uint32_t& place : part.places)
    place -= static_cast<std::uint32_t>(begin);
  return part;
}

/// Makes tiles of one level out of those of the level below.
class Simplifier {
 public:
  Simplifier(Forest& forest, const AttributeLayout& attributes, const StageContext& context)
      : forest_(forest), rules_(attributes), context_(context) {}

  /// Loads a tile of the level below, or the root. All of its level is known now, its neighbours'
  /// places too: so its step is measured, unless it is a partition, and its normals are made.
  BuildTile load(NodeId node, std::vector<IndexedStep>& steps) {
    LoadedTile loaded = forest_.load_with_mapped(node);
    const TileMesh& mesh = loaded.tile.mesh;
    if (!forest_.tree().is_partition(node))
      steps.emplace_back(node.index, measure_step(forest_, node, loaded));
    if (forest_.has_normals(node))
      forest_.put_normals(node, shading::shade(mesh), mesh);
    if (forest_.tree().is_partition(node))
      drop_texcoords(loaded.tile.mesh);
    return std::move(loaded.tile);
  }

  /// Makes a node's tile out of its children's, and their maps to it. Returns their steps.
  std::vector<IndexedStep> make_tile(NodeId node) {
    const Tree::Children children = forest_.tree().children(node);
    std::vector<IndexedStep> steps;
    const BuildTile joined = load_joined(children, steps);
    const ContractedTile contracted = contract(joined, node);
    std::size_t begin = 0;
    for (const NodeId child : children.span()) {
      const std::size_t count = forest_.own_count(child);
      forest_.put_parent_map(child, std::span(contracted.parent_map).subspan(begin, count));
      if (!contracted.wedge_map.empty())
        forest_.put_wedge_map(child, part_of(contracted.wedge_map, begin, count));
      begin += count;
    }
    forest_.put_tile(node, contracted.tile);
    forest_.put_seam_strip(node, cluster_simplify::make_seam_strip(joined, contracted));
    forest_.put_fallbacks(node, {contracted.fallbacks.torn, contracted.fallbacks.without_care()});
    return steps;
  }

 private:
  /// Tiles above the partitions get coordinates of their own, if those are a texture's.
  void drop_texcoords(TileMesh& mesh) const {
    mesh.vertices.keep_channels(static_cast<int>(rules_.channels()));
    mesh.copies.vertices.keep_channels(static_cast<int>(rules_.channels()));
  }

  BuildTile load_joined(const Tree::Children& children, std::vector<IndexedStep>& steps) {
    BuildTile first = load(children.nodes[0], steps);
    if (children.count == 1)
      return first;
    return cluster_simplify::join(first, children.nodes[0].index, load(children.nodes[1], steps),
                                  children.nodes[1].index);
  }

  ContractedTile contract(const BuildTile& joined, NodeId node) const {
    if (forest_.tree().is_early(node))
      return cluster_simplify::keep(joined);
    const config::SimplifyConfig& how = context_.config.simplify;
    const std::uint32_t target =
        context_.plan.target_vertex_counts.target(node.level, joined.mesh.own_count);
    cluster_simplify::Contraction contraction = cluster_simplify::contract(
        joined, target, rules_, {how.method, how.representative, how.cost});
    cluster_simplify::ContractedWedges wedges;
    if (!joined.mesh.copies.empty() || rules_.values().has_objects())
      wedges = cluster_simplify::contract_wedges(joined, contraction, rules_, {});
    return cluster_simplify::apply(joined, std::move(contraction), std::move(wedges));
  }

  Forest& forest_;
  AttributeRules rules_;
  const StageContext& context_;
};

/// The nodes of a part of a level whose tiles are still to be made.
std::vector<NodeId> tiles_left(const Tree& tree, Level level, const Share& share,
                               const BuildJournal& journal) {
  const std::uint32_t count = tree.node_count(level);
  std::vector<NodeId> left;
  for (std::uint64_t i = share.begin(count); i < share.end(count); ++i) {
    const NodeId node{level, static_cast<std::uint32_t>(i)};
    if (!journal.has_tile(node))
      left.push_back(node);
  }
  return left;
}

/// Returns a step for each of so many tiles.
std::vector<StepDeviation> in_order(std::vector<IndexedStep> steps, std::uint32_t count) {
  std::vector<StepDeviation> all(count);
  for (IndexedStep& step : steps)
    all.at(step.first) = std::move(step.second);
  return all;
}

void note_root(Simplifier& simplifier, BuildJournal& journal, const Tree& tree) {
  if (journal.has_root())
    return;
  std::vector<IndexedStep> steps;
  simplifier.load(tree.root(), steps);
  journal.note_root(steps);
}

}  // namespace

void simplify(Forest& forest, BuildJournal& journal, const AttributeLayout& attributes,
              const LevelRange& levels, const StageContext& context) {
  const Tree& tree = context.tree();
  const int end = std::min(levels.end, int{raw(tree.depth())});
  std::vector<std::vector<NodeId>> left;  // from levels.top on
  std::uint64_t total = 0;
  for (int l = levels.top; l < end; ++l) {
    left.push_back(tiles_left(tree, static_cast<Level>(l), levels.share, journal));
    total += left.back().size();
  }
  context.progress.stage("simplify", total, "tiles");
  Simplifier simplifier(forest, attributes, context);
  for (int l = end - 1; l >= levels.top; --l) {
    const std::vector<NodeId>& nodes = left[l - levels.top];
    TileRoom::Heaviest heaviest{heaviest_contracted(forest, nodes)};
    // Only a tile that may be refused asks for the levels above: the message names a budget for
    // all.
    if (heaviest.now > context.memory().work_bytes) {
      heaviest.ahead = heaviest_contracted_above(forest, static_cast<Level>(l + 1),
                                                 static_cast<Level>(levels.top), context.plan.job);
    }
    const TileRoom room = room_for(forest, context.memory(), heaviest);
    execution::ordered_for(
        nodes.size(), room.in_flight(), context.cancel,
        [&](std::size_t i) { return simplifier.make_tile(nodes[i]); },
        [&](std::size_t i, const std::vector<IndexedStep>& steps) {
          journal.note_tile(nodes[i], steps);
          context.progress.advance(1);
          if ((i + 1) % room.items_between_releases() == 0)
            execution::release_free_memory(context.memory().budget_bytes);
        });
  }
  if (levels.top == 0)
    note_root(simplifier, journal, tree);
}

TileErrors add_up(BuildJournal& journal, const Tree& tree, double diagonal) {
  BoundChain chain(tree, diagonal);
  for (int l = raw(tree.depth()) - 1; l >= 0; --l) {
    const auto level = static_cast<Level>(l);
    chain.add(level, in_order(journal.take_steps(level), tree.node_count(level)));
  }
  return chain.errors();
}

StageMemory simplify_memory(const JobSize& job) {
  // Two children are read, joined, contracted and encoded: 16 copies of a vertex's 20 bytes and 8
  // of a triangle's 12; edges, queue and quadrics while they collapse.
  const std::uint64_t vertices = std::min(2 * std::uint64_t{job.largest_tile}, job.place_count);
  // Copies and the wedges of triangles are there as often, and the wedge that each becomes.
  const std::uint64_t copies =
      job.has_copies() ? job.part_copies(vertices) * (5 * (job.vertex_bytes() + 4) + 60) +
                             job.part_triangles(vertices) * 48
                       : 0;
  const std::uint64_t tile =
      vertices * (6 * (job.vertex_bytes() + 8) + 260) + job.part_triangles(vertices) * 80 + copies;
  return {tile, 2 * job.threads, tile, 2 * job.threads * tile, &MemoryPlan::tiles_in_flight};
}

StageTimes simplify_time(const JobSize& job, const TilePopulation& tiles) {
  // Seconds for each vertex that is joined to be contracted, with its two triangles.
  constexpr double kCollapsed = 1.12e-6;
  constexpr double kClustered = 0.62e-6;
  constexpr double kShaded = 0.1e-6;
  const double vertices = tiles.partitions.vertices + tiles.simplified.vertices;
  return {{"simplify", "tiles", static_cast<std::uint64_t>(tiles.simplified.count),
           vertices *
               ((job.clustered ? kClustered : kCollapsed) + (job.computes_normals ? kShaded : 0))}};
}

DiskVolumes simplify_disk(const JobSize& job, const TilePopulation& tiles,
                          const MemoryPlan& /*memory*/) {
  // A tile of far fewer vertices than half of its children's (simplify.vertices by level) has long
  // seams with what is one level finer: foreign corners and seam strips. With steps from 400 to 20
  // and from 4,000 to 4, temporary files are so predicted 2 to 14 % too large, as with equal tiles
  // of these sizes; without it a step from 4,000 to 4 was 4 % too small.
  constexpr double kSteepBytes = 48;
  constexpr double kParent = sizeof(std::uint16_t);
  double bytes = storage::expected_work_tile_bytes(tiles.simplified, job.vertex_bytes()) +
                 (tiles.partitions.vertices + tiles.simplified.vertices) * kParent;
  if (job.computes_normals)
    bytes += storage::expected_shading_bytes(tiles.partitions) +
             storage::expected_shading_bytes(tiles.simplified);
  bytes += (tiles.counted ? storage::long_seam_strip_bytes(tiles.simplified)
                          : storage::expected_seam_strip_bytes(tiles.simplified)) +
           tiles.steep_boundary * kSteepBytes;
  return {{bytes, DiskMoment::simplify, DiskMoment::simplify}};
}

}  // namespace meshhier::pipeline
