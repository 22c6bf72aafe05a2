// The main job: from a mesh file to a hierarchy on disk.
#pragma once

#include "config/config.h"
#include "pipeline/build_report.h"
#include "pipeline/journal/restart.h"
#include "pipeline/plan/stage_context.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace meshhier::pipeline {

struct BuildOptions {
  bool force = false;  ///< replace an existing output
  Restart restart = Restart::never;
  std::vector<std::filesystem::path> others{};  ///< files that its caller writes, besides
  bool leaves_work = true;  ///< a stopped build leaves what the next one goes on with
  /// Asked before the work, while no other process builds the output; false: nothing is done.
  std::function<bool()> is_due = [] { return true; };
  /// Called when the hierarchy is there, before another process may build the output; may throw.
  std::function<void(const BuildReport&)> on_made = [](const BuildReport&) {};
};

/// Builds config.output from config.input and returns when the hierarchy is on disk under its name.
/// The result is the same bytes for any threads, memory budget and interruption. It runs on TBB's
/// threads; `environment` must outlive the call. An existing output is Error(exists), unless it is
/// to be replaced; then it stays as it was until the new one is complete. It is Error(usage) if a
/// file of the input would be replaced, by the output or by one of the others. Throws Error(input)
/// for a mesh that is broken or unsupported, Error(budget) if memory or disk are too small,
/// Error(io), and Error(interrupted) if it is cancelled.
///
/// As soon as the triangles are distributed, the work that is done is noted on disk, beside the
/// output. If a build is stopped after that, by Error(interrupted), Error(io) or a kill, it stays
/// there, and the next build of the same input with a config of the same result goes on with it;
/// with another result it is refused with Error(other_work) unless `restart` says otherwise, and
/// with Error(locked) while another process builds the output. Else nothing is left behind.
BuildReport build_hierarchy(const config::Config& config, const BuildOptions& options,
                            const BuildEnvironment& environment);
/// Does the same unless options.is_due says that there is nothing to do; then it returns nothing.
std::optional<BuildReport> build_if_due(const config::Config& config, const BuildOptions& options,
                                        BuildEnvironment environment);

}  // namespace meshhier::pipeline
