// Many builds, each in a process of its own: none stops the others, whatever ends it.
#pragma once

#include "app/build_arguments.h"
#include "app/command.h"
#include "execution/progress.h"

namespace meshhier::app {

/// Builds a hierarchy of each of arguments.named, several at once, and tells of all at the end; or
/// tells what that would take. The memory budget and the threads of each are divided by their
/// number. Returns the exit code: 0, that of all builds that failed if they have the same, else
/// server::kSeveralReasons. Throws Error(usage) if two would have one output; Error(interrupted).
int run_batch(const BuildArguments& arguments, execution::ProgressMode mode,
              const Environment& environment);

}  // namespace meshhier::app
