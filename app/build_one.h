// One build, as `build` does it or tells of it.
#pragma once

#include "app/build_arguments.h"
#include "app/command.h"
#include "config/config.h"
#include "execution/progress.h"
#include "pipeline/estimate.h"

#include <optional>

namespace meshhier::app {

/// Returns the config of the files that are named, and of all that was set. Throws as
/// config::load_named.
config::Config load_config(const BuildArguments& arguments, storage::FileSystem& files);

/// Builds, unless the output is up to date and that is asked for; returns the exit code. Throws as
/// pipeline::build_hierarchy.
int build_one(const BuildArguments& arguments, const config::Config& config,
              execution::ProgressMode mode, const Environment& environment);

/// Estimates the build; returns nothing if the output is up to date and that is asked for. Throws
/// as pipeline::estimate_build.
std::optional<pipeline::BuildEstimate> estimate_one(const BuildArguments& arguments,
                                                    const config::Config& config,
                                                    execution::Progress& progress,
                                                    const Environment& environment);

/// Prints the estimate; returns the exit code.
int tell_estimate(const BuildArguments& arguments, const config::Config& config,
                  const Environment& environment);

}  // namespace meshhier::app
