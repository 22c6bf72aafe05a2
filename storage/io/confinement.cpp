#include "storage/io/confinement.h"

#include "base/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

/// The address space of this process when it was confined.
rlim_t own_bytes = 0;

[[noreturn]] void fail_to_limit(const char* what) {
  throw Error(ErrorCode::io, std::string("cannot limit ") + what + ": " + std::strerror(errno));
}

/// Lowers a limit for good.
template <class Resource>
void lower(Resource resource, rlim_t most, const char* what) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0)
    fail_to_limit(what);
  limit.rlim_max = limit.rlim_cur = std::min(most, limit.rlim_max);
  if (::setrlimit(resource, &limit) != 0)
    fail_to_limit(what);
}

/// The first number of /proc/self/statm is the size of the address space in pages.
rlim_t bytes_of_address_space() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

void confine_process() {
  own_bytes = bytes_of_address_space();
  lower(RLIMIT_NOFILE, STDERR_FILENO + 1, "open files");
  lower(RLIMIT_FSIZE, 0, "the size of files");
  lower(RLIMIT_NPROC, 0, "processes");
  lower(RLIMIT_CORE, 0, "cores");
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
    fail_to_limit("rights");
}

void limit_work(std::uint64_t memory_bytes, std::uint64_t seconds) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0)
    fail_to_limit("memory");
  limit.rlim_cur = std::min<rlim_t>(own_bytes + memory_bytes, limit.rlim_max);
  const itimerval timer{{0, 0}, {static_cast<time_t>(seconds), 0}};
  if (::setrlimit(RLIMIT_AS, &limit) != 0 || ::setitimer(ITIMER_PROF, &timer, nullptr) != 0)
    fail_to_limit("memory or time");
}

}  // namespace meshhier::storage
