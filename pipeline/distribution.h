// Distributes vertices and triangles to the chunks, those of a whole mesh or of a slice of it.
#pragma once

#include "execution/parallel.h"
#include "import/copy_list.h"
#include "partition/rank_table.h"
#include "partition/renumber.h"
#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/chunks.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::pipeline {

/// The name that progress has for it.
inline constexpr const char* kPartitionStage = "partition";

/// Hands a share of the vertices to parallel work(block, slot), a serial sink(slot) in the order of
/// ids, and after(slot), parallel again.
template <class Slot, class Work, class Sink, class After>
void for_each_block(const SourceMesh& mesh, const Share& share, const StageContext& context,
                    const Work& work, const Sink& sink, const After& after) {
  struct Read {
    mesh_io::BlockMemory memory;
    std::size_t count = 0;
    Slot slot;
  };
  const std::uint64_t first = share.begin(mesh.vertex_blocks());
  execution::ordered_blocks<Read>(
      share.end(mesh.vertex_blocks()) - first, context.memory().blocks_in_flight, context.cancel,
      [&](std::uint64_t i, Read& read) {
        const SourceVertices block = mesh.read_vertex_block(first + i, read.memory);
        read.count = block.positions.size();
        work(block, read.slot);
      },
      [&](Read& read) {
        sink(read.slot);
        context.progress.advance(read.count);
        return true;
      },
      [&](Read& read) { after(read.slot); });
}

/// The first vertices of the places in a block, and the copies among its vertices.
struct BlockPlaces {
  std::vector<Vec3f> positions;
  std::vector<float> attributes;
  std::vector<std::uint32_t> ids;
  std::vector<CopyVertex> memory;
  std::span<const CopyVertex> copies;

  /// Picks them from a block. Returns false, and picks nothing, if there are no copies in it.
  bool pick(const SourceVertices& block, const importing::CopyList& list) {
    copies = list.read(block.first, block.positions.size(), memory);
    if (copies.empty())
      return false;
    const std::size_t channels = block.channels();
    positions.clear();
    attributes.clear();
    ids.clear();
    auto copy = copies.begin();
    for (std::size_t i = 0; i < block.positions.size(); ++i) {
      const auto id = static_cast<std::uint32_t>(block.first + i);
      if (copy != copies.end() && copy->id == id) {
        ++copy;
        continue;
      }
      positions.push_back(block.positions[i]);
      const auto values = block.attributes.subspan(i * channels, channels);
      attributes.insert(attributes.end(), values.begin(), values.end());
      ids.push_back(id);
    }
    return true;
  }
};

/// A block of vertices on its way to the chunks.
struct DistributedBlock {
  ChunkedVertices sorted;  ///< the places' first vertices
  // The rest is filled only if the mesh has copies.
  std::uint64_t first = 0;  ///< id
  BlockPlaces places;
  std::vector<float> copy_rows;

  void sort(const SourceVertices& block, const importing::CopyList& list,
            const partition::ChunkSearch& search, std::uint32_t chunk_count) {
    first = block.first;
    copy_rows.clear();
    if (!places.pick(block, list)) {
      sorted.chunk_of.resize(block.positions.size());
      search.find(block.positions, static_cast<std::uint32_t>(block.first), sorted.chunk_of);
      sorted.sort(chunk_count, block.positions, block.attributes);
      return;
    }
    sorted.chunk_of.resize(places.positions.size());
    search.find(places.positions, places.ids, sorted.chunk_of);
    sorted.sort(chunk_count, places.positions, places.attributes);
    take_copies(block);
  }

 private:
  void take_copies(const SourceVertices& block) {
    const std::size_t channels = block.channels();
    for (const CopyVertex& copy : places.copies) {
      const std::size_t at = copy.id - block.first;
      const Vec3f& p = block.positions[at];
      copy_rows.insert(copy_rows.end(), {p.x, p.y, p.z});
      const auto values = block.attributes.subspan(at * channels, channels);
      copy_rows.insert(copy_rows.end(), values.begin(), values.end());
    }
  }
};

