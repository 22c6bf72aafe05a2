// The surroundings of every stage of a build.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "pipeline/plan/build_plan.h"
#include "storage/io/file.h"

namespace meshhier::pipeline {

/// The surroundings of a build, besides its config. All must outlive it; any thread of the build
/// may use them.
struct BuildEnvironment {
  storage::FileSystem& files;
  execution::Progress& progress;  ///< advance() comes from any thread, all else from one
  const execution::CancelToken& cancel;
};

/// The things that a stage may look at and report to, once the build is planned. The data that it
/// works on and learns are arguments and results of the stage's function. Nothing of it is changed
/// while stages run, so any thread may read it.
struct StageContext {
  const config::Config& config;
  const BuildPlan& plan;
  storage::FileSystem& files;
  execution::Progress& progress;
  const execution::CancelToken& cancel;

  const Tree& tree() const { return plan.tree; }
  const MemoryPlan& memory() const { return plan.memory; }
};

}  // namespace meshhier::pipeline
