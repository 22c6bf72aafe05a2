// Locks that others hold for a moment.
#pragma once

#include "storage/io/file.h"

#include <chrono>
#include <memory>
#include <thread>

namespace meshhier::storage {

/// Returns the lock that attempt() gets; asks for 3 s, as a process that was killed holds its locks
/// until the disk has done what it was asked for. Returns nothing if it never gets one.
template <class Attempt>
std::unique_ptr<FileLock> lock_patiently(const Attempt& attempt) {
  constexpr int kTries = 60;
  constexpr std::chrono::milliseconds kPause(50);
  for (int i = 0; i < kTries; ++i) {
    if (std::unique_ptr<FileLock> lock = attempt())
      return lock;
    std::this_thread::sleep_for(kPause);
  }
  return nullptr;
}

}  // namespace meshhier::storage
