// What a batch would make and take.
#pragma once

#include "app/batch_items.h"
#include "app/build_arguments.h"
#include "app/command.h"
#include "execution/progress.h"

#include <vector>

namespace meshhier::app {

/// Estimates all builds, one after the other, and prints each and the disk of all together. Returns
/// the exit code, in which a disk that is too small for all together counts as a failure of one.
/// Throws Error(interrupted).
int plan_batch(const BuildArguments& arguments, std::vector<BatchItem>& items,
               execution::ProgressMode mode, const Environment& environment);

}  // namespace meshhier::app
