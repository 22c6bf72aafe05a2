#include "support/taken_memory.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> g_taken{0};
std::atomic<std::size_t> g_count{0};

}  // namespace

// All other forms but the aligned ones, which nothing here uses, end in these; with sanitizers the
// forms for arrays do not, but they stay among themselves.

void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  g_taken += bytes;
  ++g_count;
  return std::malloc(bytes == 0 ? 1 : bytes);
}
void* operator new(std::size_t bytes) {
  if (void* memory = operator new(bytes, std::nothrow))
    return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
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
std::size_t taken_count() {
  return g_count;
}

}  // namespace meshhier::tests
