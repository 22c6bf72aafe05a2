#include "pipeline/read_stage.h"

#include "config/placement.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/partition_stage.h"

#include <algorithm>
#include <vector>

namespace meshhier::pipeline {
namespace {

/// Reads the vertices; `scratch` must outlive the mesh.
SourceMesh read_vertices(importing::MeshInput& input, storage::ScratchFile& scratch,
                         const StageContext& context) {
  SourceMesh mesh = ingest(input.open(), input.files().name(), scratch, context);
  if (!context.config.attributes.labels)
    mesh.guess_labels(
        [&](const std::string& name) {
          const mesh_io::ObjectChoice& objects = context.config.objects.from;
          return input.is_sure_label(name) ||
                 (objects.from == mesh_io::ObjectSource::label && objects.label == name);
        },
        context.progress);
  mesh.note(input.files().units(), input.files().unused());
  for (const std::string& warning : input.files().warnings())
    context.progress.warn(warning);
  config::tileset_transform(context.config, mesh.summary().bounds);  // refused now, if at all
  return mesh;
}

/// Returns what ingest and partition learnt of the input, and import before them.
SourceSummary summarize(SourceMesh& mesh, const mesh_io::FaceCounts& counts,
                        const importing::MeshInput& input, const execution::CancelToken& cancel) {
  SourceSummary summary = mesh.summary();
  summary.faces = counts.faces;
  summary.triangles = counts.triangles;
  summary.degenerate_triangles = counts.degenerate_triangles;
  for (const auto& all :
       {importing::source_counts(counts.polygons), importing::source_counts(mesh.odd_syntax())}) {
    for (const SourceCount& one : all)
      importing::add_count(summary.counts, one.name, one.count);
  }
  std::ranges::sort(summary.counts, {}, &SourceCount::name);
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

void note_source(SourceMesh& mesh, const mesh_io::FaceCounts& counts,
                 const importing::MeshInput& input, Workshop& workshop,
                 const StageContext& context) {
  const SourceSummary summary = summarize(mesh, counts, input, context.cancel);
  workshop.journal.note_source(
      {summary, mesh.origin(), input.materials(), input.record(summary.checksum)});
}

void read_mesh(importing::MeshInput& input, Workshop& workshop, const StageContext& context) {
  storage::ScratchFile vertices = workshop.mesh_scratch.beside("vertices");
  SourceMesh mesh = read_vertices(input, vertices, context);
  const mesh_io::FaceCounts counts =
      partition_mesh(mesh, input.copies(), workshop.chunks, workshop.mesh_scratch, context);
  note_source(mesh, counts, input, workshop, context);
}

std::optional<InputSplits> read_splits(importing::MeshInput& input, Workshop& workshop,
                                       const StageContext& context) {
  if (input.needs_import() || !input.description().vertices_in_place) {
    read_mesh(input, workshop, context);
    return std::nullopt;
  }
  storage::ScratchFile vertices = workshop.mesh_scratch.beside("vertices");
  SourceMesh mesh = read_vertices(input, vertices, context);
  partition::TopTree top = find_splits(mesh, input.copies(), workshop.mesh_scratch, context);
  input.files().check_unchanged();
  workshop.journal.note_source({mesh.summary(), mesh.origin(), input.materials(), input.record(0)});
  return InputSplits{std::move(top), mesh.known_sums(),
                     input.copies().store(workshop.mesh_scratch, [&] { context.cancel.check(); })};
}

}  // namespace meshhier::pipeline
