#include "storage/io/code_memory.h"

#include <cstddef>

#include <sys/mman.h>
#include <unistd.h>

namespace meshhier::storage {

bool may_make_code() {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  void* const memory =
      ::mmap(nullptr, page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED)
    return true;  // there is no memory: whoever needs it tells so
  const bool may = ::mprotect(memory, page, PROT_READ | PROT_EXEC) == 0;
  ::munmap(memory, page);
  return may;
}

}  // namespace meshhier::storage
