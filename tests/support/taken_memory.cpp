#include "support/taken_memory.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> g_taken{0};

}  // namespace

// All other forms but the aligned ones, which nothing here uses, end in these.

void* operator new(std::size_t bytes) {
  g_taken += bytes;
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes))
    return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace meshhier::tests {

std::size_t taken_bytes() {
  return g_taken;
}

}  // namespace meshhier::tests
