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
  // the heap after it was given back. With a 32nd and a 128th of the budget two thirds of all pages
  // were made again. What is kept was a stage's work, which the memory plan counts, and goes back
  // where much of the budget is resident (release_free_memory()).
  const auto part = [&](std::uint64_t parts, std::uint64_t least, std::uint64_t most) {
    return static_cast<int>(std::clamp(budget_bytes / parts, least, most));
  };
  mallopt(M_MMAP_THRESHOLD, part(16, kMiB / 4, 32 * kMiB));
  mallopt(M_TRIM_THRESHOLD, part(8, kMiB, 64 * kMiB));
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