/// Distributes the places' first vertices of a share; keep(ranks, block) gets their ranks in the
/// order of ids, and put(ranks, block) in any order, in parallel.
template <class Rank, class Keep, class Put>
void distribute_places(const SourceMesh& mesh, const importing::CopyList& copies,
                       const partition::TopTree& top, const Share& share, Chunks& chunks,
                       const Keep& keep, const Put& put, const StageContext& context) {
  struct Ranked {
    DistributedBlock block;
    std::vector<Rank> ranks;
  };
  const partition::ChunkSearch search(top, mesh.stored_bounds());
  Ranker ranker(chunks.map());
  for_each_block<Ranked>(
      mesh, share, context,
      [&](const SourceVertices& block, Ranked& ranked) {
        ranked.block.sort(block, copies, search, chunks.count());
      },
      [&](Ranked& ranked) {
        ranker.rank(ranked.block.sorted, ranked.ranks);
        keep(ranked.ranks, ranked.block);
      },
      [&](const Ranked& ranked) {
        put(ranked.ranks, ranked.block);
        chunks.append(ranked.block.sorted);
      });
}

/// A block of triangles on its way to the chunks.
struct TrianglesByRank {
  std::size_t read = 0;
  partition::Renumbered<std::uint32_t> renumbered;
  ChunkedTriangles chunked;

  void sort(const partition::ChunkMap& map) { chunked.sort(renumbered.finished, map); }
};

/// The same for a mesh with copies.
struct TrianglesByWedge {
  std::size_t read = 0;
  partition::Renumbered<partition::WedgeRank> renumbered;
  std::vector<partition::RankTriangle> triangles;
  std::vector<WedgedTriangle> wedged;
  ChunkedTriangles chunked;

  void sort(const partition::ChunkMap& map) {
    triangles.clear();
    wedged.clear();
    for (const auto& [a, b, c] : renumbered.finished) {
      const partition::RankTriangle ranks{a.rank, b.rank, c.rank};
      if ((a.wedge | b.wedge | c.wedge) == 0)
        triangles.push_back(ranks);
      else
        wedged.push_back({ranks, {a.wedge, b.wedge, c.wedge}});
    }
    chunked.sort(triangles, map);
    chunked.sort_wedged(wedged, map);
  }
};

/// Gives triangles to the chunks that they touch, through a table of ranks.
template <class Slot, class Rank>
class TriangleDistribution {
 public:
  TriangleDistribution(SourceMesh& mesh, partition::Renumberer<Rank> renumberer, Chunks& chunks,
                       const StageContext& context)
      : mesh_(mesh), renumberer_(std::move(renumberer)), chunks_(chunks), context_(context) {}

  /// Distributes what SourceMesh::read_triangle_blocks() reads.
  FaceBlocks take_blocks(const Share& share) {
    return mesh_.read_triangle_blocks<Slot>(
        share, in_flight(), context_.cancel,
        [&](std::span<const Triangle<VertexId>> triangles, Slot& slot) { sort(triangles, slot); },
        [&](const Slot& slot) { context_.progress.advance(slot.read); },
        [&](const Slot& slot) { keep(slot); });
  }
  /// Distributes what SourceMesh::read_triangles_from() reads.
  mesh_io::FaceCounts take_from(std::uint64_t face) {
    return mesh_.read_triangles_from<Slot>(
        face, in_flight(), context_.cancel,
        [&](std::span<const Triangle<VertexId>> triangles, Slot& slot) { sort(triangles, slot); },
        [&](const Slot& slot) { context_.progress.advance(slot.read); },
        [&](const Slot& slot) { keep(slot); });
  }
  /// Distributes the triangles that wait for a part of the table. Call once, at the end.
  void finish() {
    while (renumberer_.next_round()) {
      execution::ordered_blocks<Slot>(
          renumberer_.batches(), in_flight(), context_.cancel,
          [&](std::uint64_t batch, Slot& slot) {
            renumberer_.translate_batch(batch, slot.renumbered);
            slot.sort(chunks_.map());
            keep(slot);
          },
          [](const Slot&) { return true; });
    }
  }

 private:
  std::size_t in_flight() const { return context_.memory().blocks_in_flight; }
  void sort(std::span<const Triangle<VertexId>> triangles, Slot& slot) const {
    slot.read = triangles.size();
    renumberer_.translate(triangles, slot.renumbered);
    slot.sort(chunks_.map());
  }
  void keep(const Slot& slot) {
    renumberer_.keep(slot.renumbered);
    chunks_.append(slot.chunked);
  }

  SourceMesh& mesh_;
  partition::Renumberer<Rank> renumberer_;
  Chunks& chunks_;
  const StageContext& context_;
};

}  // namespace meshhier::pipeline
