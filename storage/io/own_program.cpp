#include "storage/io/own_program.h"

#include "hierarchy/error.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOwnProgram = "/proc/self/exe";

/// What /proc/self/exe names; of a file which was replaced it ends with a remark that it was.
fs::path running(std::error_code& error) {
  return fs::read_symlink(kOwnProgram, error);
}

fs::path libraries_of(const fs::path& launcher) {
  return launcher.parent_path().parent_path() / "lib/meshhier";
}

/// The launcher that started it; empty if none did. The variable may be that of a parent which is
/// another program.
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
  return !error && fs::exists(path, error) ? path.string() : kOwnProgram;
}

std::string own_directory() {
  if (!launcher().empty())
    return launcher().parent_path().string();
  std::error_code error;
  const fs::path path = running(error);
  if (error) {
    throw Error(ErrorCode::io,
                std::string("cannot resolve ") + kOwnProgram + ": " + error.message());
  }
  return path.parent_path().string();
}

std::string own_code() {
  const fs::path path = launcher();
  return path.empty() ? kOwnProgram : (libraries_of(path) / path.filename()).string();
}

}  // namespace meshhier::storage
