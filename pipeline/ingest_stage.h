// The stage `ingest`: all vertices are read once, checked, bounded and sampled. Later stages read
// them again as floats.
#pragma once

#include "execution/cancel.h"
#include "execution/parallel.h"
#include "execution/progress.h"
#include "hierarchy/published.h"
#include "import/copy_list.h"
#include "import/text_blocks.h"
#include "mesh_io/mesh_source.h"
#include "partition/split_plane.h"
#include "pipeline/colour_range.h"
#include "pipeline/label_guess.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "storage/io/spool.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::pipeline {

/// The memory of a block of input, here and in `partition`.
std::uint64_t input_block_bytes(const JobSize& job);
/// The memory of the sample, here and in `partition`.
std::uint64_t sample_bytes(const JobSize& job);

/// The stage's memory; items are blocks of input.
StageMemory ingest_memory(const JobSize& job);
StageTimes ingest_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: the vertices once more, if they cannot be read in place, until the triangles
/// are distributed.
DiskVolumes ingest_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);

/// Vertices first, first + 1, ... relative to the origin. Valid as long as the memory they were
/// read into is not used.
struct SourceVertices {
  std::uint64_t first = 0;
  std::span<const Vec3f> positions;
  std::span<const float> attributes;

  std::size_t channels() const {
    return attributes.size() / std::max<std::size_t>(positions.size(), 1);
  }
};

/// The result of reading faces block by block.
struct FaceBlocks {
  mesh_io::FaceCounts counts;
  bool whole = true;  ///< else it ended at a face that is no sound triangle, which is not counted
};

/// A mesh that was read once: all vertices are sound. Methods that are const may be called by
/// several threads. Reading throws as mesh_io::MeshSource does, and Error(interrupted) if it is
/// cancelled.
class SourceMesh {
 public:
  /// Counts of faces and triangles, checksum and unreferenced_vertices are not known here.
  const SourceSummary& summary() const { return summary_; }
  std::uint64_t declared_faces() const { return source_->description().face_count; }
  bool vertices_in_place() const { return source_->description().vertices_in_place; }

  /// Notes `units` and `unused` in the summary.
  void note(std::optional<Unit> units, std::vector<std::string> unused) {
    summary_.units = units;
    summary_.unused = std::move(unused);
  }

  /// Corrects which attributes are labels where the config leaves that to their types: labels that
  /// LabelGuess takes for quantities are none any more, and a warning names quantities that may be
  /// labels. `is_sure(name)`: whether a label stays one. Call once, after ingest().
  void guess_labels(const std::function<bool(const std::string&)>& is_sure,
                    execution::Progress& progress);

  /// Add to positions to get input coordinates: choose_origin() of the vertices that triangles use.
  Vec3d origin() const { return origin_; }

  /// Returns the box of the positions, relative to the origin.
  Bounds stored_bounds() const {
    return {to_float(summary_.bounds.min - origin_), to_float(summary_.bounds.max - origin_)};
  }

  /// Returns the vertices that partition::SampleIds names, but for copies, and forgets them. Call
  /// once.
  std::vector<partition::IdPoint> take_sample(const importing::CopyList& copies);

  /// Returns the number of blocks that all vertices make, at most MeshSource::kBlockSize each, in
  /// the order of ids.
  std::uint64_t vertex_blocks() const;
  /// Reads a block. Thread-safe for different `memory`.
  SourceVertices read_vertex_block(std::uint64_t index, mesh_io::BlockMemory& memory) const;

  /// Calls visit(id, position) for the vertices of a block, in input coordinates. Thread-safe for
  /// different `memory`.
  template <class Visit>
  void visit_input_block(std::uint64_t index, mesh_io::BlockMemory& memory,
                         const Visit& visit) const;

  /// Reads all triangles once and counts them. work(triangles, slot) runs in parallel, each with
  /// one of `in_flight` slots; sink(slot) follows in file order, by execution::ordered_blocks().
  template <class Slot, class Work, class Sink>
  mesh_io::FaceCounts read_triangles(std::size_t in_flight, const execution::CancelToken& cancel,
                                     const Work& work, const Sink& sink);
  /// Does the first part of it: reads a share of the faces that can be read in blocks as triangles,
  /// up to the first that is none. The result means nothing unless the faces before the share are
  /// triangles. Triangles that work() is given may turn out to be none of the file's: then no
  /// sink() follows. after(slot) follows a sink() in parallel.
  template <class Slot, class Work, class Sink>
  FaceBlocks read_triangle_blocks(const Share& share, std::size_t in_flight,
                                  const execution::CancelToken& cancel, const Work& work,
                                  const Sink& sink, const std::function<void(Slot&)>& after = {});
  /// Does the rest: reads all faces from that one on, those before being sound triangles. Counts
  /// only these.
  template <class Slot, class Work, class Sink>
  mesh_io::FaceCounts read_triangles_from(std::uint64_t face, std::size_t in_flight,
                                          const execution::CancelToken& cancel, const Work& work,
                                          const Sink& sink,
                                          const std::function<void(Slot&)>& after = {});

  mesh_io::OddSyntax odd_syntax() const { return source_->odd_syntax(); }
  /// Returns the input's storage::FileChecksum; cheap when all has been read.
  std::uint64_t checksum(const execution::CancelToken& cancel) {
    return source_->checksum([&] { cancel.check(); });
  }
  /// The parts of it that are known, and those that other processes have read, as MeshSource has
  /// them.
  std::vector<storage::BlockSums> known_sums() const { return source_->known_sums(); }
  bool add_sums(const storage::BlockSums& sums) { return source_->add_sums(sums); }

