#include "partition/graph_split.h"

#include "partition/bisect.h"
#include "partition/coarsen.h"

#include <algorithm>
#include <cassert>
#include <numeric>

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
constexpr int kExchangeRounds = 1;

// Coarsening has stalled if less than this part of the vertices goes.
constexpr std::uint32_t kStalled = 20;

// Components are linked on the first level of fewer vertices, where it costs next to nothing.
constexpr std::uint32_t kLinked = 8192;

struct CoarseLevel {
  Graph graph;
  std::vector<std::uint32_t> cluster_of;  ///< of the next finer graph's vertices
};

/// `star_levels`: so many times stars are taken. `linked`: the graph has no components to link.
std::vector<CoarseLevel> coarsen(const Graph& graph, std::uint32_t wanted, std::size_t star_levels,
                                 bool linked) {
  std::vector<CoarseLevel> levels;
  const std::uint64_t weight =
      std::accumulate(graph.weight.begin(), graph.weight.end(), std::uint64_t{0});
  const auto most = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, weight / wanted * 3 / 2));
  for (const Graph* finest = &graph; finest->size() > wanted;) {
    Clusters clusters = levels.size() < star_levels && finest->size() / kStarShare > wanted
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

/// Refines parts of a coarse graph, whose vertices need not fit their sizes exactly.
void refine_coarsely(const Graph& graph, std::span<const std::uint32_t> sizes, Partition& parts,
                     RefineCounts& done) {
  Refiner refiner(graph, parts.part_of, sizes, parts.boundary);
  const std::int64_t heaviest = *std::max_element(graph.weight.begin(), graph.weight.end());
  refiner.refine_all(kCoarseRounds, {2 * heaviest, 2 * heaviest});
  done += refiner.counts();
  parts.boundary = refiner.boundary();
}

/// Makes sizes exact, then refines; false if that takes vertices beyond `reach`.
bool refine_exactly(const Graph& graph, std::span<const std::uint32_t> sizes, Reach reach,
                    std::span<std::uint32_t> part_of, std::span<const char> look_at,
                    RefineCounts& done) {
  Refiner refiner(graph, part_of, sizes, look_at);
  const bool exact = refiner.balance_exactly(reach);
  if (exact)
    refiner.refine_all(kExchangeRounds, {0, 2});  // one vertex ahead of its exchange
  done += refiner.counts();
  return exact;
}

/// Parts refined on graphs coarser than this one.
Partition split_coarsely(const Graph& graph, std::span<const std::uint32_t> sizes,
                         std::size_t star_levels, bool linked, RefineCounts& done) {
  const std::size_t wanted = std::min<std::size_t>(kVerticesPerPart * sizes.size(), graph.size());
  std::vector<CoarseLevel> levels =
      coarsen(graph, static_cast<std::uint32_t>(wanted), star_levels, linked);
  const Graph& coarsest = levels.empty() ? graph : levels.back().graph;
  Partition parts{bisect_recursively(coarsest, sizes, done), std::vector<char>(coarsest.size(), 1)};
  for (; !levels.empty(); levels.pop_back()) {
    refine_coarsely(levels.back().graph, sizes, parts, done);
    parts = project(parts, levels.back().cluster_of);
  }
  return parts;
}

/// Splits clusters of a surface's vertices: parts of the surface, near their sizes.
Partition split_clusters(const Surface& surface, const Clusters& clusters,
                         std::span<const std::uint32_t> sizes, RefineCounts& done) {
  Graph graph = surface_graph(surface, clusters.of, clusters.count);
  const bool linked = graph.size() < kLinked;
  if (linked)
    link_components(graph);
  Partition parts = split_coarsely(graph, sizes, kStarLevels - 1, linked, done);
  refine_coarsely(graph, sizes, parts, done);
  return project(parts, clusters.of);
}

/// Refines parts of a surface in the graph of its boundary vertices. False if sizes cannot be made
/// exact within `reach`.
bool refine_boundary(const Surface& surface, std::span<const std::uint32_t> sizes, Reach reach,
                     Partition& parts, RefineCounts& done) {
  std::vector<std::uint32_t> group_of(surface.size()), part_of;
  for (std::uint32_t v = 0; v < surface.size(); ++v) {
    if (parts.boundary[v] == 0)
      continue;
    group_of[v] = static_cast<std::uint32_t>(part_of.size());
    part_of.push_back(parts.part_of[v]);
  }
  const auto movable = static_cast<std::uint32_t>(part_of.size());
  for (std::uint32_t v = 0; v < surface.size(); ++v) {
    if (parts.boundary[v] == 0)
      group_of[v] = movable + parts.part_of[v];
  }
  for (std::uint32_t part = 0; part < sizes.size(); ++part)
    part_of.push_back(part);
  const Graph graph = surface_graph(surface, group_of, static_cast<std::uint32_t>(part_of.size()));
  if (!refine_exactly(graph, sizes, reach, part_of, std::vector<char>(movable, 1), done))
    return false;
  for (std::uint32_t v = 0; v < surface.size(); ++v)
    parts.part_of[v] = part_of[group_of[v]];
  return true;
}

}  // namespace

std::vector<std::uint32_t> split_graph(const Graph& graph, std::span<const std::uint32_t> sizes,
                                       RefineCounts* counts) {
  assert(!sizes.empty() && sizes.size() <= kMostParts);
  if (sizes.size() == 1)
    return std::vector<std::uint32_t>(graph.size());
  RefineCounts done;
  Partition parts = split_coarsely(graph, sizes, kStarLevels, false, done);
  refine_exactly(graph, sizes, Reach::anywhere, parts.part_of, parts.boundary, done);
  if (counts != nullptr)
    *counts += done;
  return std::move(parts.part_of);
}

std::vector<std::uint32_t> split_surface(const Surface& surface,
                                         std::span<const std::uint32_t> sizes,
                                         RefineCounts* counts) {
  if (sizes.size() == 1)
    return std::vector<std::uint32_t>(surface.size());
  if (surface.size() / kStarShare <= kVerticesPerPart * sizes.size())
    return split_graph(surface_graph(surface), sizes, counts);
  RefineCounts done;
  Partition parts = split_clusters(surface, star_clusters(surface), sizes, done);
  if (!refine_boundary(surface, sizes, Reach::neighbours, parts, done)) {
    std::fill(parts.boundary.begin(), parts.boundary.end(), 1);
    refine_boundary(surface, sizes, Reach::anywhere, parts, done);
  }
  if (counts != nullptr)
    *counts += done;
  return std::move(parts.part_of);
}

}  // namespace meshhier::partition
