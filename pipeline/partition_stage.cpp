#include "pipeline/partition_stage.h"

#include "hierarchy/error.h"
#include "partition/renumber.h"
#include "partition/top_tree.h"
#include "pipeline/parallel.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using partition::RankTriangle;
using partition::TopPlan;
using partition::TopTree;

/// A block of input vertices, kept while others are read.
struct VertexCopy {
  std::uint32_t first = 0;
  std::vector<Vec3f> positions;
  std::vector<float> attributes;
};

/// Streams the vertices through parallel work(block) and a serial sink in file order.
template <class Result>
void for_each_block(const SourceMesh& mesh, const MemoryPlan& plan, const CancelToken& cancel,
                    Progress& progress, std::function<Result(const VertexCopy&)> work,
                    std::function<void(Result&)> sink) {
  BatchedWork<VertexCopy, Result> blocks(plan.blocks_in_flight, std::move(work), std::move(sink));
  mesh.read_vertices([&](std::uint64_t first, std::span<const Vec3f> positions,
                         std::span<const float> attributes) {
    cancel.check();
    blocks.add({static_cast<std::uint32_t>(first),
                {positions.begin(), positions.end()},
                {attributes.begin(), attributes.end()}});
    progress.advance(positions.size());
  });
  blocks.finish();
}

TopTree find_splits(const SourceMesh& mesh, const Tree& tree, partition::Axis axis,
                    const MemoryPlan& memory, storage::ScratchFile& scratch, Progress& progress,
                    const CancelToken& cancel) {
  TopPlan plan = partition::plan_top(mesh.sample(), tree, axis);
  if (plan.splits.empty())
    return {plan.chunks, {}};
  for (;;) {
    progress.stage("partition", tree.vertex_count(), "vertices");
    partition::TopSelector selector(plan, tree, scratch, memory.work_bytes / 2);
    for_each_block<partition::SweepBlock>(
        mesh, memory, cancel, progress,
        [&](const VertexCopy& block) {
          return partition::sweep(plan, block.positions, block.first);
        },
        [&](partition::SweepBlock& block) { selector.add(block); });
    std::vector<partition::SplitPlane> planes = selector.settle(plan);
    if (!planes.empty())
      return {plan.chunks, std::move(planes)};
  }
}

/// A block's vertices sorted by chunk, in rows of position and attributes.
struct ChunkedBlock {
  std::vector<std::uint32_t> chunk_of;  ///< per vertex
  std::vector<std::uint32_t> starts;    ///< per chunk: its first row; one entry more than chunks
  std::vector<float> rows;
};

ChunkedBlock sort_by_chunk(const VertexCopy& block, const TopTree& top, std::uint32_t chunk_count,
                           std::size_t channels) {
  ChunkedBlock sorted;
  const std::size_t count = block.positions.size();
  sorted.chunk_of.resize(count);
  sorted.starts.resize(chunk_count + 1);
  for (std::size_t i = 0; i < count; ++i) {
    sorted.chunk_of[i] =
        top.chunk_of(block.positions[i], static_cast<std::uint32_t>(block.first + i));
    ++sorted.starts[sorted.chunk_of[i] + 1];
  }
  for (std::size_t i = 1; i < sorted.starts.size(); ++i)
    sorted.starts[i] += sorted.starts[i - 1];
  std::vector<std::uint32_t> next(sorted.starts.begin(), sorted.starts.end() - 1);
  const std::size_t width = 3 + channels;
  sorted.rows.resize(count * width);
  for (std::size_t i = 0; i < count; ++i) {
    float* row = sorted.rows.data() + next[sorted.chunk_of[i]]++ * width;
    row[0] = block.positions[i].x;
    row[1] = block.positions[i].y;
    row[2] = block.positions[i].z;
    std::copy_n(block.attributes.data() + i * channels, channels, row + 3);
  }
  return sorted;
}

/// Distributes the vertices; returns the provisional rank of every id.
storage::RecordSpool<std::uint32_t> distribute_vertices(const SourceMesh& mesh, const TopTree& top,
                                                        Chunks& chunks, const MemoryPlan& plan,
                                                        storage::ScratchFile& scratch,
                                                        Progress& progress,
                                                        const CancelToken& cancel) {
  progress.stage("distribute", mesh.summary().vertices, "vertices");
  storage::RecordSpool<std::uint32_t> rank_of(scratch, 1 << 18);
  const auto channels = static_cast<std::size_t>(mesh.summary().attributes.channels());
  std::vector<std::uint32_t> next_rank(chunks.count());
  for (std::uint32_t c = 0; c < chunks.count(); ++c)
    next_rank[c] = chunks.map().first_rank(c);
  std::vector<std::uint32_t> ranks;
  for_each_block<ChunkedBlock>(
      mesh, plan, cancel, progress,
      [&](const VertexCopy& block) { return sort_by_chunk(block, top, chunks.count(), channels); },
      [&](ChunkedBlock& block) {
        ranks.resize(block.chunk_of.size());
        for (std::size_t i = 0; i < ranks.size(); ++i)
          ranks[i] = next_rank[block.chunk_of[i]]++;
        rank_of.append(ranks);
        const std::size_t width = 3 + channels;
        for (std::uint32_t c = 0; c < chunks.count(); ++c) {
          const std::size_t rows = block.starts[c + 1] - block.starts[c];
          if (rows > 0)
            chunks.append_vertices(
                c, std::span(block.rows).subspan(block.starts[c] * width, rows * width));
        }
      });
  return rank_of;
}

