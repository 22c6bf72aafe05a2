#include "storage/io/usable_memory.h"

#include "storage/io/process_state.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

class UsableMemoryTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) const {
    const fs::path path = directory_.path() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << content;
  }
  std::uint64_t usable() const { return usable_memory(directory_.path()).bytes; }
  MemoryBound bound() const { return usable_memory(directory_.path()).bound; }

  tests::TemporaryDirectory directory_;
};

TEST_F(UsableMemoryTest, IsThatOfTheMachineWithoutGroups) {
  const std::uint64_t all = usable();
  EXPECT_GT(all, std::uint64_t{64} << 20);
  for (const char* nothing : {"", "\n", "x", ":", "::", "0::", "0::/\n", "4:cpu,cpuset:/a\n"}) {
    put("proc/self/cgroup", nothing);
    EXPECT_EQ(usable(), all) << nothing;
  }
  EXPECT_EQ(bound(), MemoryBound::machine);
  EXPECT_LE(usable_memory().bytes, all);
}

TEST_F(UsableMemoryTest, IsTheLeastLimitOfAGroupAndThoseAboveIt) {
  put("proc/self/cgroup", "0::/user.slice/a:b/job\n");
  put("sys/fs/cgroup/user.slice/memory.max", "50000\n");
  put("sys/fs/cgroup/user.slice/a:b/memory.max", "max\n");
  EXPECT_EQ(usable(), 50'000U);
  EXPECT_EQ(bound(), MemoryBound::group);
  put("sys/fs/cgroup/user.slice/a:b/job/memory.max", "40000\n");
  EXPECT_EQ(usable(), 40'000U);
  put("sys/fs/cgroup/memory.max", "30000\n");
  EXPECT_EQ(usable(), 30'000U) << "in a container the path is from its own root";
  put("sys/fs/cgroup/user.slice/memory.high", "20000\n");
  EXPECT_EQ(usable(), 20'000U) << "beyond that a group is slowed down";
}

TEST_F(UsableMemoryTest, KnowsTheLimitsOfTheProcess) {
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 46;  // sanitizers map 20 TiB
  const std::uint64_t all = usable();
  for (const auto& [resource, expected] : {std::pair{RLIMIT_AS, MemoryBound::address_space},
                                           std::pair{RLIMIT_DATA, MemoryBound::data}}) {
    rlimit before{};
    ASSERT_EQ(getrlimit(resource, &before), 0);
    rlimit lower{std::min<rlim_t>(before.rlim_max, kLimit), before.rlim_max};
    setrlimit(resource, &lower);
    EXPECT_EQ(usable(), all) << "the machine has less";
    if (process_state().virtual_bytes < all / 4) {  // else sanitizers could map nothing any more
      lower.rlim_cur = all / 2;
      setrlimit(resource, &lower);
      EXPECT_LE(usable(), all / 2);
      EXPECT_EQ(bound(), expected);
    }
    setrlimit(resource, &before);
  }
}

TEST_F(UsableMemoryTest, KnowsGroupsOfTheFirstVersion) {
  put("proc/self/cgroup", "5:cpu:/job\n4:memory,hugetlb:/job\n1:name=systemd:/x\n0::/\n");
  put("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "70000\n");
  put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  put("sys/fs/cgroup/cpu/job/memory.limit_in_bytes", "1\n");
  EXPECT_EQ(usable(), 70'000U);
}

}  // namespace
}  // namespace meshhier::storage
