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

// CPU seconds, whatever else runs.
constexpr double kStep = 0.004;
constexpr double kSlack = 0.02;  // the scheduler's own

/// Checks that a call takes so much serial time, and at most so much more. A virtual machine may
/// count what its host took from it, so one try of several is enough for the latter.
template <class Call>
void expect_serial_part(double expected, double more, const Call& call) {
  constexpr int kMostTries = 20;
  double part = expected + more;
  for (int tries = 0; part >= expected + more && tries < kMostTries; ++tries) {
    const double before = serial_seconds();
    call();
    part = serial_seconds() - before;
    EXPECT_GE(part, expected);
  }
  EXPECT_LT(part, expected + more);
}

TEST(SerialTimeTest, WhatIsInNoParallelCallCountsAsAWhole) {
  expect_serial_part(10 * kStep, kSlack, [] { compute(10 * kStep); });
}

TEST(SerialTimeTest, OfAParallelLoopTheLongestPieceCounts) {
  expect_serial_part(2 * kStep, kSlack, [] {
    parallel_for(20, [](std::size_t i) { compute(i == 3 ? 2 * kStep : kStep); });
  });
}

TEST(SerialTimeTest, OfAPipelineItsReadsOrItsSinksCount) {
  for (const bool reads : {false, true}) {
    expect_serial_part(20 * kStep, kStep + kSlack, [&] {
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
  }
}

// A piece may do work of another one while it waits.
TEST(SerialTimeTest, OfCallsWithinCallsTheOutermostCounts) {
  expect_serial_part(4 * kStep, kSlack + 16 * kStep, [] {
    parallel_for(20, [](std::size_t) {
      ordered_blocks<int>(
          4, 2, CancelToken(), [](std::size_t, int&) {},
          [](int) {
            compute(kStep);
            return true;
          });
    });
  });
}

}  // namespace
}  // namespace meshhier::execution
