#include "storage/io/usable_memory.h"

#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

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
  std::uint64_t usable() const { return usable_memory(directory_.path()); }

  tests::TemporaryDirectory directory_;
};

TEST_F(UsableMemoryTest, IsThatOfTheMachineWithoutGroups) {
  const std::uint64_t all = usable();
  EXPECT_GT(all, std::uint64_t{64} << 20);
  for (const char* nothing : {"", "\n", "x", ":", "::", "0::", "0::/\n", "4:cpu,cpuset:/a\n"}) {
    put("proc/self/cgroup", nothing);
    EXPECT_EQ(usable(), all) << nothing;
  }
  EXPECT_LE(usable_memory(), all);
}

TEST_F(UsableMemoryTest, IsTheLeastLimitOfAGroupAndThoseAboveIt) {
  put("proc/self/cgroup", "0::/user.slice/a:b/job\n");
  put("sys/fs/cgroup/user.slice/memory.max", "50000\n");
  put("sys/fs/cgroup/user.slice/a:b/memory.max", "max\n");
  EXPECT_EQ(usable(), 50'000U);
  put("sys/fs/cgroup/user.slice/a:b/job/memory.max", "40000\n");
  EXPECT_EQ(usable(), 40'000U);
  put("sys/fs/cgroup/memory.max", "30000\n");
  EXPECT_EQ(usable(), 30'000U) << "in a container the path is from its own root";
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
