// A build in a process of its own: whatever ends it, this one goes on.
#pragma once

#include "server/job.h"

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::server {

/// Hears of a build while it runs.
struct BuildListener {
  /// A line that it said, without its end, and the job as it is by then.
  std::function<void(std::string_view line, const Job& job)> heard = [](std::string_view,
                                                                        const Job&) {};
  /// Called every 50 ms or sooner; true asks the build to stop, which keeps its work.
  std::function<bool()> is_to_stop = [] { return false; };
};

/// The end of a build.
struct BuildEnd {
  int code = 0;         ///< its exit code; 128 + n after death by signal n
  std::string message;  ///< the last that it said, or what ended it
  std::vector<std::string> warnings;
};

/// Runs a build to its end. `words`: the program and its arguments, `--progress json` among them.
/// Throws Error(io) if there can be no new process.
BuildEnd run_build_process(const std::vector<std::string>& words, Job job,
                           const BuildListener& listener);

/// The exit code of several builds that failed for different reasons.
inline constexpr int kSeveralReasons = 10;
/// Returns the exit code of several builds, by those of the ones that failed: 0 if none did, theirs
/// if all have the same, else kSeveralReasons.
int exit_code_of(std::span<const int> failures);

}  // namespace meshhier::server
