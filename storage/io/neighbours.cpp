#include "storage/io/neighbours.h"

#include <cerrno>
#include <chrono>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

std::optional<struct stat> status_of(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? std::optional(status) : std::nullopt;
}

bool is_own(const std::string& process) {
  const auto status = status_of("/proc/" + process), own = status_of("/proc/self");
  return status && own && status->st_uid == own->st_uid;
}

/// Returns this user's processes that hold locks, by /proc/locks: "1: FLOCK  ADVISORY  WRITE 1234
/// ...". What others claim could keep root from building for ever.
std::set<std::string> lockers() {
  std::set<std::string> processes;
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, way, access, process;
    if (words >> number >> kind >> way >> access >> process && kind == "FLOCK" && is_own(process))
      processes.insert(process);
  }
  return processes;
}

}  // namespace

fs::path file_system_root(const fs::path& directory) {
  std::error_code error;
  fs::path root = fs::canonical(directory, error);
  const auto own = status_of(root);
  while (own && root != root.parent_path()) {
    const auto above = status_of(root.parent_path());
    if (!above || above->st_dev != own->st_dev)
      break;
    root = root.parent_path();
  }
  return root;
}

std::vector<fs::path> locked_files(const fs::path& directory, std::string_view ending) {
  std::set<fs::path> found;
  const auto own = status_of(directory);
  for (const std::string& process : lockers()) {
    std::error_code error;
    for (fs::directory_iterator files("/proc/" + process + "/fd", error), end;
         own && !error && files != end; files.increment(error)) {
      std::error_code ignored;
      const fs::path file = fs::read_symlink(files->path(), ignored);
      if (!file.native().ends_with(ending))
        continue;
      const auto opened = status_of(files->path()), named = status_of(file);
      if (opened && named && opened->st_dev == own->st_dev && named->st_dev == own->st_dev &&
          opened->st_ino == named->st_ino)
        found.insert(file);
    }
  }
  return {found.begin(), found.end()};
}

DeviceTurn::DeviceTurn(const fs::path& directory)
    : root_(::open(file_system_root(directory).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  constexpr int kTries = 300;
  constexpr std::chrono::milliseconds kPause(10);
  for (int i = 0; i < kTries && root_.is_open(); ++i) {
    if (::flock(root_.number(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
      return;
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace meshhier::storage