 private:
  friend SourceMesh ingest(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
                           storage::ScratchFile& scratch, const StageContext& context);
  friend SourceMesh ingested(std::unique_ptr<mesh_io::MeshSource> source,
                             const SourceSummary& summary, Vec3d origin,
                             storage::ScratchFile& scratch);
  SourceMesh(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
             storage::ScratchFile& scratch);
  mesh_io::ZeroedCounts scan(const StageContext& context);
  void note_values(std::span<const ValueTally> values, std::vector<LabelGuess> guesses);
  void choose_colour_type(execution::Progress& progress);
  void choose_origin(const StageContext& context);
  mesh_io::VertexBlock read_input_block(std::uint64_t index, mesh_io::BlockMemory& memory) const;

  std::unique_ptr<mesh_io::MeshSource> source_;
  storage::Spool spooled_positions_;  ///< Vec3f or Vec3d
  storage::Spool spooled_attributes_;
  SourceSummary summary_;
  Vec3d origin_;
  bool float_exact_ = true;
  std::vector<LabelGuess> guesses_;  ///< one for each value
  ColourRange colours_;
  std::vector<Vec3d> sample_positions_;
};

/// Reads all vertices: checks them, bounds them, picks the sample. Vertices of a file that cannot
/// be read again in place are spooled to `scratch` meanwhile, which must outlive the result. Throws
/// as mesh_io::MeshSource does. `file_name`: for the summary. Requires a vertex.
SourceMesh ingest(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
                  storage::ScratchFile& scratch, const StageContext& context);

/// Returns the same mesh in another process, which reads nothing now: `summary` and `origin` are
/// those of ingest(). Requires vertices in place.
SourceMesh ingested(std::unique_ptr<mesh_io::MeshSource> source, const SourceSummary& summary,
                    Vec3d origin, storage::ScratchFile& scratch);

template <class Visit>
void SourceMesh::visit_input_block(std::uint64_t index, mesh_io::BlockMemory& memory,
                                   const Visit& visit) const {
  const mesh_io::VertexBlock block = read_input_block(index, memory);
  for (std::size_t i = 0; i < block.exact.size(); ++i)
    visit(block.first + i, block.exact[i]);
  for (std::size_t i = 0; i < block.positions.size(); ++i)
    visit(block.first + i, to_double(block.positions[i]));
}

template <class Slot, class Work, class Sink>
mesh_io::FaceCounts SourceMesh::read_triangles(std::size_t in_flight,
                                               const execution::CancelToken& cancel,
                                               const Work& work, const Sink& sink) {
  const mesh_io::FaceCounts blocks =
      read_triangle_blocks<Slot>({}, in_flight, cancel, work, sink).counts;
  const mesh_io::FaceCounts rest =
      read_triangles_from<Slot>(blocks.faces, in_flight, cancel, work, sink);
  return blocks + rest;
}

template <class Slot, class Work, class Sink>
FaceBlocks SourceMesh::read_triangle_blocks(const Share& share, std::size_t in_flight,
                                            const execution::CancelToken& cancel, const Work& work,
                                            const Sink& sink,
                                            const std::function<void(Slot&)>& after) {
  struct Read {
    mesh_io::BlockMemory memory;
    mesh_io::TriangleBlock block;
    Slot slot;
  };
  FaceBlocks all;
  const std::uint64_t count = source_->triangle_blocks();
  const std::uint64_t first = share.begin(count);
  execution::ordered_blocks<Read>(
      share.end(count) - first, in_flight, cancel,
      [&](std::uint64_t i, Read& read) {
        read.block = source_->read_triangle_block(first + i, read.memory);
        work(read.block.triangles, read.slot);
      },
      [&](Read& read) {
        sink(read.slot);
        all.counts.faces += read.block.faces;
        all.counts.triangles += read.block.triangles.size();
        all.whole = read.block.whole;
        return all.whole;
      },
      [&](Read& read) {
        if (after)
          after(read.slot);
      });
  all.counts.degenerate_triangles = all.counts.faces - all.counts.triangles;
  return all;
}

template <class Slot, class Work, class Sink>
mesh_io::FaceCounts SourceMesh::read_triangles_from(std::uint64_t face, std::size_t in_flight,
                                                    const execution::CancelToken& cancel,
                                                    const Work& work, const Sink& sink,
                                                    const std::function<void(Slot&)>& after) {
  struct Copied {
    std::vector<Triangle<VertexId>> triangles;
    Slot slot;
  };
  execution::BatchedWork<Copied> rest(
      in_flight,
      [&](Copied& copied) { work(std::span(std::as_const(copied.triangles)), copied.slot); },
      [&](Copied& copied) { sink(copied.slot); },
      [&](Copied& copied) {
        if (after)
          after(copied.slot);
      });
  const mesh_io::FaceCounts counts = source_->read_triangles_from(
      face,
      [&](std::span<const Triangle<VertexId>> triangles) {
        cancel.check();
        rest.next().triangles.assign(triangles.begin(), triangles.end());
      },
      importing::parallel_blocks(std::max<std::size_t>(in_flight / 2, 1), cancel));
  rest.finish();
  return counts;
}

}  // namespace meshhier::pipeline
