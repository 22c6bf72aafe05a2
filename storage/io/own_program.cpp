#include "storage/io/own_program.h"

#include "base/error.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <sys/auxv.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOwnProgram = "/proc/self/exe";

/// Returns the path by which the system has started the process, without links: for systems without
/// /proc.
const fs::path& started() {
  static const fs::path path = [] {
    const auto* const given = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
    std::error_code error;
    return given == nullptr ? fs::path() : fs::canonical(given, error);
  }();
  return path;
}

/// Returns what /proc/self/exe names; if the file was replaced, that ends with a remark which says
/// so.
fs::path running(std::error_code& error) {
  const fs::path path = fs::read_symlink(kOwnProgram, error);
  if (!error || started().empty())
    return path;
  error.clear();
  return started();
}

/// Returns a path of the file that runs, even if its name is another file's by now.
std::string running_file() {
  std::error_code error;
  return fs::exists(kOwnProgram, error) || started().empty() ? kOwnProgram : started().string();
}

fs::path libraries_of(const fs::path& launcher) {
  return launcher.parent_path().parent_path() / "lib/meshhier";
}

/// Returns the launcher that started the program; empty if none did. The variable may have been set
/// for a parent which is another program.
fs::path launcher() {
  const char* const given = std::getenv("MESHHIER_PROGRAM");
  std::error_code error;
  const fs::path path = given == nullptr ? "" : given;
  return !path.empty() && running(error).parent_path() == libraries_of(path) ? path : "";
}

}  // namespace

std::string own_program() {
  if (!launcher().empty())
    return launcher().string();
  std::error_code error;
  const fs::path path = running(error);
  return !error && fs::exists(path, error) ? path.string() : running_file();
}

std::string own_directory() {
  if (!launcher().empty())
    return launcher().parent_path().string();
  std::error_code error;
  const fs::path path = running(error);
  if (error) {
    throw Error(ErrorCode::io,
                "cannot find out where the program lies: there is no /proc; start it by its whole "
                "path");
  }
  return path.parent_path().string();
}

std::string own_code() {
  const fs::path path = launcher();
  return path.empty() ? running_file() : (libraries_of(path) / path.filename()).string();
}

CompanionFolder::CompanionFolder(const char* variable, std::span<const char* const> places,
                                 const char* file) {
  if (const char* const given = std::getenv(variable); given != nullptr && *given != '\0') {
    path_ = given;
    return;
  }
  const fs::path program = own_directory();
  for (const char* const place : places) {
    path_ = (program / place).lexically_normal();
    if (has(file))
      break;
  }
}

bool CompanionFolder::has(const char* file) const {
  std::error_code error;
  return fs::exists(path_ / file, error);
}

}  // namespace meshhier::storage
