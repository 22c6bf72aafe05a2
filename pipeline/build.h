// The main job: from a mesh file to a hierarchy on disk.
#pragma once

#include "pipeline/build_stats.h"
#include "pipeline/cancel.h"
#include "pipeline/config.h"
#include "pipeline/progress.h"
#include "storage/file.h"

#include <string>

namespace meshhier::pipeline {

/// What a build works with, besides its config.
struct BuildEnvironment {
  storage::FileSystem& files;
  Progress& progress;
  const CancelToken& cancel;
};

struct BuildReport {
  std::string text;  ///< a few lines and a table for people
  BuildStats stats;
};

/// Builds config.output from config.input. An existing output is Error(exists), or is replaced if
/// `force`. On any failure nothing is left behind and an existing output is as it was.
BuildReport build_hierarchy(const Config& config, bool force, BuildEnvironment environment);

}  // namespace meshhier::pipeline
