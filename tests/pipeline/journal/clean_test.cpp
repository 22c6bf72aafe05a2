#include "pipeline/journal/clean.h"

#include "storage/format/work_directory.h"
#include "storage/format/work_folder.h"
#include "tests/support/beside.h"
#include "tests/support/sample_hierarchy.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

class CleanTest : public testing::Test {
 protected:
  fs::path place(const char* name) const { return directory_.path() / name; }
  /// Leaves what a stopped build does.
  fs::path leave_work(const char* output) {
    const fs::path work = storage::work_path(place(output));
    files_->make_directories(work);
    storage::write_file(*files_, storage::journal_path(work), {});
    return work;
  }
  std::vector<FoundLeftover> find() { return find_leftovers(*files_, directory_.path()); }
  std::string remove(std::vector<FoundLeftover> found) {
    remove_leftovers(*files_, found);
    return leftovers_text(found, true);
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(CleanTest, ABuildThatGoesOnSinceItWasFoundKeepsItsWork) {
  const fs::path work = leave_work("a.hier");
  const std::vector<FoundLeftover> found = find();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_FALSE(found[0].in_use);
  auto lock = storage::take_work(*files_, work);
  EXPECT_THAT(remove(found), HasSubstr("a build at work: stays"));
  EXPECT_TRUE(files_->exists(storage::journal_path(work)));
  lock.reset();
  EXPECT_THAT(remove(find()), HasSubstr("removed"));
  EXPECT_FALSE(files_->exists(work));
}

TEST_F(CleanTest, FilesThatAreBeingWrittenStay) {
  storage::OutputFile file(*files_, {place("a.ply")});
  const storage::WorkFolder folder(*files_, place("b.hier"));
  EXPECT_THAT(remove(find()), testing::Not(HasSubstr("removed")));
  EXPECT_TRUE(files_->exists(folder.path()));
  file.publish({});
  EXPECT_TRUE(files_->exists(place("a.ply")));
}

TEST_F(CleanTest, WhatKilledCommandsLeftGoes) {
  for (const fs::path& path :
       {storage::unfinished_path(place("a.ply")), storage::scratch_path(place("a.ply")),
        storage::output_lock_path(place("a.ply")), storage::verify_scratch_path(place("b.hier"), 1),
        storage::work_path(place("c.hier"))})
    storage::write_file(*files_, path, {});
  files_->make_directories(storage::verify_scratch_path(place("b.hier"), 2));
  files_->make_directories(directory_.path() / "elsewhere");
  fs::create_symlink(directory_.path() / "elsewhere", storage::work_path(place("d.hier")));
  EXPECT_THAT(find(), SizeIs(7));
  remove(find());
  EXPECT_THAT(files_->children(directory_.path()), testing::ElementsAre(place("elsewhere")));
}

TEST_F(CleanTest, NothingTakesThePlaceOfAHierarchyThatIsThereByNow) {
  const fs::path old = storage::replaced_path(place("a.3tz"));
  storage::write_file(*files_, old, {});
  const std::vector<FoundLeftover> found = find();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_TRUE(found[0].only_copy);
  storage::write_file(*files_, place("a.3tz"), std::as_bytes(std::span("new")));
  EXPECT_THAT(remove(found), HasSubstr("that was replaced: removed"));
  EXPECT_EQ(files_->identity(place("a.3tz")).bytes, 4U);
}

TEST_F(CleanTest, TheOnlyCopyStaysIfItIsThatByNow) {
  const fs::path old = storage::replaced_path(place("a.3tz"));
  storage::write_file(*files_, place("a.3tz"), {});
  storage::write_file(*files_, old, {});
  const std::vector<FoundLeftover> found = find();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_FALSE(found[0].only_copy);
  files_->remove_all(place("a.3tz"));
  EXPECT_THAT(remove(found), HasSubstr(": stays"));
  EXPECT_TRUE(files_->exists(old));
}

TEST_F(CleanTest, BuildsMayComeAndGoWhileTheyAreLookedFor) {
  const auto come_and_go = [&] {
    int begun = 0;
    for (int i = 0; i < 1000; ++i) {
      const fs::path work = storage::work_path(place("a.hier"));
      auto lock = storage::take_work(*files_, work);
      if (!lock)
        continue;
      ++begun;
      files_->make_directories(work / "tiles" / "00");
      storage::write_file(*files_, work / "tiles" / "00" / "0", {});
      storage::write_file(*files_, work / "scratch", {});
      if (!files_->exists(work / "scratch"))
        return false;
      if (i % 2 == 0)
        storage::remove_work(*files_, work, std::move(lock));
    }
    return begun > 0;
  };
  EXPECT_TRUE(tests::do_beside(come_and_go, [&] { remove(find()); }));
}

}  // namespace
}  // namespace meshhier::pipeline
