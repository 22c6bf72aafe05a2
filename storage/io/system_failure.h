// A system call that failed, as an exception.
#pragma once

#include "base/error.h"

#include <filesystem>
#include <string>

namespace meshhier::storage {

/// An Error(io) that says nothing about the file: the process or the system has too many files
/// open, or no memory, at this moment.
class Busy final : public Error {
 public:
  explicit Busy(const std::string& message) : Error(ErrorCode::io, message) {}
};

/// An Error(io): there is nothing of that name, perhaps because somebody has just removed it.
class NotThere final : public Error {
 public:
  explicit NotThere(const std::string& message) : Error(ErrorCode::io, message) {}
};

/// Throws Error(io), "cannot ACTION PATH: CAUSE", for an errno; Busy if that may pass, NotThere if
/// there is no such file.
[[noreturn]] void fail_system(const char* action, const std::filesystem::path& path, int error);

}  // namespace meshhier::storage
