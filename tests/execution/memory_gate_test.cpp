#include "execution/memory_gate.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::execution {
namespace {

TEST(MemoryGateTest, WhatIsHeldStaysWithinTheLimit) {
  constexpr std::uint64_t kLimit = 100;
  MemoryGate gate(kLimit);
  std::atomic<std::uint64_t> held = 0;
  std::atomic<std::uint64_t> most = 0;
  const auto work = [&](std::uint64_t bytes) {
    for (int i = 0; i < 200; ++i) {
      const MemoryGate::Hold room = gate.enter(bytes);
      const std::uint64_t now = held += bytes;
      for (std::uint64_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
      }
      std::this_thread::yield();
      held -= bytes;
    }
  };
  std::vector<std::thread> threads;
  for (const std::uint64_t bytes : {70U, 40U, 30U, 60U})
    threads.emplace_back(work, bytes);
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_LE(most, kLimit);
  EXPECT_GE(most, 70U);
}

TEST(MemoryGateTest, WhatExceedsTheLimitGoesInAlone) {
  MemoryGate gate(10);
  { const MemoryGate::Hold large = gate.enter(1000); }
  const MemoryGate::Hold first = gate.enter(4);
  const MemoryGate::Hold second = gate.enter(6);
}

}  // namespace
}  // namespace meshhier::execution
