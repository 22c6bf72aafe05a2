#include "storage/io/usable_memory.h"

#include "storage/io/process_state.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>

#include <sys/resource.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

std::uint64_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page_bytes = sysconf(_SC_PAGESIZE);
  return pages > 0 && page_bytes > 0
             ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes)
             : UINT64_MAX;
}

/// Returns what a limit of the process leaves beside `used` bytes.
template <class Resource>
std::uint64_t left_of(Resource resource, std::uint64_t used) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return UINT64_MAX;
  return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, used);
}

/// Returns the number in a file; UINT64_MAX if there is another word ("max") or no file.
std::uint64_t limit_in(const fs::path& file) {
  std::ifstream stream(file);
  std::uint64_t limit = 0;
  return stream >> limit ? limit : UINT64_MAX;
}

/// Returns the least limit of a group and all above it. `top`: the folder of all groups; `group`:
/// the group's path from there.
std::uint64_t limit_of(const fs::path& top, const fs::path& group, const char* file) {
  std::uint64_t least = limit_in(top / file);
  fs::path folder = top;
  for (const fs::path& part : group.relative_path()) {
    folder /= part;
    least = std::min(least, limit_in(folder / file));
  }
  return least;
}

bool has_memory(std::string_view controllers) {
  constexpr std::string_view kMemory = "memory";
  for (std::string_view rest = controllers; !rest.empty();) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    if (rest.substr(0, end) == kMemory)
      return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

/// /proc/self/cgroup has lines as "0::/group" in version 2, "4:memory,cpu:/group" in version 1.
std::uint64_t group_limit(const fs::path& root) {
  const fs::path groups = root / "sys/fs/cgroup";
  std::ifstream stream(root / "proc/self/cgroup");
  std::uint64_t least = UINT64_MAX;
  for (std::string line; std::getline(stream, line);) {
    const std::size_t first = line.find(':');
    if (first == std::string::npos)
      continue;
    const std::size_t second = line.find(':', first + 1);
    if (second == std::string::npos)
      continue;
    const std::string_view controllers =
        std::string_view(line).substr(first + 1, second - first - 1);
    const fs::path group = line.substr(second + 1);
    if (controllers.empty())
      least = std::min(
          {least, limit_of(groups, group, "memory.max"), limit_of(groups, group, "memory.high")});
    else if (has_memory(controllers))
      least = std::min(least, limit_of(groups / "memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

}  // namespace

UsableMemory usable_memory(const fs::path& root) {
  const std::array<UsableMemory, 4> bounds{
      {{machine_memory(), MemoryBound::machine},
       {left_of(RLIMIT_AS, process_state().virtual_bytes), MemoryBound::address_space},
       {left_of(RLIMIT_DATA, 0), MemoryBound::data},
       {group_limit(root), MemoryBound::group}}};
  return *std::ranges::min_element(bounds, {}, &UsableMemory::bytes);
}

}  // namespace meshhier::storage
