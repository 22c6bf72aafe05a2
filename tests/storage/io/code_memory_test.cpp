#include "storage/io/code_memory.h"

#include <cstdlib>

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>

namespace meshhier::storage {
namespace {

/// prctl()'s words of Linux 6.3, which older headers lack.
constexpr int kSetDenyWriteExecute = 65, kRefuseExecGain = 1;
constexpr int kNotKnown = 77;  ///< to older systems

[[noreturn]] void deny_and_ask() {
  if (::prctl(kSetDenyWriteExecute, kRefuseExecGain, 0, 0, 0) != 0)
    std::exit(kNotKnown);
  std::exit(may_make_code() ? 1 : 0);
}

TEST(CodeMemoryTest, TellsThatMemoryMayNotBecomeExecutable) {
  EXPECT_TRUE(may_make_code());
  const auto is_told_or_not_known = [](int status) {
    return WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == kNotKnown);
  };
  EXPECT_EXIT(deny_and_ask(), is_told_or_not_known, "");
}

}  // namespace
}  // namespace meshhier::storage
