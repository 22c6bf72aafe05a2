#include "pipeline/read_stage.h"

#include "config/placement.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/partition_stage.h"

namespace meshhier::pipeline {
namespace {

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

}  // namespace

void read_mesh(importing::MeshInput& input, Workshop& workshop, const StageContext& context) {
  storage::ScratchFile vertices = workshop.mesh_scratch.beside("vertices");
  SourceMesh mesh = ingest(input.open(), input.files().name(), vertices, context);
  config::tileset_transform(context.config, mesh.summary().bounds);  // refused now, if at all
  const mesh_io::FaceCounts counts =
      partition_mesh(mesh, input.copies(), workshop.chunks, workshop.mesh_scratch, context);
  const SourceSummary summary = summarize(mesh, counts, input, context.cancel);
  workshop.journal.note_source(
      {summary, mesh.origin(), input.materials(), input.record(summary.checksum)});
}

}  // namespace meshhier::pipeline
