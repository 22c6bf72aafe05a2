// What the process is to the system: Ctrl-C and its relatives turned into a cancel token, and the
// terminal.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"

namespace meshhier::app {

/// Where standard input, output or error is closed, their numbers would go to the next files that
/// are opened, which would then take what is printed. From now on printing there fails.
void reserve_standard_descriptors();

/// The first SIGINT or SIGTERM (SIGHUP too, unless it is ignored, as nohup does) cancels it; the
/// second kills the process at once. That is so from before main() on, and before libraries begin,
/// which takes milliseconds.
const execution::CancelToken& signal_token();

/// What standard error is.
execution::Terminal error_terminal();
/// Whether standard output is a terminal.
bool output_is_terminal();

}  // namespace meshhier::app
