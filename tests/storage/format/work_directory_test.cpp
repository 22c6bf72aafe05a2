#include "storage/format/work_directory.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/io/forwarding_files.h"
#include "tests/support/beside.h"
#include "tests/support/faulty_file_system.h"

#include <atomic>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;

class WorkDirectoryTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    parent_ = std::filesystem::path(testing::TempDir()) /
              (std::string("work_") + info.name() + std::to_string(::getpid()));
    clean();
    output_ = parent_ / "x.hier";
  }
  void TearDown() override { std::filesystem::remove_all(parent_); }

  void clean() {
    std::filesystem::remove_all(parent_);
    std::filesystem::create_directories(parent_);
  }

  void write(const std::filesystem::path& path, const std::string& text) {
    std::filesystem::create_directories(path.parent_path());
    write_file(*files_, path, std::as_bytes(std::span(text)));
  }

  std::string text_of(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(*files_, path, 1000);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  void put_hierarchy(const std::filesystem::path& directory, const std::string& text) {
    write(manifest_path(directory), text);
    write(tile_path(directory, {}), text + " tile");
  }

  /// "": no hierarchy; the text if it is all there; anything else fails the test.
  std::string hierarchy_at(const std::filesystem::path& directory) {
    if (!std::filesystem::exists(directory))
      return "";
    const std::string text = text_of(manifest_path(directory));
    EXPECT_EQ(text_of(tile_path(directory, {})), text + " tile");
    return text;
  }

  std::set<std::string> names() const {
    std::set<std::string> result;
    for (const auto& entry : std::filesystem::directory_iterator(parent_))
      result.insert(entry.path().filename().string());
    return result;
  }

  template <class Action>
  void expect_error(ErrorCode code, const std::string& part, const Action& action) {
    try {
      action();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  }

  std::unique_ptr<FileSystem> files_ = make_posix_file_system();
  std::filesystem::path parent_;
  std::filesystem::path output_;
};

TEST_F(WorkDirectoryTest, PublishingGivesTheOutputItsNameAndLeavesNothingElse) {
  {
    WorkDirectory work(*files_, output_, false);
    EXPECT_TRUE(std::filesystem::is_directory(work.path()));
    put_hierarchy(work.built(), "new");
    write(work.path() / "scratch", "scratch");
    EXPECT_FALSE(std::filesystem::exists(output_));
    work.publish();
    EXPECT_EQ(hierarchy_at(output_), "new");
    expect_error(ErrorCode::locked, "at work", [&] { WorkDirectory(*files_, output_, true); });
  }
  EXPECT_FALSE(std::filesystem::exists(output_ / "scratch"));
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, WhoWaitsForAnotherOneCanBeStopped) {
  const WorkDirectory work(*files_, output_, false);
  const auto stop = [] { throw Error(ErrorCode::interrupted, "stopped"); };
  expect_error(ErrorCode::interrupted, "stopped",
               [&] { WorkDirectory(*files_, output_, false, stop); });
}

TEST_F(WorkDirectoryTest, WhatIsPublishedStaysWhenTheObjectGoes) {
  {
    WorkDirectory work(*files_, output_, false);
    put_hierarchy(work.built(), "new");
    work.publish();
  }
  EXPECT_EQ(hierarchy_at(output_), "new");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, UnpublishedWorkIsRemoved) {
  {
    WorkDirectory work(*files_, output_, false);
    put_hierarchy(work.built(), "new");
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(WorkDirectoryTest, MissingParentsAreMade) {
  output_ = parent_ / "a" / "b" / "x.hier";
  WorkDirectory work(*files_, output_, false);
  put_hierarchy(work.built(), "new");
  work.publish();
  EXPECT_EQ(hierarchy_at(output_), "new");
}

TEST_F(WorkDirectoryTest, ARelativeOutputIsBesideTheCurrentDirectorysFiles) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(parent_);
  {
    WorkDirectory work(*files_, std::filesystem::path("x.hier"), false);
    put_hierarchy(work.built(), "new");
    work.publish();
  }
  std::filesystem::current_path(before);
  EXPECT_EQ(hierarchy_at(output_), "new");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, AnExistingOutputIsRefusedAndUntouched) {
  put_hierarchy(output_, "old");
  expect_error(ErrorCode::exists, "--force", [&] { WorkDirectory(*files_, output_, false); });
  EXPECT_EQ(hierarchy_at(output_), "old");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, ForceReplacesAHierarchyAndLeavesNothingOfIt) {
  put_hierarchy(output_, "old");
  write(output_ / "tiles" / "07" / "000042.glb", "only in the old one");
  {
    WorkDirectory work(*files_, output_, true);
    EXPECT_EQ(hierarchy_at(output_), "old");
    put_hierarchy(work.built(), "new");
    EXPECT_EQ(hierarchy_at(output_), "old");
    work.publish();
  }
  EXPECT_EQ(hierarchy_at(output_), "new");
  EXPECT_FALSE(std::filesystem::exists(output_ / "tiles" / "07"));
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, ForceWithNothingThereIsNoError) {
  WorkDirectory work(*files_, output_, true);
  put_hierarchy(work.built(), "new");
  work.publish();
  EXPECT_EQ(hierarchy_at(output_), "new");
}

TEST_F(WorkDirectoryTest, AFailedBuildLeavesTheOldHierarchy) {
  put_hierarchy(output_, "old");
  {
    WorkDirectory work(*files_, output_, true);
    put_hierarchy(work.built(), "half of the new one");
  }
  EXPECT_EQ(hierarchy_at(output_), "old");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, ForceNeverReplacesWhatIsNoHierarchy) {
  write(output_ / "thesis.tex", "years of work");
  expect_error(ErrorCode::exists, "not a hierarchy",
               [&] { WorkDirectory(*files_, output_, true); });
  EXPECT_EQ(text_of(output_ / "thesis.tex"), "years of work");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, ForceNeverReplacesWhatHoldsMoreThanAHierarchy) {
  for (const char* name : {"notes.txt", "tiles/00/000000.ply", "more/000000.glb"}) {
    clean();
    put_hierarchy(output_, "old");
    write(output_ / name, "years of work");
    expect_error(ErrorCode::exists, name, [&] { WorkDirectory(*files_, output_, true); });
    EXPECT_EQ(text_of(output_ / name), "years of work");
  }
}

TEST_F(WorkDirectoryTest, NoHierarchyIsMadeInAnother) {
  put_hierarchy(output_, "outer");
  write(index_path(output_), "tiles");
  for (const char* name : {"inner.hier", "tiles/inner.hier"}) {
    expect_error(ErrorCode::usage, "in the hierarchy",
                 [&] { WorkDirectory(*files_, output_ / name, false); });
  }
  EXPECT_EQ(hierarchy_at(output_), "outer");
}

TEST_F(WorkDirectoryTest, ALinkInItsPlaceIsNotFollowed) {
  write(parent_ / "precious" / "thesis.tex", "years of work");
  std::filesystem::create_directory_symlink("precious", work_path(output_));
  expect_error(ErrorCode::io, "is a link", [&] { WorkDirectory(*files_, output_, true); });
  EXPECT_EQ(text_of(parent_ / "precious" / "thesis.tex"), "years of work");
}

// Each is told what it is told, and one of them wins, whoever comes just as another one ends.
TEST_F(WorkDirectoryTest, ManyAtOnceMakeOne) {
  for (int round = 0; round < 20; ++round) {
    clean();
    std::atomic<int> made = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        const auto files = make_posix_file_system();
        try {
          WorkDirectory work(*files, output_, false);
          put_hierarchy(work.built(), "new");
          work.publish();
          ++made;
        } catch (const Error& error) {
          EXPECT_THAT(error.code(),  // locked: where the disk takes seconds for the others
                      testing::AnyOf(ErrorCode::exists, ErrorCode::locked))
              << error.what();
        }
      });
    }
    for (std::thread& thread : threads)
      thread.join();
    EXPECT_EQ(made, 1);
    EXPECT_EQ(hierarchy_at(output_), "new");
  }
}

