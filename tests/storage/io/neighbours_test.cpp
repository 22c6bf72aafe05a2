#include "storage/io/neighbours.h"

#include "base/error.h"
#include "storage/io/descriptor.h"
#include "storage/io/file.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

class NeighboursTest : public testing::Test {
 protected:
  fs::path path(const char* name) const { return fs::canonical(directory_.path()) / name; }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<FileSystem> files_ = make_posix_file_system();
};

TEST_F(NeighboursTest, TheTopmostDirectoryIsOnTheSameFileSystem) {
  const fs::path root = file_system_root(directory_.path());
  EXPECT_EQ(fs::relative(path("a"), root), path("a").lexically_relative(root)) << root;
  EXPECT_EQ(file_system_root(root), root);
  EXPECT_EQ(file_system_root("/proc/self/fd"), "/proc");
  EXPECT_EQ(file_system_root(path("none")), "");
}

TEST_F(NeighboursTest, FilesAreFoundAsLongAsTheirLocksAreHeld) {
  const auto has = [&](const char* ending) {
    const std::vector<fs::path> found = locked_files(directory_.path(), ending);
    return std::ranges::count(found, path("mesh-lock"));
  };
  auto lock = files_->try_lock(path("mesh-lock"));
  EXPECT_EQ(has("/mesh-lock"), 1);
  EXPECT_EQ(has("/other"), 0);
  fs::create_symlink(path("mesh-lock"), path("link-lock"));
  EXPECT_EQ(has("-lock"), 1);
  lock.reset();
  EXPECT_EQ(has("/mesh-lock"), 0);
  EXPECT_TRUE(locked_files("/there/is/none", "").empty());
}

TEST_F(NeighboursTest, WhoAsksForALockMakesNoneAndTakesNone) {
  EXPECT_FALSE(files_->is_locked(path("none")));
  EXPECT_FALSE(fs::exists(path("none")));
  auto lock = files_->try_lock(path("lock"));
  EXPECT_TRUE(files_->is_locked(path("lock")));
  EXPECT_TRUE(files_->is_locked(path("lock"))) << "again";
  fs::create_symlink(path("lock"), path("link"));
  EXPECT_FALSE(files_->is_locked(path("link")));
  lock.reset();
  EXPECT_FALSE(files_->is_locked(path("lock")));
  EXPECT_NE(files_->try_lock(path("lock")), nullptr);
}

TEST_F(NeighboursTest, ASharedLockOfOthersIsNotWaitedFor) {
  write_file(*files_, path("lock"), {});
  const Descriptor other(::open(path("lock").c_str(), O_RDONLY | O_CLOEXEC));
  ASSERT_EQ(::flock(other.number(), LOCK_SH), 0);
  EXPECT_EQ(files_->try_lock(path("lock")), nullptr);
}

TEST_F(NeighboursTest, NoLockIsTakenThroughALink) {
  fs::create_symlink(path("elsewhere"), path("lock"));
  EXPECT_THROW(files_->try_lock(path("lock")), Error);
  EXPECT_FALSE(fs::exists(path("elsewhere")));
}

}  // namespace
}  // namespace meshhier::storage
