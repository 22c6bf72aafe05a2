// The one exception type. Its code is the exit code of the command line (docs/command_line.md).
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace meshhier {

enum class ErrorCode : int {
  usage = 2,         ///< command line or config wrong
  input = 3,         ///< the input mesh is broken or unsupported
  io = 4,            ///< a file could not be read, written, synced or renamed; disk full
  exists = 5,        ///< the output is already there, and is not to be replaced
  budget = 6,        ///< the memory budget or the free disk space is too small for the job
  corrupt = 7,       ///< a hierarchy on disk is damaged or fails verification
  locked = 8,        ///< another process is at work on the output: try again later
  other_work = 9,    ///< a stopped build of another config or input left its work
  internal = 70,     ///< a defect in meshhier
  interrupted = 130  ///< Ctrl-C or SIGTERM
};

class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

  /// The same failure, told with where it happened: "context: message".
  Error within(const std::string& context) const { return {code_, context + ": " + what()}; }

 private:
  ErrorCode code_;
};

}  // namespace meshhier
