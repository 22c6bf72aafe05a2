// An estimate of a build before it, from the config and the header of the input alone.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "pipeline/plan/build_plan.h"
#include "pipeline/plan/tile_population.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// Time is the least certain of all: rates measured on one kind of machine (stage_costs.h).
struct TimeEstimate {
  double cpu_seconds = 0;
  double wall_seconds = 0;
};

TimeEstimate estimate_time(const BuildPlan& plan, std::uint64_t input_bytes);

/// The machine that the rates were measured on, for people.
inline constexpr std::string_view kRateMachine =
    "x86-64 server cores of about 3 GHz and a disk of 500 MB/s";

struct BuildEstimate {
  BuildPlan plan;
  mesh_io::MeshDescription mesh;
  TileCounts tiles;
  TimeEstimate time;
  std::uint64_t memory_budget_bytes = 0;
  std::uint64_t least_budget_bytes = 0;
  std::filesystem::path disk;  ///< a directory on the disk that would hold the output
  std::uint64_t free_bytes = 0;
  std::uint64_t replaced_bytes = 0;  ///< of the output that is there
  std::uint64_t left_bytes = 0;      ///< of what an earlier build of it has left
  mesh_io::InputPaths input;
  std::filesystem::path output;
  std::string placement;  ///< as config::placement_text() has it
};

/// Estimates a build. Refuses what build_hierarchy() refuses before its work, with the same Error;
/// leaves nothing behind. Input that must be imported is imported to count it, into temporary files
/// beside the output, which takes as long as in a build. Otherwise only the header is read, and the
/// vertices where places are counted or the config puts the model on the globe.
BuildEstimate estimate_build(const config::Config& config, bool force, storage::FileSystem& files,
                             const execution::CancelToken& cancel = execution::CancelToken());

/// Returns a few lines for people.
std::string estimate_text(const BuildEstimate& estimate);

/// Returns one object; docs/command_line.md lists its keys.
nlohmann::ordered_json to_json(const BuildEstimate& estimate);

}  // namespace meshhier::pipeline
