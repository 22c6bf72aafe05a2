#include "execution/allocator.h"

#include "storage/io/process.h"

#include <algorithm>

#include <malloc.h>

namespace meshhier::execution {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

}  // namespace

void configure_allocator(std::uint64_t budget_bytes) {
  // Arrays mapped alone leave at once, but each of their pages is made anew, and so is the end of
  // the heap after it was given back. With the usual parts two thirds of all pages were made again.
  // Memory kept beyond was a stage's, and goes back where much of the budget is resident
  // (release_free_memory()). Small budgets have no room for it: a soup took 66 MiB of 64.
  const std::uint64_t roomy = budget_bytes - std::min(budget_bytes, 128 * kMiB);
  const auto part = [&](std::uint64_t usual_parts, std::uint64_t roomy_parts, std::uint64_t least,
                        std::uint64_t most) {
    const std::uint64_t bytes = std::max(budget_bytes / usual_parts, roomy / roomy_parts);
    return static_cast<int>(std::clamp(bytes, least, most));
  };
  mallopt(M_MMAP_THRESHOLD, part(128, 16, kMiB / 4, 32 * kMiB));
  mallopt(M_TRIM_THRESHOLD, part(32, 8, kMiB, 64 * kMiB));
  mallopt(M_ARENA_MAX, 2);
}

void release_free_memory() {
  malloc_trim(0);
}

void release_free_memory(std::uint64_t budget_bytes) {
  const std::uint64_t resident = storage::resident_bytes();
  if (resident == 0 || resident > budget_bytes / 4 * 3)
    release_free_memory();
}

}  // namespace meshhier::execution
