#include "pipeline/plan/disk_need.h"

#include "partition/renumber.h"
#include "partition/top_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace meshhier::pipeline {
namespace {

// All of the following was measured on scans of one to eight hundred pieces, a terrain and open
// patches, with tiles of 64 to 32768 vertices.

// The part of a tile's vertices that is its boundary, times the root of their number: 3.6 to 4.7,
// on nested shells 4.2 to 6.9.
constexpr double kBoundaryShare = 5;
// Per vertex of the boundary: ghosts 1.0 to 1.2, triangles that a neighbour has as well 1.0 to 1.1,
// foreign corners of a fresh simplified tile, which are one level finer, 1.8.
constexpr double kGhosts = 1.1;
constexpr double kSharedTriangles = 1.05;
constexpr double kFreshForeign = 1.8;

// A tile of far fewer vertices than half of its children's (simplify.vertices by level) has long
// seams with what is one level finer: bytes of foreign corners and of the seam strip per vertex
// that the boundary of its joined children has beyond that of a tile of twice its own size. With
// steps from 400 to 20 and from 4,000 to 4, temporary files are then predicted 2 to 14 % too large,
// as with equal tiles of these sizes; without it a step from 4,000 to 4 was 4 % too small.
constexpr double kSteepBytes = 48;

// Triangles a vertex after clustering, over those before: 1.1 to 1.8, more on coarser levels; the
// other methods keep the input's ratio.
constexpr double kClusteredTriangles = 1.35;

// A published tile besides its sections: JSON and headers.
constexpr double kTileOverhead = 1600;
// Indices of a ghost's chain: two or three on average, 16 bits each.
constexpr double kChainBytes = 6;
// A file in an archive besides its content: two headers with its name, and its place in the index.
constexpr double kPackedOverhead = 138;
// What the last disk block of each file leaves empty.
constexpr double kFileSlack = 2048;

// A vertex kept aside for a median: position and id.
constexpr double kWindowBytes = sizeof(partition::IdPoint);
// The part of a sample's vertices that a window holds, times the root of their number: four
// standard deviations (half the root each) to either side.
constexpr double kWindowShare = 4;

/// Nodes of one level that stand over equally many partitions.
struct Nodes {
  double count = 0;
  double vertices = 0;  ///< of each one's tile
  double joined = 0;    ///< of its children together; partitions: none
  bool early = false;   ///< has its partition's tile
};
using LevelNodes = std::map<std::uint32_t, Nodes>;  // by partitions: never more than two kinds

double triangles_per_vertex(const JobSize& job) {
  return static_cast<double>(job.face_count) / static_cast<double>(job.vertex_count);
}

/// Triangles a vertex on simplified levels, over those of the input.
double simplified_ratio(const JobSize& job) {
  return job.clustered ? kClusteredTriangles : 1;
}

/// From the root down to the partitions.
std::vector<LevelNodes> count_nodes(const JobSize& job) {
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
  const double partition = static_cast<double>(job.vertex_count) / job.partition_count;
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

/// Sums over tiles.
struct Tiles {
  double count = 0;
  double vertices = 0;
  double boundary = 0;
  double steep_boundary = 0;  ///< of joined children, beyond that of twice a tile's vertices
  double triangles = 0;       ///< border ones in each tile they touch

  Tiles& operator+=(const Tiles& other) {
    count += other.count;
    vertices += other.vertices;
    boundary += other.boundary;
    steep_boundary += other.steep_boundary;
    triangles += other.triangles;
    return *this;
  }
};

/// Of a tile with others all around it.
double boundary_of(double vertices) {
  return std::min(vertices, kBoundaryShare * std::sqrt(vertices));
}

/// `ratio`: triangles per vertex, over those of the input. Near the root there is less around a
/// tile.
Tiles tiles_of(const JobSize& job, const Nodes& nodes, double ratio, std::size_t level) {
  Tiles tiles;
  tiles.count = nodes.count;
  tiles.vertices = nodes.count * nodes.vertices;
  const double around = job.face_count == 0 ? 0 : 1 - std::exp2(-static_cast<double>(level));
  tiles.boundary = nodes.count * around * boundary_of(nodes.vertices);
  tiles.steep_boundary = nodes.count * around *
                         std::max(0.0, boundary_of(nodes.joined) - boundary_of(2 * nodes.vertices));
  tiles.triangles =
      tiles.vertices * triangles_per_vertex(job) * ratio + tiles.boundary * kSharedTriangles;
  return tiles;
}

/// Tiles as the forest holds them: early ones among the simplified.
struct Population {
  Tiles partitions;
  Tiles simplified;
  Tiles early;  ///< of the simplified ones
  int levels = 0;
};

Population population_of(const JobSize& job) {
  const std::vector<LevelNodes> levels = measure_nodes(job);
  Population all;
  all.levels = static_cast<int>(levels.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    for (const auto& [size, nodes] : levels[l]) {
      if (l + 1 == levels.size()) {
        all.partitions += tiles_of(job, nodes, 1, l);
        continue;
      }
      const Tiles tiles = tiles_of(job, nodes, nodes.early ? 1 : simplified_ratio(job), l);
      all.simplified += tiles;
      if (nodes.early)
        all.early += tiles;
    }
  }
  return all;
}

// ---- what is written, in bytes -------------------------------------------------------------

/// storage/format/work_tile.cpp, and the boundary once more for its neighbours. `foreign`: foreign
/// corners per vertex of the boundary.
double work_tile_bytes(const JobSize& job, const Tiles& tiles, double foreign) {
  return tiles.count * 24 + tiles.vertices * (job.vertex_bytes() + 4) +
         tiles.boundary * (foreign * 8 + job.vertex_bytes()) + tiles.triangles * 6;
}

/// What neighbours see of a simplified tile: per vertex of the boundary 76 to 89 bytes, up to 130
/// after clustering where it leaves long boundaries; no more than the whole tile.
double seam_strip_bytes(const Tiles& tiles) {
  return std::min(tiles.boundary * 90, tiles.vertices * 20 + tiles.triangles * 12);
}

/// Chunks share the triangles along their borders.
double chunk_triangle_bytes(const JobSize& job) {
  const double chunks = std::exp2(std::max(
      0.0,
      std::ceil(std::log2(static_cast<double>(job.vertex_count) / partition::kChunkVertices))));
  const double share =
      chunks > 1 ? kBoundaryShare / std::sqrt(static_cast<double>(job.vertex_count) / chunks) : 0;
  return static_cast<double>(job.face_count) * 12 * (1 + std::min(1.0, share));
}

/// The vertices within a window of some split above the chunks.
double window_bytes(const JobSize& job) {
  double outside = 1;
  double sample = static_cast<double>(std::min(job.vertex_count, partition::kSampleVertices));
  for (double size = static_cast<double>(job.vertex_count); size > partition::kChunkVertices;
       size /= 2, sample /= 2) {
    outside *= 1 - std::min(1.0, kWindowShare / std::sqrt(sample));
  }
  return static_cast<double>(job.vertex_count) * (1 - outside) * kWindowBytes;
}

/// Triangles that wait for blocks of the rank table: all but those within the first block, if they
/// jump through it at random or if it has its vertices in several runs, as subdivided meshes do.
/// Each waits in one place at a time, and places are used again. A group of blocks is kept until
/// all of it is handed on.
double waiting_bytes(const JobSize& job, const MemoryPlan& plan) {
  const partition::RenumberPlan table =
      partition::plan_renumbering(job.vertex_count, sizeof(std::uint32_t), plan.table_bytes);
  if (table.blocks == 1)
    return 0;
  constexpr double kWaitingBytes = 16;
  const double group = table.groups > 1 ? 1.0 / static_cast<double>(table.groups) : 0;
  const double first = std::pow(static_cast<double>(table.blocks), -3);
  return static_cast<double>(job.face_count) * kWaitingBytes * (1 - first + group);
}

double spooled_input_bytes(const JobSize& job) {
  if (job.vertices_in_place)
    return 0;
  return static_cast<double>(job.vertex_count) *
         ((job.wide_coordinates ? 24 : 12) + 4.0 * job.channels);
}

double published_bytes(const JobSize& job, const Tiles& tiles) {
  const double vertex = 12 + static_cast<double>(job.published_attribute_bytes);
  return tiles.vertices * (vertex + 2) + tiles.boundary * kGhosts * (vertex + kChainBytes) +
         tiles.triangles * 6 + tiles.count * kTileOverhead;
}

/// Volumes of the table in disk_need.h.
struct Volumes {
  double input, windows, ranks, waiting, chunk_vertices, chunk_triangles, leaves, simplified;
};

Volumes volumes_of(const JobSize& job, const MemoryPlan& plan, const Population& all) {
  const auto vertices = static_cast<double>(job.vertex_count);
  constexpr double kPlaceBytes = 12;  // where a vertex of a chunk's boundary went
  Volumes v{};
  v.input = spooled_input_bytes(job);
  v.windows = window_bytes(job);
  v.ranks = vertices * 4;
  v.waiting = waiting_bytes(job, plan);
  v.chunk_vertices = vertices * job.vertex_bytes();
  v.chunk_triangles = chunk_triangle_bytes(job);
  v.leaves = work_tile_bytes(job, all.partitions, kGhosts) + all.partitions.boundary * kPlaceBytes;
  v.simplified = work_tile_bytes(job, all.simplified, kFreshForeign) +
                 (all.partitions.vertices + all.simplified.vertices) * 2;
  v.simplified += seam_strip_bytes(all.simplified) + all.simplified.steep_boundary * kSteepBytes;
  return v;
}

std::uint64_t whole(double bytes) {
  return static_cast<std::uint64_t>(std::max(0.0, bytes));
}

}  // namespace

DiskNeed predict_disk(const JobSize& job, const MemoryPlan& plan) {
  const Population all = population_of(job);
  const Volumes v = volumes_of(job, plan, all);
  const auto pool = static_cast<double>(plan.pool_bytes);
  const auto beyond_pool = [&](double bytes) { return std::max(0.0, bytes - pool); };

  // The pool takes what comes first and frees it with its spool; a file shrinks at its end only.
  const double chunks = v.chunk_vertices + v.chunk_triangles;
  const auto imported = static_cast<double>(job.imported_bytes);  // on disk whatever the pool
  const double partition = imported + beyond_pool(v.input + v.windows);
  const double triangles = imported + beyond_pool(v.input + v.ranks + v.waiting + chunks);
  const double stored = imported + beyond_pool(v.input) + chunks;
  const double leaves = chunks + v.leaves;
  const double simplify = v.leaves + v.simplified;

  const double output = published_bytes(job, all.partitions) +
                        published_bytes(job, all.simplified) - published_bytes(job, all.early);
  const double files = all.partitions.count + all.simplified.count + 3;
  const double temporary = std::max({partition, triangles, stored, leaves, simplify});
  const double published = output * job.published_ratio;
  // The room is for tiles that do not compress at all.
  const double room = std::max(temporary, simplify + output + files * kFileSlack);
  if (!job.packed)
    return {whole(temporary), whole(published), whole(room)};
  const double overhead = files * kPackedOverhead;
  return {whole(std::max(temporary, simplify + published)), whole(published + overhead),
          whole(std::max(room, 2 * output + files * kFileSlack + overhead))};
}

TileCounts count_tiles(const JobSize& job) {
  const Population all = population_of(job);
  return {all.levels, job.partition_count,
          static_cast<std::uint64_t>(all.simplified.count - all.early.count)};
}

}  // namespace meshhier::pipeline
