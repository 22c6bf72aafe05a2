#include "pipeline/read_stage.h"

#include "config/placement.h"
#include "execution/allocator.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/partition_stage.h"

namespace meshhier::pipeline {
namespace {

/// An input whose vertices were read, and where the mesh is to be cut.
struct SplitInput {
  storage::ScratchFile vertices;
  SourceMesh mesh;
  partition::TopTree top;

  SplitInput(importing::MeshInput& input, Workshop& workshop, const StageContext& context)
      : vertices(workshop.mesh_scratch.beside("vertices")),
        mesh(ingest(input.open(), input.files().name(), vertices, context)),
        top(find(input, workshop, context)) {}

 private:
  partition::TopTree find(const importing::MeshInput& input, Workshop& workshop,
                          const StageContext& context) {
    config::tileset_transform(context.config, mesh.summary().bounds);  // refused now, if at all
    return find_splits(mesh, input.copies(), workshop.mesh_scratch, context);
  }
};

/// What ingest and partition learnt of the input, and import before them.
SourceSummary summarize(SourceMesh& mesh, const mesh_io::FaceCounts& counts,
                        const importing::MeshInput& input, const execution::CancelToken& cancel) {
  SourceSummary summary = mesh.summary();
  summary.faces = counts.faces;
  summary.triangles = counts.triangles;
  summary.degenerate_triangles = counts.degenerate_triangles;
  if (input.needs_import()) {
    input.complete(summary);
  } else {
    summary.checksum = mesh.checksum(cancel);
    input.files().check_unchanged();
  }
  if (summary.attributes.material)
    summary.attributes = summary.attributes.without_texcoords();  // tiles have their own
  return summary;
}

void read_chunks(SplitInput& split, importing::MeshInput& input, Workshop& workshop,
                 const StageContext& context) {
  const mesh_io::FaceCounts counts = distribute(split.mesh, input.copies(), split.top,
                                                workshop.chunks, workshop.mesh_scratch, context);
  execution::release_free_memory();
  note_source(split.mesh, counts, input, workshop, context);
}

bool has_slices(const importing::MeshInput& input, const SourceMesh& mesh) {
  return !input.needs_import() && input.copies().empty() && mesh.vertices_in_place();
}

}  // namespace

void note_source(SourceMesh& mesh, const mesh_io::FaceCounts& counts,
                 const importing::MeshInput& input, Workshop& workshop,
                 const StageContext& context) {
  const SourceSummary summary = summarize(mesh, counts, input, context.cancel);
  workshop.journal.note_source(
      {summary, mesh.origin(), input.materials(), input.record(summary.checksum)});
}

void read_mesh(importing::MeshInput& input, Workshop& workshop, const StageContext& context) {
  SplitInput split(input, workshop, context);
  read_chunks(split, input, workshop, context);
}

std::optional<InputSplits> read_splits(importing::MeshInput& input, Workshop& workshop,
                                       const StageContext& context) {
  SplitInput split(input, workshop, context);
  if (!has_slices(input, split.mesh)) {
    read_chunks(split, input, workshop, context);
    return std::nullopt;
  }
  input.files().check_unchanged();
  workshop.journal.note_source(
      {split.mesh.summary(), split.mesh.origin(), input.materials(), input.record(0)});
  return InputSplits{std::move(split.top), split.mesh.known_sums()};
}

}  // namespace meshhier::pipeline
