#include "storage/io/process.h"

#include "tests/support/sizes.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace meshhier::storage {
namespace {

using tests::kMiB;

// The system's own counts are this exact at the worst.

/// Keeps the compiler from leaving the work out.
volatile unsigned sink = 0;

void work() {
  for (unsigned i = 0; i < 50'000'000; ++i)
    sink = sink + i;
}

TEST(ProcessTest, WorkTakesTimeAndTimeOnlyGrows) {
  const ProcessUsage before = process_usage();
  work();
  const ProcessUsage after = process_usage();
  EXPECT_GT(after.user_seconds + after.system_seconds, before.user_seconds + before.system_seconds);
  EXPECT_GE(after.user_seconds, before.user_seconds);
  EXPECT_GE(after.system_seconds, before.system_seconds);
}

TEST(ProcessTest, ThePeakGrowsWithWhatIsTouchedAndStays) {
  const std::uint64_t before = process_usage().peak_resident_bytes;
  EXPECT_GT(before, kMiB);
  std::uint64_t during = 0;
  {
    // More than is resident now, so that it cannot be room that was touched before.
    std::vector<std::byte> bytes(before + 64 * kMiB);
    for (std::size_t i = 0; i < bytes.size(); i += 1024)
      bytes[i] = std::byte{1};
    sink = sink + static_cast<unsigned>(bytes[bytes.size() / 2]);
    during = process_usage().peak_resident_bytes;
    EXPECT_GE(during + kMiB, bytes.size());
  }
  EXPECT_GE(process_usage().peak_resident_bytes + kMiB, during);
}

TEST(ProcessTest, ThePeakIsWhatTheSystemCountsForParents) {
  const ProcessUsage usage = process_usage();
  rusage system{};
  ASSERT_EQ(getrusage(RUSAGE_SELF, &system), 0);
  EXPECT_LE(usage.peak_resident_bytes, static_cast<std::uint64_t>(system.ru_maxrss) * 1024 + kMiB);
}

}  // namespace
}  // namespace meshhier::storage
