// What the process is to the system: Ctrl-C and its relatives turned into a cancel token, and the
// terminal.
#pragma once

#include "execution/cancel.h"

namespace meshhier::app {

/// From now on the first SIGINT or SIGTERM (SIGHUP too, unless it is ignored, as nohup does)
/// cancels `token`, which must live to the end of the process; the second kills the process at
/// once.
void cancel_on_signals(execution::CancelToken& token);

/// Whether standard error, or standard output, is a terminal.
bool error_output_is_terminal();
bool output_is_terminal();

}  // namespace meshhier::app
