// The stage `ingest`: the input checked, bounded and sampled; its vertices ready to be streamed
// again as floats.
#pragma once

#include "hierarchy/published.h"
#include "mesh_io/mesh_source.h"
#include "partition/split_plane.h"
#include "pipeline/cancel.h"
#include "pipeline/progress.h"
#include "storage/spool.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::pipeline {

/// Vertices first, first + 1, ... relative to the origin.
using SourceBlockVisitor = std::function<void(std::uint64_t first, std::span<const Vec3f> positions,
                                              std::span<const float> attributes)>;

/// A mesh that was read once: all vertices are sound.
class SourceMesh {
 public:
  /// Reads all vertices: checks them, bounds them, picks the sample. A file whose vertices cannot
  /// be read again in place is spooled meanwhile. Throws as mesh_io::MeshSource does. `file_name`:
  /// for the summary. Requires a vertex.
  SourceMesh(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
             storage::ScratchFile& scratch, Progress& progress, const CancelToken& cancel);

  /// Counts of faces and triangles are 0 until read_triangles(); checksum and unreferenced_vertices
  /// are not known here.
  const SourceSummary& summary() const { return summary_; }
  std::uint64_t declared_faces() const { return source_->description().face_count; }
  bool vertices_in_place() const { return source_->description().vertices_in_place; }

  /// Add to positions to get input coordinates. 0 if all coordinates fit float exactly; else near
  /// the middle.
  Vec3d origin() const { return origin_; }

  /// The vertices that partition::SampleIds names.
  std::vector<partition::IdPoint> sample() const;

  void read_vertices(const SourceBlockVisitor& visit) const;

  /// Also completes the summary's face counts.
  void read_triangles(const mesh_io::TriangleVisitor& visit);

 private:
  void scan(Progress& progress, const CancelToken& cancel);
  void scan_block(const mesh_io::VertexBlock& block);
  void choose_origin();

  std::unique_ptr<mesh_io::MeshSource> source_;
  storage::Spool spooled_positions_;  ///< Vec3f or Vec3d
  storage::Spool spooled_attributes_;
  SourceSummary summary_;
  Vec3d origin_;
  bool float_exact_ = true;
  std::vector<Vec3d> sample_positions_;
};

}  // namespace meshhier::pipeline
