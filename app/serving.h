// What `serve` does: it shows a folder, or builds once what is due.
#pragma once

#include "app/command.h"
#include "app/serve_arguments.h"

namespace meshhier::app {

/// Serves the folder, and builds what comes into the inbox if there is one, until it is cancelled
/// or the port is lost. Throws Error(usage) for a config or a token that is none, Error(io).
void serve_folder(const ServeArguments& arguments, Environment& environment);

/// Builds what is in the inbox and due, without a server, and tells how much. Returns the exit code
/// by server::exit_code_of(). Throws Error(locked) while another process does the same there;
/// Error(usage | io | interrupted).
int build_inbox(const ServeArguments& arguments, Environment& environment);

}  // namespace meshhier::app