TEST_F(WorkDirectoryTest, ForceNeverReplacesAFile) {
  write(output_, "a file");
  expect_error(ErrorCode::exists, output_.string(), [&] { WorkDirectory(*files_, output_, true); });
  EXPECT_EQ(text_of(output_), "a file");
}

TEST_F(WorkDirectoryTest, AnArchiveIsPublishedAsOneFile) {
  const Output output(parent_ / "x.3tz", storage::Container::archive);
  for (const char* content : {"one", "two"}) {
    if (std::filesystem::exists(output.path))
      std::filesystem::remove(output.path);
    {
      WorkDirectory work(*files_, output, false);
      put_hierarchy(work.built(), "packed already");
      write(work.packed(), content);
      work.publish();
    }
    EXPECT_EQ(text_of(output.path), content);
    EXPECT_THAT(names(), ElementsAre("x.3tz"));
  }
}

TEST_F(WorkDirectoryTest, ForceReplacesLikeByLikeOnly) {
  const auto refused = [&](const Output& output, const char* why) {
    expect_error(ErrorCode::exists, why, [&] { WorkDirectory(*files_, output, true); });
  };
  put_hierarchy(output_, "old");
  refused({output_, storage::Container::archive}, "is a directory, and one file is to be made");
  const std::filesystem::path file = parent_ / "x.3tz";
  write(file, "a text");
  refused(file, "is a file, and a directory is to be made");
  refused({file, storage::Container::archive}, "is not the archive of a hierarchy");
  EXPECT_EQ(text_of(file), "a text");
  EXPECT_EQ(hierarchy_at(output_), "old");
}

