// The stage `partition`, upper part: vertices and triangles distributed to chunks.
#pragma once

#include "hierarchy/tree.h"
#include "partition/chunk.h"
#include "partition/direction.h"
#include "pipeline/cancel.h"
#include "pipeline/memory_plan.h"
#include "pipeline/progress.h"
#include "pipeline/source_mesh.h"
#include "storage/spool.h"

#include <vector>

namespace meshhier::pipeline {

/// All chunks of a mesh, spooled.
class Chunks {
 public:
  Chunks(const Tree& tree, int channels, storage::ScratchFile& scratch, std::size_t block_bytes);

  Level level() const { return level_; }
  const partition::ChunkMap& map() const { return map_; }
  std::uint32_t count() const { return map_.count(); }

  /// `rows`: per vertex its position and attributes as floats, in the order of ids.
  void append_vertices(std::uint32_t chunk, std::span<const float> rows);
  /// A triangle goes to each chunk it touches.
  void append_triangles(std::span<const partition::RankTriangle> triangles);

  /// Reads a chunk and forgets it. Thread-safe for different chunks.
  partition::ChunkMesh take(std::uint32_t chunk);
  /// Bytes a chunk's triangles take in memory.
  std::uint64_t triangle_bytes(std::uint32_t chunk) const;

 private:
  Level level_;
  partition::ChunkMap map_;
  int channels_;
  std::vector<storage::RecordSpool<float>> vertices_;
  std::vector<storage::RecordSpool<partition::RankTriangle>> triangles_;
};

/// Finds the exact splits above the chunks, then distributes the vertices in one pass and the
/// triangles in one.
Chunks distribute(SourceMesh& mesh, const Tree& tree, partition::Axis axis, const MemoryPlan& plan,
                  storage::ScratchFile& scratch, Progress& progress, const CancelToken& cancel);

}  // namespace meshhier::pipeline