void distribute_triangles(SourceMesh& mesh, const storage::RecordSpool<std::uint32_t>& rank_of,
                          Chunks& chunks, const MemoryPlan& plan, storage::ScratchFile& scratch,
                          Progress& progress, const CancelToken& cancel) {
  progress.stage("triangles", mesh.declared_faces(), "triangles");
  const auto read = [&](const auto& visit) {
    mesh.read_triangles([&](std::span<const mesh_io::SourceTriangle> triangles) {
      cancel.check();
      visit(triangles);
      progress.advance(triangles.size());
    });
  };
  partition::renumber(read, rank_of, plan.table_bytes, scratch,
                      [&](std::span<const RankTriangle> triangles) {
                        cancel.check();
                        chunks.append_triangles(triangles);
                      });
}

}  // namespace

Chunks::Chunks(const Tree& tree, int channels, storage::ScratchFile& scratch,
               std::size_t block_bytes)
    : level_(partition::chunk_level(tree)), map_(tree, level_), channels_(channels) {
  for (std::uint32_t i = 0; i < map_.count(); ++i) {
    vertices_.emplace_back(scratch, block_bytes);
    triangles_.emplace_back(scratch, block_bytes);
  }
}

void Chunks::append_vertices(std::uint32_t chunk, std::span<const float> rows) {
  vertices_[chunk].append(rows);
}

void Chunks::append_triangles(std::span<const RankTriangle> triangles) {
  for (const RankTriangle& t : triangles) {
    const std::uint32_t a = map_.chunk_of(t[0]);
    const std::uint32_t b = map_.chunk_of(t[1]);
    const std::uint32_t c = map_.chunk_of(t[2]);
    triangles_[a].append(t);
    if (b != a)
      triangles_[b].append(t);
    if (c != a && c != b)
      triangles_[c].append(t);
  }
}

std::uint64_t Chunks::triangle_bytes(std::uint32_t chunk) const {
  return triangles_[chunk].size() * sizeof(RankTriangle);
}

partition::ChunkMesh Chunks::take(std::uint32_t chunk) {
  partition::ChunkMesh mesh;
  mesh.node = {level_, chunk};
  mesh.vertices.channels = channels_;
  mesh.vertices.reserve(map_.size(chunk));
  const std::size_t width = 3 + static_cast<std::size_t>(channels_);
  std::vector<float> rows;
  constexpr std::uint64_t kRows = 16384;  // a block at a time: the rows are not held twice
  for (std::uint64_t first = 0; first < map_.size(chunk); first += kRows) {
    rows.resize(std::min<std::uint64_t>(kRows, map_.size(chunk) - first) * width);
    vertices_[chunk].read(first * width, rows);
    for (std::size_t at = 0; at < rows.size(); at += width) {
      mesh.vertices.append({rows[at], rows[at + 1], rows[at + 2]},
                           std::span(rows).subspan(at + 3, width - 3));
    }
  }
  vertices_[chunk].clear();
  mesh.triangles = triangles_[chunk].read_all();
  triangles_[chunk].clear();
  return mesh;
}

Chunks distribute(SourceMesh& mesh, const Tree& tree, partition::Axis axis, const MemoryPlan& plan,
                  storage::ScratchFile& scratch, Progress& progress, const CancelToken& cancel) {
  const TopTree top = [&] {
    storage::ScratchFile windows = scratch.beside("windows");
    return find_splits(mesh, tree, axis, plan, windows, progress, cancel);
  }();
  release_free_memory();
  Chunks chunks(tree, mesh.summary().attributes.channels(), scratch, plan.spool_block_bytes);
  storage::ScratchFile passing = scratch.beside("ranks");
  const auto rank_of = distribute_vertices(mesh, top, chunks, plan, passing, progress, cancel);
  release_free_memory();
  distribute_triangles(mesh, rank_of, chunks, plan, passing, progress, cancel);
  release_free_memory();
  return chunks;
}

}  // namespace meshhier::pipeline
