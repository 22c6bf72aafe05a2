// A running job is asked to stop by a token: Ctrl-C sets it, long loops look at it.
#pragma once

#include "base/error.h"

#include <atomic>

namespace meshhier::execution {

/// A flag that is set once. Thread-safe; cancel() may be called in a signal handler. Its order is
/// relaxed: nothing that another thread has written is read because of it.
class CancelToken {
 public:
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

  /// Throws Error(interrupted) once cancel() was called. Costs one relaxed load: call it for every
  /// tile or block.
  void check() const {
    if (cancelled())
      throw Error(ErrorCode::interrupted, "interrupted");
  }

 private:
  std::atomic<bool> cancelled_{false};
  static_assert(std::atomic<bool>::is_always_lock_free,
                "a signal handler may touch lock-free atomics only");
};

}  // namespace meshhier::execution
