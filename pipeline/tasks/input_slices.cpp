#include "pipeline/tasks/input_slices.h"

#include "base/error.h"
#include "pipeline/import_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/tiles/blob_json.h"
#include "pipeline/tiles/spool_json.h"

#include <algorithm>
#include <utility>

namespace meshhier::pipeline {
namespace {

using Entry = InputSlices::Entry;

void note_sums(const std::vector<storage::BlockSums>& sums, storage::EntrySink& entries) {
  for (const storage::BlockSums& run : sums)
    entries.append({{"sums", {run.first, run.sums}}});
}

/// Throws Error(input) if the input is not what the stage `read` found.
std::unique_ptr<mesh_io::MeshSource> open_same(importing::MeshInput& input,
                                               const EarlierBuild& source) {
  const std::vector<importing::ReadFile>& read = source.input.files;
  if (input.needs_import() || read.size() != 1 ||
      read[0].identity != input.files().all()[0].identity) {
    throw Error(ErrorCode::input,
                input.files().name() + " was changed since the stage read: plan the build again");
  }
  return input.open();
}

}  // namespace

void InputSlices::note(const InputSplits& splits, storage::EntrySink& entries) {
  Entry planes = Entry::array();
  for (const partition::SplitPlane& plane : splits.top.planes()) {
    const Vec3d& d = plane.direction;
    planes.push_back({d.x, d.y, d.z, plane.first_right.projection, plane.first_right.id});
  }
  entries.append({{"splits", std::move(planes)}});
  note_sums(splits.sums, entries);
  for (const importing::StoredCopies& copies : splits.copies)
    entries.append({{"copies", {copies.block, to_json(copies.blob)}}});
}

bool InputSlices::is_entry(const Entry& entry) {
  return entry.contains("splits") || entry.contains("sums") || entry.contains("copies") ||
         entry.contains("ranks") || entry.contains("faces");
}

bool InputSlices::ends_faces(const Entry& entry) {
  return entry.contains("faces") && entry.at("faces").contains("whole") &&
         entry.at("faces").at("whole") == false;
}

InputSlices::InputSlices(const config::Config& config, const EarlierBuild& source,
                         const Share& slice, Workshop& workshop, const StageContext& context)
    : workshop_(workshop),
      context_(context),
      slice_(slice),
      files_(open_input(config, context.files)),
      vertices_(workshop.mesh_scratch.beside("vertices")),
      file_(open_same(files_, source)),
      copies_(workshop.mesh_scratch, file_->description().vertex_count),
      ranks_(workshop.chunks.map(), file_->description().vertex_count, file_->vertex_blocks(),
             workshop.mesh_scratch),
      copy_rows_(workshop.mesh_scratch, 1 << 18) {}

bool InputSlices::take(const Entry& entry, const Share& from) {
  try {
    if (entry.contains("splits"))
      return take_splits(entry.at("splits"));
    if (entry.contains("copies"))
      return take_copies(entry.at("copies"));
    if (entry.contains("ranks"))
      return take_ranks(entry.at("ranks"), from);
    if (entry.contains("faces"))
      return take_faces_entry(entry.at("faces"));
    const Entry& sums = entry.at("sums");
    return file_->add_sums({sums.at(0), sums.at(1)});
  } catch (const Entry::exception&) {
    return false;
  }
}

bool InputSlices::take_splits(const Entry& planes) {
  std::vector<partition::SplitPlane> all;
  for (const Entry& plane : planes)
    all.push_back({{plane.at(0), plane.at(1), plane.at(2)}, {plane.at(3), plane.at(4)}});
  if (all.size() + 1 != workshop_.chunks.count())
    return false;
  top_.emplace(workshop_.chunks.level(), std::move(all));
  return true;
}

bool InputSlices::take_copies(const Entry& copies) {
  const Entry& blob = copies.at(1);
  return copies_.restore({copies.at(0), {blob.at(0), blob.at(1), blob.at(2)}});
}

bool InputSlices::take_ranks(const Entry& ranks, const Share& from) {
  if (from.index == slice_.index && !restore(copy_rows_, ranks.at("copy_rows")))
    return false;
  return ranks_.restore(from, ranks);
}

bool InputSlices::take_faces_entry(const Entry& faces) {
  if (faces_ended_)
    return true;
  faces_ended_ = !faces.at("whole").get<bool>();
  const Entry& counts = faces.at("counts");
  counts_ = counts_ + mesh_io::FaceCounts{counts.at(0), counts.at(1), counts.at(2), {}};
  workshop_.chunks.add_wide(faces.at("wide").get<WideCounts>());
  return counts_.faces <= file_->description().face_count;
}

SlicedInput InputSlices::input() {
  const std::optional<DistributedSource>& source = workshop_.journal.source();
  if (!source || !top_)
    throw Error(ErrorCode::corrupt, "the stage read is not whole: plan the build again");
  if (!mesh_)
    mesh_.emplace(ingested(std::move(file_), source->summary, source->origin, vertices_));
  return {*mesh_, copies_, ranks_};
}

SlicedInput InputSlices::input_with_ranks() {
  if (!ranks_.is_whole())
    throw Error(ErrorCode::corrupt, "slices of the vertices are missing: plan the build again");
  return input();
}

void InputSlices::distribute(storage::EntrySink& entries) {
  Chunks& chunks = workshop_.chunks;
  SlicedInput in = input();
  distribute_vertices(in, *top_, slice_, chunks, copy_rows_, context_);
  files_.files().check_unchanged();
  std::vector<std::uint32_t> counts;
  for (std::uint32_t chunk = 0; chunk < chunks.count(); ++chunk)
    counts.push_back(static_cast<std::uint32_t>(chunks.place_count(chunk)));
  Entry ranks = ranks_.store(slice_, counts);
  ranks["copy_rows"] = store(copy_rows_);
  entries.append({{"ranks", std::move(ranks)}});
  workshop_.journal.note_chunks();
}

void InputSlices::take_faces(storage::EntrySink& entries) {
  Chunks& chunks = workshop_.chunks;
  SlicedInput in = input_with_ranks();
  if (!copy_rows_.is_as_stored())
    throw copy_rows_.changed();
  distribute_copies(in, slice_, copy_rows_, chunks, workshop_.mesh_scratch, context_);
  const FaceBlocks blocks =
      distribute_triangles(in, slice_, chunks, workshop_.mesh_scratch, context_);
  files_.files().check_unchanged();
  const mesh_io::FaceCounts& counts = blocks.counts;
  entries.append({{"faces",
                   {{"counts", {counts.faces, counts.triangles, counts.degenerate_triangles}},
                    {"whole", blocks.whole},
                    {"wide", chunks.wide()}}}});
  note_sums(in.mesh.known_sums(), entries);
  workshop_.journal.note_chunks();
}

void InputSlices::join(storage::EntrySink& /*entries*/) {
  SlicedInput in = input_with_ranks();
  const mesh_io::FaceCounts rest = distribute_triangles_from(counts_.faces, in, workshop_.chunks,
                                                             workshop_.mesh_scratch, context_);
  warn_of_wide_triangles(workshop_.chunks, context_);
  note_source(in.mesh, counts_ + rest, files_, workshop_, context_);
}

}  // namespace meshhier::pipeline
