// Two processes at work at once.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

namespace meshhier::tests {

/// Calls other() once in a process of its own, and own() here again and again until that ends.
/// Returns whether other() has returned true, without an exception.
template <class Other, class Own>
bool do_beside(const Other& other, const Own& own) {
  const pid_t process = ::fork();
  if (process == 0) {
    bool is_well = false;
    try {
      is_well = other();
    } catch (...) {  // is told by the status
    }
    ::_exit(is_well ? 0 : 1);
  }
  int status = process < 0 ? 1 : 0;
  while (process > 0 && ::waitpid(process, &status, WNOHANG) == 0)
    own();
  return status == 0;
}

}  // namespace meshhier::tests
