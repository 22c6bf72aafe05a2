// The main job: from a mesh file to a hierarchy on disk.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "pipeline/plan/build_stats.h"
#include "storage/io/file.h"

#include <string>

namespace meshhier::pipeline {

/// What a build works with, besides its config.
struct BuildEnvironment {
  storage::FileSystem& files;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
};

struct BuildOptions {
  bool force = false;    ///< replace an existing output
  bool restart = false;  ///< throw away what an earlier build of the output left
};

struct BuildReport {
  std::string text;  ///< a few lines and a table for people
  BuildStats stats;
};

/// Builds config.output from config.input. An existing output is Error(exists), unless it is to be
/// replaced, and then as it was until the new one is complete.
///
/// What is done is noted on disk, beside the output, as soon as the triangles are distributed. If a
/// build is stopped after that, by Error(interrupted), Error(io) or a kill, it stays there, and the
/// next build of the same input with a config of the same result goes on with it; with another
/// result it is refused with Error(exists). Else nothing is left behind.
BuildReport build_hierarchy(const config::Config& config, const BuildOptions& options,
                            BuildEnvironment environment);

}  // namespace meshhier::pipeline