TEST_F(WorkDirectoryTest, ForceNeverReplacesWhatAppearedDuringTheBuildAndIsNoHierarchy) {
  {
    WorkDirectory work(*files_, output_, true);
    put_hierarchy(work.built(), "new");
    write(output_ / "thesis.tex", "years of work");
    expect_error(ErrorCode::exists, output_.string(), [&] { work.publish(); });
  }
  ASSERT_TRUE(std::filesystem::exists(output_ / "thesis.tex"));
  EXPECT_EQ(text_of(output_ / "thesis.tex"), "years of work");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, WithoutForceWhatAppearedDuringTheBuildStays) {
  {
    WorkDirectory work(*files_, output_, false);
    put_hierarchy(work.built(), "new");
    put_hierarchy(output_, "another's");
    expect_error(ErrorCode::exists, "appeared", [&] { work.publish(); });
  }
  EXPECT_EQ(hierarchy_at(output_), "another's");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, WhatAKilledBuildLeftIsFound) {
  write(tile_path(built_path(work_path(output_)), {}), "half");
  write(work_path(output_) / "scratch", "scratch");
  write(lock_path(work_path(output_)), "");
  {
    WorkDirectory work(*files_, output_, false);
    EXPECT_EQ(text_of(tile_path(work.built(), {})), "half");
    EXPECT_EQ(text_of(work.path() / "scratch"), "scratch");
    work.clear();
    EXPECT_FALSE(std::filesystem::exists(work.built()));
    EXPECT_FALSE(std::filesystem::exists(work.path() / "scratch"));
    put_hierarchy(work.built(), "new");
    work.publish();
  }
  EXPECT_EQ(hierarchy_at(output_), "new");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

TEST_F(WorkDirectoryTest, WhatIsKeptIsThereForTheNextOne) {
  {
    WorkDirectory work(*files_, output_, false);
    write(work.path() / "scratch", "scratch");
    work.keep(true);
  }
  WorkDirectory work(*files_, output_, false);
  EXPECT_EQ(text_of(work.path() / "scratch"), "scratch");
}

// Killed at any call of publish(): the journal is found as long as what it tells of is there.
TEST_F(WorkDirectoryTest, AJournalThatWasSetAsideIsFoundAgain) {
  constexpr std::uint64_t kForever = std::uint64_t{1} << 40;
  for (std::uint64_t last = 1; last < 40; ++last) {
    SCOPED_TRACE(last);
    clean();
    put_hierarchy(output_, "old");
    tests::FaultyFileSystem files;
    {
      WorkDirectory work(files, output_, true);
      work.keep(true);
      put_hierarchy(work.built(), "new");
      write(journal_path(work.path()), "what is done");
      files.fail(Call::any, last, kForever);
      try {
        work.publish();
      } catch (const Error&) {
      }
    }
    const std::string shown = hierarchy_at(output_);
    EXPECT_TRUE(shown == "old" || shown == "new");
    const WorkDirectory next(*files_, output_, true);
    const bool is_there = std::filesystem::exists(journal_path(next.path()));
    if (is_there) {
      EXPECT_EQ(hierarchy_at(next.built()), "new");
    }
    EXPECT_TRUE(is_there || shown == "new") << "the work is lost";
  }
}

TEST_F(WorkDirectoryTest, OneAtATime) {
  WorkDirectory work(*files_, output_, false);
  write(work.path() / "scratch", "scratch");
  expect_error(ErrorCode::locked, "at work", [&] { WorkDirectory(*files_, output_, false); });
  EXPECT_EQ(text_of(work.path() / "scratch"), "scratch");
  put_hierarchy(work.built(), "new");
  work.publish();
  EXPECT_EQ(hierarchy_at(output_), "new");
}

TEST_F(WorkDirectoryTest, TheReplacedHierarchyOfAKilledBuildIsRemovedInTheEnd) {
  put_hierarchy(replaced_path(output_), "old");
  {
    WorkDirectory work(*files_, output_, false);
    put_hierarchy(work.built(), "new");
    work.publish();
  }
  EXPECT_EQ(hierarchy_at(output_), "new");
  EXPECT_THAT(names(), ElementsAre("x.hier"));
}

// A kill between the two renames of a replacement leaves the old hierarchy under its side name. It
// is the only one then, until another has taken its place.
TEST_F(WorkDirectoryTest, TheReplacedHierarchyOfAKilledBuildOutlivesAFailedPublish) {
  FaultyFileSystem files;
  put_hierarchy(replaced_path(output_), "old");
  {
    WorkDirectory work(files, output_, false);
    put_hierarchy(work.built(), "new");
    files.fail(Call::rename, 1);
    expect_error(ErrorCode::io, "injected", [&] { work.publish(); });
  }
  EXPECT_FALSE(std::filesystem::exists(output_));
  EXPECT_EQ(hierarchy_at(replaced_path(output_)), "old");
}

TEST_F(WorkDirectoryTest, AParentThatIsAFileIsAnError) {
  write(parent_ / "file", "text");
  expect_error(ErrorCode::io, "file",
               [&] { WorkDirectory(*files_, parent_ / "file" / "x.hier", false); });
  EXPECT_EQ(text_of(parent_ / "file"), "text");
}

TEST_F(WorkDirectoryTest, CleaningUpThatFailsDoesNotEndTheProgram) {
  FaultyFileSystem files;
  {
    const WorkDirectory work(files, output_, false);
    files.fail(Call::remove_all, 1, 1000);
  }
  EXPECT_THAT(names(), ElementsAre(work_path(output_).filename().string()));
}

// Where each removes what it has made, no one's files go with another's.
TEST_F(WorkDirectoryTest, WhoTakesADirectoryThatAnotherLeavesKeepsWhatIsHis) {
  const auto path = work_path(output_);
  const auto take_and_leave = [&] {
    auto lock = take_work(*files_, path);
    if (!lock)
      return true;
    bool is_mine = true;
    for (int file = 0; file < 20; ++file)
      write_file(*files_, path / std::to_string(file), {});
    for (int file = 0; file < 20; ++file)
      is_mine = is_mine && files_->exists(path / std::to_string(file));
    is_mine = is_mine && files_->is_locked(lock_path(path));
    remove_work(*files_, path, std::move(lock));
    return is_mine;
  };
  const auto often = [&] {
    for (int i = 0; i < 2000; ++i) {
      if (!take_and_leave())
        return false;
    }
    return true;
  };
  EXPECT_TRUE(tests::do_beside(often, [&] { EXPECT_TRUE(take_and_leave()); }));
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(WorkDirectoryTest, ABuildThatGivesUpLeavesTheFolderToOnesThatBeginThere) {
  const auto folder = parent_ / "a" / "b";
  {
    const WorkDirectory work(*files_, folder / "x.hier", false);
    files_->make_directories(work_path(folder / "y.hier"));
  }
  EXPECT_TRUE(std::filesystem::exists(work_path(folder / "y.hier")));
  std::filesystem::remove_all(parent_ / "a");
  { const WorkDirectory work(*files_, folder / "x.hier", false); }
  EXPECT_THAT(names(), IsEmpty()) << "nobody else was there";
}

TEST_F(WorkDirectoryTest, WhatAppearsAtTheLastMomentIsNotReplaced) {
  /// Another program puts a file there just before it gets its name.
  class Late final : public ForwardingFiles {
   public:
    Late(FileSystem& others, std::filesystem::path place)
        : ForwardingFiles(others), place_(std::move(place)) {}
    bool exists(const std::filesystem::path& path) override {
      const bool is_there = ForwardingFiles::exists(path);
      if (is_late && path == place_ && !is_there)
        write_file(others(), path, {});
      return is_there;
    }
    bool is_late = false;

   private:
    std::filesystem::path place_;
  };
  output_ = parent_ / "x.3tz";
  Late late(*files_, output_);
  {
    WorkDirectory work(late, {output_, Container::archive}, false);
    write(work.packed(), "archive");
    late.is_late = true;
    expect_error(ErrorCode::exists, "appeared", [&] { work.publish(); });
  }
  EXPECT_EQ(text_of(output_), "");
}

TEST_F(WorkDirectoryTest, WhatAViewLeavesInAHierarchyIsReplacedWithIt) {
  put_hierarchy(output_, "old");
  write(output_lock_path(manifest_path(output_)), "");
  write(unfinished_path(manifest_path(output_)), "half a manifest");
  {
    WorkDirectory work(*files_, output_, true);
    put_hierarchy(work.built(), "new");
    work.publish();
  }
  EXPECT_EQ(hierarchy_at(output_), "new");
  EXPECT_FALSE(std::filesystem::exists(unfinished_path(manifest_path(output_))));
}

class EveryFault : public WorkDirectoryTest, public testing::WithParamInterface<bool> {
 protected:
  /// Runs a build with the n-th call of a kind failing; false if there are not so many calls.
  bool build_with_fault(Call call, std::uint64_t n) {
    clean();
    if (GetParam())
      put_hierarchy(output_, "old");
    FaultyFileSystem files;
    files.fail(call, n);
    threw_ = false;
    try {
      WorkDirectory work(files, output_, GetParam());
      put_hierarchy(work.built(), "new");
      work.publish();
    } catch (const Error& error) {
      threw_ = true;
      EXPECT_EQ(error.code(), ErrorCode::io);
    }
    return files.calls(call) >= n;
  }

  bool threw_ = false;
};

TEST_P(EveryFault, LeavesACompleteHierarchyOrNone) {
  const std::string before = GetParam() ? "old" : "";
  for (const Call call :
       {Call::make_directories, Call::remove_all, Call::rename, Call::sync_tree}) {
    for (std::uint64_t n = 1; build_with_fault(call, n); ++n) {
      const std::string found = hierarchy_at(output_);
      EXPECT_TRUE(found == before || found == "new") << found;
      if (!threw_) {
        EXPECT_EQ(found, "new");
      }
    }
  }
}

TEST_P(EveryFault, LeavesNothingBesideItUnlessRemovingItselfFails) {
  for (const Call call : {Call::make_directories, Call::rename, Call::sync_tree}) {
    for (std::uint64_t n = 1; build_with_fault(call, n); ++n) {
      std::set<std::string> found = names();
      found.erase("x.hier");
      EXPECT_THAT(found, IsEmpty()) << "kind " << static_cast<int>(call) << ", call " << n;
    }
  }
}

TEST_P(EveryFault, ThatIsToldLeavesTheOutputAsItWas) {
  const std::string before = GetParam() ? "old" : "";
  for (const Call call : {Call::make_directories, Call::rename, Call::sync_tree}) {
    for (std::uint64_t n = 1; build_with_fault(call, n); ++n) {
      EXPECT_TRUE(threw_);
      EXPECT_EQ(hierarchy_at(output_), before) << "kind " << static_cast<int>(call) << ", " << n;
    }
  }
}

TEST_P(EveryFault, IsForgottenByTheNextBuild) {
  for (const Call call :
       {Call::make_directories, Call::remove_all, Call::rename, Call::sync_tree}) {
    for (std::uint64_t n = 1; build_with_fault(call, n); ++n) {
      {
        WorkDirectory work(*files_, output_, true);
        put_hierarchy(work.built(), "newer");
        work.publish();
      }
      EXPECT_EQ(hierarchy_at(output_), "newer");
      EXPECT_THAT(names(), ElementsAre("x.hier"));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(WorkDirectory, EveryFault, testing::Bool(),
                         [](const auto& test) { return test.param ? "Replacing" : "New"; });

}  // namespace
}  // namespace meshhier::storage
