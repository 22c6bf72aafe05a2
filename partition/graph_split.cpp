#include "partition/graph_split.h"

#include "partition/bisect.h"
#include "partition/coarsen.h"

#include <algorithm>
#include <cassert>

namespace meshhier::partition {
namespace {

// The graph that is bisected has so many vertices a part. 32 make no line shorter.
constexpr std::uint32_t kVerticesPerPart = 16;

// A star takes three quarters of the vertices; where that would leave too few, pairs are matched.
constexpr std::uint32_t kStarShare = 4;

// So many times the coarse graph is coarsened by stars; by pairs from there on. All pairs would
// take a tenth longer, three times stars lose quality.
constexpr std::size_t kStarLevels = 2;

// Rounds of refinement on a coarse graph, and on the mesh itself. With three of each, mean
// compactness of the dragon's 128 partitions is 2.45 instead of 2.51, and splitting takes an eighth
// longer.
constexpr int kCoarseRounds = 2;
constexpr int kRounds = 1;

// Coarsening has stalled if less than this part of the vertices goes.
constexpr std::uint32_t kStalled = 20;

// Components are linked on the first level of fewer vertices, where it costs next to nothing.
constexpr std::uint32_t kLinked = 8192;

struct CoarseLevel {
  Graph graph;
  std::vector<std::uint32_t> cluster_of;  ///< of the next finer graph's vertices
};

std::vector<CoarseLevel> coarsen(const Graph& graph, std::uint32_t wanted) {
  std::vector<CoarseLevel> levels;
  const std::uint32_t most = std::max(1U, graph.size() / wanted * 3 / 2);
  bool linked = false;
  for (const Graph* finest = &graph; finest->size() > wanted;) {
    Clusters clusters = levels.size() < kStarLevels && finest->size() / kStarShare > wanted
                            ? star_clusters(*finest)
                            : matched_pairs(*finest, most);
    const bool stalled = finest->size() - clusters.count < finest->size() / kStalled;
    if (stalled && linked)
      break;
    Graph coarse = contract(*finest, clusters.of, clusters.count);
    levels.push_back({std::move(coarse), std::move(clusters.of)});
    finest = &levels.back().graph;
    if (!linked && (stalled || finest->size() < kLinked)) {
      link_components(levels.back().graph);
      linked = true;
    }
  }
  return levels;
}

/// Parts of a graph's vertices, and which of these have neighbours in other parts (not 0).
struct Partition {
  std::vector<std::uint32_t> part_of;
  std::vector<char> boundary;
};

/// The same on the next finer graph: only what stands for boundary vertices can be on a boundary.
Partition project(const Partition& coarse, std::span<const std::uint32_t> cluster_of) {
  Partition fine{std::vector<std::uint32_t>(cluster_of.size()),
                 std::vector<char>(cluster_of.size())};
  for (std::size_t v = 0; v < cluster_of.size(); ++v) {
    fine.part_of[v] = coarse.part_of[cluster_of[v]];
    fine.boundary[v] = coarse.boundary[cluster_of[v]];
  }
  return fine;
}

}  // namespace

std::vector<std::uint32_t> split_graph(const Graph& graph, std::span<const std::uint32_t> sizes,
                                       RefineCounts* counts) {
  assert(!sizes.empty() && sizes.size() <= kMostParts);
  if (sizes.size() == 1)
    return std::vector<std::uint32_t>(graph.size());
  RefineCounts done;
  const std::size_t wanted = std::min<std::size_t>(kVerticesPerPart * sizes.size(), graph.size());
  std::vector<CoarseLevel> levels = coarsen(graph, static_cast<std::uint32_t>(wanted));
  const Graph& coarsest = levels.empty() ? graph : levels.back().graph;
  Partition parts{bisect_recursively(coarsest, sizes, done), std::vector<char>(coarsest.size(), 1)};
  for (; !levels.empty(); levels.pop_back()) {
    const Graph& coarse = levels.back().graph;
    Refiner refiner(coarse, parts.part_of, sizes, parts.boundary);
    const std::int64_t heaviest = *std::max_element(coarse.weight.begin(), coarse.weight.end());
    refiner.refine_all(kCoarseRounds, {2 * heaviest, 2 * heaviest});
    done += refiner.counts();
    parts.boundary = refiner.boundary();
    parts = project(parts, levels.back().cluster_of);
  }
  Refiner refiner(graph, parts.part_of, sizes, parts.boundary);
  refiner.balance_exactly();
  refiner.refine_all(kRounds, {0, 2});  // one vertex ahead of its exchange
  done += refiner.counts();
  if (counts != nullptr)
    *counts += done;
  return std::move(parts.part_of);
}

}  // namespace meshhier::partition
