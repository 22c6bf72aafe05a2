// Another program, run to its end and measured by the system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::bench {

struct ChildResult {
  int code = 0;  ///< exit code; 128 + n after death by signal n
  double wall_seconds = 0;
  double cpu_seconds = 0;                 ///< user + system
  std::uint64_t peak_resident_bytes = 0;  ///< as the system counts for parents: no less than what
                                          ///< this process holds when it starts the child
};

/// Runs `words` (the program's path first). What it prints on either stream goes to `log`, which is
/// replaced. Throws Error(io) if it cannot be started.
ChildResult run_child(const std::vector<std::string>& words, const std::filesystem::path& log);

/// From now on Ctrl-C ends the child alone, so that this process can tidy up.
void leave_interrupts_to_children();

}  // namespace meshhier::bench
