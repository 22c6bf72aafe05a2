#include "pipeline/plan/disk_claims.h"

#include "storage/format/layout.h"
#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

class DiskClaimsTest : public testing::Test {
 protected:
  std::filesystem::path output(const char* name) const { return directory_.path() / name; }
  /// Takes the work directory of an output.
  std::unique_ptr<storage::FileLock> begin(const char* name) {
    files_->make_directories(storage::work_path(output(name)));
    return files_->try_lock(storage::lock_path(storage::work_path(output(name))));
  }

  storage::ScratchUse use_;
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(DiskClaimsTest, WhatOthersWillYetWriteCounts) {
  auto first = begin("a.hier");
  const auto work = storage::work_path(output("a.hier"));
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 0U) << "nothing is claimed yet";
  claim_disk(work, 5'000'000'000, *files_, use_);
  claim_disk(work, 1000, *files_, use_);
  const auto second = begin("c.hier");
  claim_disk(storage::work_path(output("c.hier")), 2000, *files_, use_);
  constexpr std::uint64_t kNotes = 20;  // a claim itself
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 3000U - 2 * kNotes);
  EXPECT_EQ(claimed_beside(output("a.hier"), *files_), 2000U - kNotes) << "not its own";
  std::ofstream(work / "tiles") << std::string(300, 'x');
  EXPECT_EQ(claimed_beside(output("c.hier"), *files_), 700U - kNotes);
  std::ofstream(work / "tiles") << std::string(3000, 'x');
  EXPECT_EQ(claimed_beside(output("c.hier"), *files_), 0U) << "it takes more than it claimed";
  first.reset();
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 2000U - kNotes) << "it was stopped";
}

TEST_F(DiskClaimsTest, WhatIsNoClaimCountsForNothing) {
  const auto lock = begin("a.hier");
  std::ofstream(storage::lock_path(storage::work_path(output("a.hier")))) << "no number";
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 0U);
  EXPECT_EQ(claimed_beside(output("there/is/none.hier"), *files_), 0U);
}

}  // namespace
}  // namespace meshhier::pipeline
