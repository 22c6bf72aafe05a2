#include "pipeline/plan/tile_population.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace meshhier::pipeline {
namespace {

using storage::TileSums;

// These were measured as kBoundaryShare. There are, per vertex of the boundary, 1.0 to 1.2 ghosts,
// 1.0 to 1.1 triangles that a neighbour has as well, and 1.8 foreign corners of a fresh simplified
// tile, which are one level finer.
constexpr double kGhosts = 1.1;
constexpr double kSharedTriangles = 1.05;
constexpr double kFreshForeign = 1.8;

// Triangles a vertex after clustering, over those before: 1.1 to 1.8, more on coarser levels; the
// other methods keep the input's ratio.
constexpr double kClusteredTriangles = 1.35;

/// Nodes of one level that stand over equally many partitions.
struct Nodes {
  double count = 0;
  double vertices = 0;  ///< each one's tile has
  double joined = 0;    ///< vertices of its children together; partitions: none
  bool early = false;   ///< has its partition's tile
};
using LevelNodes = std::map<std::uint32_t, Nodes>;  // by partitions: never more than two kinds

double triangles_per_vertex(const JobSize& job) {
  return static_cast<double>(job.face_count) / static_cast<double>(job.place_count);
}

/// Returns the triangles a vertex on simplified levels, over those of the input.
double simplified_ratio(const JobSize& job) {
  return job.clustered ? kClusteredTriangles : 1;
}

/// Returns the nodes of all levels, from the root down to the partitions.
std::vector<LevelNodes> count_nodes(const JobSize& job) {
  // Each node halves its partitions, so a level has at most two kinds of nodes: counts of kinds are
  // enough for a tree of any size.
  std::vector<LevelNodes> levels(1);
  levels[0][job.partition_count].count = 1;
  while (levels.back().rbegin()->first > 1) {
    LevelNodes finer;
    for (auto& [size, nodes] : levels.back()) {
      nodes.early = size == 1;
      finer[size - size / 2].count += nodes.count;
      if (size > 1)
        finer[size / 2].count += nodes.count;
    }
    levels.push_back(std::move(finer));
  }
  return levels;
}

std::vector<LevelNodes> measure_nodes(const JobSize& job) {
  std::vector<LevelNodes> levels = count_nodes(job);
  const double partition = static_cast<double>(job.place_count) / job.partition_count;
  levels.back().begin()->second.vertices = partition;
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    const LevelNodes& finer = levels[l + 1];
    for (auto& [size, nodes] : levels[l]) {
      double children = finer.at(size - size / 2).vertices;
      if (size > 1)
        children += finer.at(size / 2).vertices;
      nodes.joined = children;
      nodes.vertices = nodes.early
                           ? children
                           : job.target_vertex_counts.target(static_cast<Level>(l),
                                                             static_cast<std::uint32_t>(children));
    }
  }
  return levels;
}

void add(const TileSums& from, TileSums& to) {
  to.count += from.count;
  to.vertices += from.vertices;
  to.copies += from.copies;
  to.boundary += from.boundary;
  to.triangles += from.triangles;
}

/// Returns the boundary vertices of a tile with others all around it.
double boundary_of(double vertices) {
  return std::min(vertices, kBoundaryShare * std::sqrt(vertices));
}

/// Returns the part of a tile's border with others behind it: near the root there is less around
/// it.
double share_around(const JobSize& job, std::size_t level) {
  return job.face_count == 0 ? 0 : 1 - std::ldexp(1.0, -static_cast<int>(level));
}

/// `ratio`: triangles per vertex, over those of the input.
TileSums tiles_of(const JobSize& job, const Nodes& nodes, double ratio, std::size_t level) {
  TileSums tiles;
  tiles.count = nodes.count;
  tiles.vertices = nodes.count * nodes.vertices;
  tiles.copies = tiles.vertices * job.copies_per_place();
  tiles.boundary = nodes.count * share_around(job, level) * boundary_of(nodes.vertices);
  tiles.triangles =
      tiles.vertices * triangles_per_vertex(job) * ratio + tiles.boundary * kSharedTriangles;
  return tiles;
}

double steep_boundary_of(const JobSize& job, const Nodes& nodes, std::size_t level) {
  return nodes.count * share_around(job, level) *
         std::max(0.0, boundary_of(nodes.joined) - boundary_of(2 * nodes.vertices));
}

double times_expected(double counted, double expected) {
  return expected > 0 ? counted / expected : 1;
}

/// Returns `tiles` changed as partitions are: `counted` ones, beside `expected` ones.
TileSums in_proportion(TileSums tiles, const TileSums& expected, const TileSums& counted) {
  tiles.boundary = std::min(tiles.vertices,
                            tiles.boundary * times_expected(counted.boundary, expected.boundary));
  tiles.copies = tiles.vertices * counted.copies_per_vertex();
  tiles.triangles *= times_expected(counted.triangles, expected.triangles);
  tiles.wide_triangles =
      counted.triangles > 0 ? tiles.triangles * counted.wide_triangles / counted.triangles : 0;
  const double corners =
      std::max(1.0, times_expected(counted.foreign_per_boundary, expected.foreign_per_boundary));
  tiles.foreign_per_boundary *= corners;
  tiles.ghosts_per_boundary *= corners;
  return tiles;
}

}  // namespace

TilePopulation with_counted(const TilePopulation& expected, const TileSums& partitions) {
  TilePopulation all = expected;
  all.counted = true;
  all.partitions = partitions;
  for (TileSums* sums : {&all.simplified, &all.early})
    *sums = in_proportion(*sums, expected.partitions, partitions);
  return all;
}

TilePopulation expected_tiles(const JobSize& job) {
  const std::vector<LevelNodes> levels = measure_nodes(job);
  TilePopulation all;
  all.levels = static_cast<int>(levels.size());
  all.partitions.foreign_per_boundary = kGhosts;
  all.simplified.foreign_per_boundary = kFreshForeign;
  for (TileSums* sums : {&all.partitions, &all.simplified, &all.early})
    sums->ghosts_per_boundary = kGhosts;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    for (const auto& [size, nodes] : levels[l]) {
      if (l + 1 == levels.size()) {
        add(tiles_of(job, nodes, 1, l), all.partitions);
        continue;
      }
      const TileSums tiles = tiles_of(job, nodes, nodes.early ? 1 : simplified_ratio(job), l);
      add(tiles, all.simplified);
      all.steep_boundary += steep_boundary_of(job, nodes, l);
      if (nodes.early)
        add(tiles, all.early);
    }
  }
  return all;
}

TileCounts count_tiles(const TilePopulation& tiles) {
  return {tiles.levels, static_cast<std::uint64_t>(tiles.partitions.count),
          static_cast<std::uint64_t>(tiles.simplified.count - tiles.early.count)};
}

}  // namespace meshhier::pipeline
