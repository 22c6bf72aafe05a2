// What a build says of itself when it is done.
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
  std::string text;     ///< for people: what was made, how long it took, what is to be known of it
  std::string account;  ///< for people: what was imported, and a table of the stages
  BuildStats stats;
  storage::InputNote input;  ///< which files the hierarchy was made of
};

/// What of a build neither its plan nor its hierarchy tells.
struct BuildOutcome {
  std::string found;               ///< what an earlier build had done, for people; may be empty
  std::uint64_t output_bytes = 0;  ///< of the published files, or of the archive
  bool has_area = true;            ///< as has_area()
  std::uint64_t peak_temporary_bytes = 0;
  DiskNeed predicted;  ///< from the header, or from the partitions if it was far off
  importing::InputRecord input;
};

/// Of the files of a hierarchy.
std::uint64_t bytes_of(const storage::HierarchyReader& made, storage::FileSystem& files);

/// One line for people: what was made, and how large it is.
std::string made_text(const storage::HierarchyReader& made, const std::filesystem::path& output,
                      std::uint64_t output_bytes);
/// Whether a triangle of any partition has an area, beyond what rounding its corners makes of a
/// line. Reads partitions until one has: the first, as a rule.
bool has_area(const storage::HierarchyReader& made, const execution::CancelToken& cancel);
/// A line for each thing that is to be known of it; may be empty.
std::string notes_text(const storage::HierarchyReader& made, const config::Config& config,
                       bool has_area);

/// Of the hierarchy `made`, when the last stage of `meter` has ended.
BuildReport make_report(const storage::HierarchyReader& made, const BuildOutcome& outcome,
                        const StageMeter& meter, const StageContext& context);

}  // namespace meshhier::pipeline
