// The report of a build that is done.
#pragma once

#include "import/input_record.h"
#include "pipeline/plan/build_stats.h"
#include "pipeline/plan/disk_need.h"
#include "pipeline/plan/stage_context.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/input_note.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace meshhier::pipeline {

struct BuildReport {
  std::string text;     ///< for people: the hierarchy, the time it took, and what to know about it
  std::string account;  ///< for people: the import, and a table of the stages
  BuildStats stats;
  storage::InputNote input;  ///< the files that the hierarchy was made of
};

/// The facts of a build that neither its plan nor its hierarchy tells.
struct BuildOutcome {
  std::string found;               ///< for people: the work of an earlier build; may be empty
  std::uint64_t output_bytes = 0;  ///< published files, or the archive
  bool has_area = true;            ///< as has_area()
  std::uint64_t peak_temporary_bytes = 0;
  DiskNeed predicted;  ///< from the header, or from the partitions if it was far off
  importing::InputRecord input;
  std::uint64_t copies_between_tiles = 0;  ///< as importing::MeshInput's
};

/// Returns the bytes of all files of a hierarchy.
std::uint64_t bytes_of(const storage::HierarchyReader& made, storage::FileSystem& files);

/// Returns one line for people: the hierarchy, and how large it is.
std::string made_text(const storage::HierarchyReader& made, const std::filesystem::path& output,
                      std::uint64_t output_bytes);
/// Whether a triangle of any partition has an area, beyond what rounding its corners makes of a
/// line. Reads partitions until one has: the first, as a rule.
bool has_area(const storage::HierarchyReader& made, const execution::CancelToken& cancel);
/// Returns a line for each thing that people should know about it; may be empty.
std::string notes_text(const storage::HierarchyReader& made, const config::Config& config,
                       bool has_area);

/// Returns the report of the hierarchy `made`. Requires that the last stage of `meter` has ended.
BuildReport make_report(const storage::HierarchyReader& made, const BuildOutcome& outcome,
                        const StageMeter& meter, const StageContext& context);

}  // namespace meshhier::pipeline
