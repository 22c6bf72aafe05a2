// What every stage of a build works with.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "pipeline/plan/build_plan.h"
#include "storage/io/file.h"

namespace meshhier::pipeline {

/// What a build works with, besides its config.
struct BuildEnvironment {
  storage::FileSystem& files;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
};

/// What a stage may look at and report to, once it is planned what there is to do. What it works on
/// and what it learns are arguments and results of the stage's function.
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
