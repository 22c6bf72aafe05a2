#include "storage/io/process_state.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace meshhier::storage {
namespace {

std::uint64_t count_open_files() {
  std::error_code error;
  const std::filesystem::directory_iterator files("/proc/self/fd", error);
  const auto count = error ? 0 : std::distance(begin(files), end(files));
  return count > 0 ? static_cast<std::uint64_t>(count) - 1 : 0;  // without the listing's own
}

}  // namespace

std::uint64_t status_number(std::string_view key) {
  std::ifstream status("/proc/self/status");
  std::uint64_t number = 0;
  for (std::string word; status >> word;) {
    if (word == key) {
      status >> number;
      break;
    }
  }
  return number;
}

ProcessState process_state() {
  return {.resident_bytes = status_number("VmRSS:") * kStatusUnit,
          .virtual_bytes = status_number("VmSize:") * kStatusUnit,
          .threads = status_number("Threads:"),
          .open_files = count_open_files()};
}

}  // namespace meshhier::storage
