// The process and the system: Ctrl-C and its relatives turned into a cancel token, and the
// terminal.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"

namespace meshhier::app {

/// Makes printing to standard output or error fail if it is closed. Else the next files that are
/// opened would get these numbers, and would take what is printed.
void reserve_standard_descriptors();

/// Returns the token that the first SIGINT or SIGTERM (SIGHUP too, unless it is ignored, as nohup
/// does) cancels; the second kills the process at once. That is so from before main() on, and
/// before libraries begin, which takes milliseconds.
const execution::CancelToken& signal_token();

/// Returns the terminal that standard error is, if it is one.
execution::Terminal error_terminal();
/// Whether standard output is a terminal.
bool output_is_terminal();

}  // namespace meshhier::app
