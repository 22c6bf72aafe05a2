#include "execution/serial_time.h"

#include "execution/parallel.h"

#include <cstddef>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::execution {
namespace {

/// Computes for so many CPU seconds of its thread.
void compute(double seconds) {
  const double begun = thread_cpu_seconds();
  while (thread_cpu_seconds() - begun < seconds) {
  }
}

/// Returns the serial time that a call takes.
template <class Call>
double serial_part(const Call& call) {
  const double before = serial_seconds();
  call();
  return serial_seconds() - before;
}

// CPU seconds, whatever else runs; more than these are only the scheduler's own.
constexpr double kStep = 0.004;
constexpr double kSlack = 0.02;

TEST(SerialTimeTest, WhatIsInNoParallelCallCountsAsAWhole) {
  const double part = serial_part([] { compute(10 * kStep); });
  EXPECT_GE(part, 10 * kStep);
  EXPECT_LT(part, 10 * kStep + kSlack);
}

TEST(SerialTimeTest, OfAParallelLoopTheLongestPieceCounts) {
  const double part = serial_part(
      [] { parallel_for(20, [](std::size_t i) { compute(i == 3 ? 2 * kStep : kStep); }); });
  EXPECT_GE(part, 2 * kStep);
  EXPECT_LT(part, 2 * kStep + kSlack);
}

TEST(SerialTimeTest, OfAPipelineItsReadsOrItsSinksCount) {
  for (const bool reads : {false, true}) {
    const double part = serial_part([&] {
      std::size_t next = 0;
      ordered_read_blocks<std::size_t>(
          8, CancelToken(),
          [&](std::size_t& slot) {
            compute(reads ? kStep : 0);
            slot = next++;
            return slot < 20;
          },
          [](std::size_t) { compute(kStep); }, [&](std::size_t) { compute(reads ? 0 : kStep); });
    });
    EXPECT_GE(part, 20 * kStep) << reads;
    EXPECT_LT(part, 21 * kStep + kSlack) << reads;
  }
}

TEST(SerialTimeTest, OfCallsWithinCallsTheOutermostCounts) {
  const double part = serial_part([] {
    parallel_for(20, [](std::size_t) {
      ordered_blocks<int>(
          4, 2, CancelToken(), [](std::size_t, int&) {},
          [](int) {
            compute(kStep);
            return true;
          });
    });
  });
  EXPECT_GE(part, 4 * kStep);
  EXPECT_LT(part, 4 * kStep + kSlack + 16 * kStep)
      << "a piece may do work of another one while it waits";
}

}  // namespace
}  // namespace meshhier::execution
