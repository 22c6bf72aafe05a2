// For what other threads and processes will do in their own time.
#pragma once

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace meshhier::tests {

/// Until it is so; fails after ten minutes, which nothing here takes on any machine.
template <class Condition>
void wait_until(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  while (!condition()) {
    ASSERT_LT(std::chrono::steady_clock::now(), end) << "it never came";
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace meshhier::tests
