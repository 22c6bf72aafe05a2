// The stage `pack`: the published files as one archive.
#pragma once

#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/stage_cost.h"
#include "pipeline/plan/tile_population.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/scratch_use.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::pipeline {

/// Counts files as temporary ones while the object lives, though they are no scratch files.
class TemporaryFiles {
 public:
  TemporaryFiles(storage::ScratchUse& use, std::uint64_t bytes) : use_(use), bytes_(bytes) {
    use_.add_grown(bytes_);
  }
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;
  ~TemporaryFiles() { use_.add_removed(bytes_); }

 private:
  storage::ScratchUse& use_;
  std::uint64_t bytes_;
};

/// Returns the bytes of the archive beside the files in it.
double archive_overhead_bytes(const TilePopulation& tiles);

/// Returns the bytes of the output: all files, or their archive.
double published_bytes(const JobSize& job, const TilePopulation& tiles);

/// Returns seconds on the disk.
StageTimes pack_time(const JobSize& job, const TilePopulation& tiles);

/// Makes the archive `file` of all files of the hierarchy `made`: manifest, index, outline,
/// tilesets, then tiles level by level; forces it to the disk. Bytes that are read count in `use`.
/// Returns the archive's size. Throws Error(io | interrupted), Error(usage) if a file is too large
/// for an archive.
std::uint64_t pack(const storage::HierarchyReader& made, const std::filesystem::path& file,
                   storage::ScratchUse& use, const StageContext& context);

}  // namespace meshhier::pipeline
