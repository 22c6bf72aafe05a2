#include "execution/serial_time.h"

#include <ctime>

namespace meshhier::execution {
namespace {

/// The times of one thread.
struct Account {
  int calls = 0;      ///< parallel ones that have not ended
  double inside = 0;  ///< its CPU seconds in them
  double chains = 0;  ///< seconds of their longest chains
};

thread_local Account account;

}  // namespace

double thread_cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double serial_seconds() {
  return thread_cpu_seconds() - account.inside + account.chains;
}

ParallelCall::ParallelCall() : begun_(thread_cpu_seconds()) {
  ++account.calls;
}

ParallelCall::~ParallelCall() {
  if (--account.calls > 0)
    return;
  // The chains overlap: whichever is the longest, the call cannot take less.
  account.inside += thread_cpu_seconds() - begun_;
  account.chains += std::max({reads.seconds(), work.seconds(), sinks.seconds()});
}

}  // namespace meshhier::execution
