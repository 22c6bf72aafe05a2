#include "storage/io/process.h"

#include "base/error.h"
#include "storage/io/open_files.h"
#include "storage/io/process_state.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

}  // namespace

ProcessUsage process_usage() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  // Unlike ru_maxrss the high-water mark does not count what the process held before it became
  // this program.
  ProcessUsage result{seconds(usage.ru_utime), seconds(usage.ru_stime),
                      status_number("VmHWM:") * kStatusUnit};
  if (result.peak_resident_bytes == 0)
    result.peak_resident_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  return result;
}

std::uint64_t resident_bytes() {
  return status_number("VmRSS:") * kStatusUnit;
}

std::uint64_t most_open_files() {
  rlimit limit{};
  const bool is_limited =
      ::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return is_limited ? limit.rlim_cur : UINT64_MAX;
}

void allow_many_open_files() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
}

std::string unique_name() {
  static const std::string process = [] {
    std::random_device device;
    const std::uint64_t number = std::uint64_t{device()} << 32 | device();
    return fmt::format("{:016x}-{}", number, ::getpid());
  }();
  static std::atomic<std::uint64_t> next{0};
  return fmt::format("{}-{}", process, next++);
}

bool is_unique_name(std::string_view name) {
  constexpr std::size_t kDigits = 16;
  return name.size() > kDigits && name[kDigits] == '-' &&
         name.find_first_not_of("0123456789abcdef") == kDigits &&
         name.find_first_not_of("0123456789-", kDigits) == std::string_view::npos;
}

std::filesystem::path temporary_folder() {
  const char* const given = std::getenv("TMPDIR");
  const bool is_given = given != nullptr && *given != '\0';
  const std::filesystem::path folder = is_given ? given : "/tmp";
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(folder, error);
  if (is_folder)
    return folder;
  throw Error(ErrorCode::io,
              fmt::format("temporary files go to {}{}, which {}; set TMPDIR to another place",
                          folder.string(), is_given ? " (TMPDIR)" : "",
                          error && error != std::errc::no_such_file_or_directory
                              ? "cannot be used: " + error.message()
                          : std::filesystem::exists(folder, error) ? "is no directory"
                                                                   : "is not there"));
}

std::filesystem::path make_temporary_directory() {
  const std::filesystem::path parent = temporary_folder();
  std::string name = (parent / "meshhier-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw Error(ErrorCode::io,
                fmt::format("cannot make a directory for temporary files in {}: {}; set TMPDIR to "
                            "another place",
                            parent.string(), std::strerror(errno)));
  }
  return name;
}

}  // namespace meshhier::storage
