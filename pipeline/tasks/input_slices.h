// The stages between `read` and `leaves`, in which tasks distribute an input to chunks in slices.
//
// Entries of segments, besides those of the journal:
//
//   splits   of `read`: the planes above the chunks; only if the input has slices
//   copies   of `read`: where the copies of a block of ids are
//   sums     of `read` and `faces`: checksums of what was read of the input
//   ranks    of `distribute`: where the ranks of a slice's vertices are, and the rows of its copies
//   faces    of `faces`: counts of the triangles of a slice
#pragma once

#include "import/copy_list.h"
#include "import/mesh_input.h"
#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/read_stage.h"
#include "pipeline/slice_stage.h"
#include "pipeline/sliced_ranks.h"
#include "storage/format/segment.h"

#include <memory>
#include <optional>

namespace meshhier::pipeline {

class InputSlices {
 public:
  using Entry = storage::EntrySink::Entry;

  /// Notes for the slices what `read` has found.
  static void note(const InputSplits& splits, storage::EntrySink& entries);
  /// Whether it is one of the entries above.
  static bool is_entry(const Entry& entry);
  /// Whether it says that the input has slices.
  static bool has_slices(const Entry& entry) { return entry.contains("splits"); }
  /// Whether it says that slices behind this one have no triangles: this one ended at a face that
  /// is none.
  static bool ends_faces(const Entry& entry);

  /// Opens the input. Throws Error(input) if it is not the one that `read` found, as `source` has
  /// it. `slice`: the task's share of a stage that has slices.
  InputSlices(const config::Config& config, const EarlierBuild& source, const Share& slice,
              Workshop& workshop, const StageContext& context);

  /// Takes an entry of a stage before, in the order of stages and tasks. Returns false if it does
  /// not fit.
  bool take(const Entry& entry, const Share& from);

  // Each does the work of a stage, when the entries before were taken, the source among them, and
  // notes it in the journal and in `entries`. They throw as slice_stage.h, and Error(corrupt) if
  // entries are missing.
  void distribute(storage::EntrySink& entries);
  void take_faces(storage::EntrySink& entries);
  /// Distributes the faces that no slice could take, and notes what all slices learnt of the
  /// source.
  void join(storage::EntrySink& entries);

 private:
  bool take_splits(const Entry& planes);
  bool take_copies(const Entry& copies);
  bool take_ranks(const Entry& ranks, const Share& from);
  bool take_faces_entry(const Entry& faces);
  /// These return the input when all entries were taken; throw Error(corrupt) if some are missing.
  SlicedInput input();
  SlicedInput input_with_ranks();

  Workshop& workshop_;
  const StageContext& context_;
  Share slice_;
  importing::MeshInput files_;
  storage::ScratchFile vertices_;
  std::unique_ptr<mesh_io::MeshSource> file_;
  std::optional<SourceMesh> mesh_;  ///< when the source is known
  importing::CopyList copies_;
  SlicedRanks ranks_;
  storage::RecordSpool<float> copy_rows_;  ///< the slice's
  std::optional<partition::TopTree> top_;
  mesh_io::FaceCounts counts_;  ///< all slices up to the first that ended early
  bool faces_ended_ = false;    ///< it was there
};

}  // namespace meshhier::pipeline
