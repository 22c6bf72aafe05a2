#include "storage/io/process_state.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace meshhier::storage {
namespace {

/// Sizes in /proc/self/status are in units of 1024 bytes, "VmRSS:   12345 kB".
constexpr std::uint64_t kUnit = 1024;

std::uint64_t count_open_files() {
  std::error_code error;
  const std::filesystem::directory_iterator files("/proc/self/fd", error);
  const auto count = error ? 0 : std::distance(begin(files), end(files));
  return count > 0 ? static_cast<std::uint64_t>(count) - 1 : 0;  // without the listing's own
}

}  // namespace

ProcessState process_state() {
  ProcessState state{.open_files = count_open_files()};
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key; status.ignore(kUnit, '\n')) {
    if (key == "VmRSS:" && status >> state.resident_bytes)
      state.resident_bytes *= kUnit;
    else if (key == "VmSize:" && status >> state.virtual_bytes)
      state.virtual_bytes *= kUnit;
    else if (key == "Threads:")
      status >> state.threads;
  }
  return state;
}

}  // namespace meshhier::storage
