#include "pipeline/plan/disk_claims.h"

#include "base/error.h"
#include "pipeline/plan/build_plan.h"
#include "storage/format/layout.h"
#include "storage/io/forwarding_files.h"
#include "storage/io/neighbours.h"
#include "tests/support/beside.h"
#include "tests/support/error_message.h"
#include "tests/support/sample_hierarchy.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace meshhier::pipeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kNoteBytes = 20;  // a claim itself

/// Sees what the processes of one test have locked, not other builds on this machine.
class FilesOfTest : public storage::ForwardingFiles, public storage::SharedFileSystem {
 public:
  FilesOfTest(storage::FileSystem& real, const std::filesystem::path& directory)
      : ForwardingFiles(real), below_(real.canonical(directory).string() + '/') {}

  std::vector<std::filesystem::path> locked_files(const std::filesystem::path& directory,
                                                  std::string_view ending) const override {
    auto found = storage::locked_files(directory, ending);
    std::erase_if(found, [this](const std::filesystem::path& path) {
      return !path.native().starts_with(below_);
    });
    return found;
  }

 private:
  std::string below_;
};

/// Locks are seen by nobody else, so what they claim is in no other build's way.
class HiddenLocks final : public storage::ForwardingFiles {
 public:
  using ForwardingFiles::ForwardingFiles;
  std::unique_ptr<storage::FileLock> try_lock(const std::filesystem::path& path) override {
    create(path);
    return std::make_unique<storage::FileLock>();
  }
  bool is_locked(const std::filesystem::path& path) override { return exists(path); }
};

/// Lists a file that goes before it is looked at.
class RestlessFiles final : public FilesOfTest {
 public:
  using FilesOfTest::FilesOfTest;
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override {
    auto found = FilesOfTest::list(directory);
    found.push_back(directory / "was there");
    return found;
  }
};

/// Returns whether every user may go through a directory and all above it.
bool is_open_to_all(std::filesystem::path directory) {
  using std::filesystem::perms;
  const auto is_closed = [](const std::filesystem::path& path) {
    return (std::filesystem::status(path).permissions() & perms::others_exec) == perms::none;
  };
  while (directory != directory.root_path() && !is_closed(directory))
    directory = directory.parent_path();
  return directory == directory.root_path();
}

class DiskClaimsTest : public testing::Test {
 protected:
  std::filesystem::path output(const char* name) const { return directory_.path() / name; }
  /// Takes the work directory of an output.
  std::unique_ptr<storage::FileLock> begin(const char* name) {
    files_->make_directories(storage::work_path(output(name)));
    return files_->try_lock(storage::lock_path(storage::work_path(output(name))));
  }

  void claim(const std::filesystem::path& work, std::uint64_t bytes) {
    claim_disk(work, bytes, *files_, use_, [] {});
  }

  storage::ScratchUse use_;
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> real_ = storage::make_posix_file_system();
  std::unique_ptr<storage::FileSystem> files_ =
      std::make_unique<FilesOfTest>(*real_, directory_.path());
};

TEST_F(DiskClaimsTest, WhatOthersWillYetWriteCounts) {
  auto first = begin("a.hier");
  const auto work = storage::work_path(output("a.hier"));
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 0U) << "nothing is claimed yet";
  claim(work, 5'000'000);
  claim(work, 1000);
  const auto second = begin("c.hier");
  claim(storage::work_path(output("c.hier")), 2000);
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 3000U - 2 * kNoteBytes);
  EXPECT_EQ(claimed_beside(output("a.hier"), *files_), 2000U - kNoteBytes) << "not its own";
  std::ofstream(work / "tiles") << std::string(300, 'x');
  EXPECT_EQ(claimed_beside(output("c.hier"), *files_), 700U - kNoteBytes);
  std::ofstream(work / "tiles") << std::string(3000, 'x');
  EXPECT_EQ(claimed_beside(output("c.hier"), *files_), 0U) << "it takes more than it claimed";
  first.reset();
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 2000U - kNoteBytes) << "it was stopped";
}

TEST_F(DiskClaimsTest, WhatIsNoClaimCountsForNothing) {
  const auto lock = begin("a.hier");
  std::ofstream(storage::lock_path(storage::work_path(output("a.hier")))) << "no number";
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 0U);
  EXPECT_EQ(claimed_beside(output("there/is/none.hier"), *files_), 0U);
}

TEST_F(DiskClaimsTest, WhoFindsTooLittleIsToldWhatIsFreeAndWhatOthersTake) {
  files_ = std::make_unique<HiddenLocks>(*real_);
  const auto lock = begin("a.hier");
  const auto message = [&](std::uint64_t claimed, const auto& ask) -> std::string {
    claim(storage::work_path(output("a.hier")), claimed);
    return tests::error_message(ErrorCode::budget, ask);
  };
  const auto import_of = [&](std::uint64_t bytes) {
    return [this, bytes] { check_import_disk(bytes, output("b.hier"), *files_); };
  };
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 60;
  EXPECT_EQ(message(1000, import_of(0)), "");
  EXPECT_THAT(message(1 << 20, import_of(kHuge)),
              AllOf(HasSubstr(" free, of which other builds at work there will take 1.00 MiB; to "),
                    HasSubstr("takes up to about ")));
  for (const std::string& told : {message(kHuge, import_of(0)), message(kHuge, [&] {
                                    check_disk({.output_bytes = 1}, output("b.hier"), *files_);
                                  })}) {
    EXPECT_THAT(told, HasSubstr(" free, and other builds at work there will take "));
    EXPECT_THAT(told, HasSubstr("nothing of it is left for this one"));
  }
  EXPECT_THAT(message(kHuge, import_of(0)), Not(HasSubstr("0 B")));
}

TEST_F(DiskClaimsTest, BuildsInOtherFoldersOfTheDiskCount) {
  const auto lock = begin("one/a.hier");
  claim(storage::work_path(output("one/a.hier")), 5000);
  files_->make_directories(output("two"));
  EXPECT_EQ(claimed_beside(output("two/b.hier"), *files_), 5000U - kNoteBytes);
  EXPECT_EQ(claimed_beside(output("three/four/b.hier"), *files_), 5000U - kNoteBytes);
}

TEST_F(DiskClaimsTest, ClaimsBeyondAllNumbersAreNoSmallOnes) {
  files_ = std::make_unique<HiddenLocks>(*real_);
  const auto first = begin("a.hier"), second = begin("b.hier");
  for (const char* name : {"a.hier", "b.hier"})
    claim(storage::work_path(output(name)), UINT64_MAX);
  EXPECT_EQ(claimed_beside(output("c.hier"), *files_), UINT64_MAX);
}

TEST_F(DiskClaimsTest, ABuildWhoseFilesComeAndGoCounts) {
  const auto lock = begin("a.hier");
  claim(storage::work_path(output("a.hier")), 5000);
  RestlessFiles restless(*real_, directory_.path());
  EXPECT_EQ(claimed_beside(output("b.hier"), restless), 5000U - kNoteBytes);
}

TEST_F(DiskClaimsTest, BuildsMayComeAndGoWhileTheyAreLookedFor) {
  files_->make_directories(output("two"));
  const auto come_and_go = [&] {
    for (int i = 0; i < 5000; ++i) {
      const auto lock = begin("a.hier");
      if (lock == nullptr)
        return false;
      files_->remove_all(storage::work_path(output("a.hier")));
    }
    return true;
  };
  int i = 0;
  EXPECT_TRUE(tests::do_beside(come_and_go, [&] {
    EXPECT_EQ(claimed_beside(output(++i % 2 == 0 ? "b.hier" : "two/b.hier"), *files_), 0U);
  })) << "who looks was taken for a build";
}

TEST_F(DiskClaimsTest, AFolderThatABuildGivesUpHoldsNoOthers) {
  const auto come_and_go = [&] {
    for (int i = 0; i < 2000; ++i) {
      files_->make_directories(output("new"));
      files_->remove_all(output("new"));
    }
    return true;
  };
  EXPECT_TRUE(tests::do_beside(
      come_and_go, [&] { EXPECT_EQ(claimed_beside(output("new/b.hier"), *files_), 0U); }));
}

TEST_F(DiskClaimsTest, BuildsOfOtherUsersInTheFolderCount) {
  if (geteuid() != 0)
    GTEST_SKIP() << "only root can become another user";
  const auto lock = begin("a.hier");
  const auto work = storage::work_path(output("a.hier"));
  claim(work, 5000);
  ASSERT_EQ(chmod(directory_.path().c_str(), 0755), 0);
  ASSERT_EQ(chmod(storage::lock_path(work).c_str(), 0644), 0);
  if (!is_open_to_all(directory_.path()))
    GTEST_SKIP() << "other users cannot reach " << directory_.path();
  constexpr uid_t kNobody = 65534;
  const auto other_user = [&]() noexcept {
    return setuid(kNobody) == 0 && claimed_beside(output("b.hier"), *files_) == 5000U - kNoteBytes;
  };
  EXPECT_EXIT(_exit(other_user() ? 0 : 1), testing::ExitedWithCode(0), "");
}

TEST_F(DiskClaimsTest, WhatIsRefusedIsNotClaimed) {
  const auto lock = begin("a.hier");
  const auto work = storage::work_path(output("a.hier"));
  EXPECT_THROW(
      claim_disk(work, 5000, *files_, use_, [] { throw Error(ErrorCode::budget, "too little"); }),
      Error);
  EXPECT_EQ(claimed_beside(output("b.hier"), *files_), 0U);
}

/// Builds that claim at one moment, each a process of its own and in a folder of its own.
class ClaimingProcesses : public DiskClaimsTest {
 protected:
  static constexpr int kCount = 6;

  /// Returns whether the claim of the build was granted, of a disk for one and a half of them.
  bool is_granted(int number) noexcept {  // an error must not end in the tests that follow
    const auto made = output(("folder" + std::to_string(number % 3)).c_str()) /
                      (std::to_string(number) + ".hier");
    const auto work = storage::work_path(made);
    files_->make_directories(work);
    const auto lock = files_->try_lock(storage::lock_path(work));
    rendezvous("ready", number);
    bool granted = true;
    try {
      claim_disk(work, 1000, *files_, use_, [&] {
        if (claimed_beside(made, *files_) > 500)
          throw Error(ErrorCode::budget, "too little");
      });
    } catch (const Error&) {
      granted = false;
    }
    rendezvous("claimed", number);  // until then it holds what it has
    return granted;
  }

 private:
  /// Returns when all have come.
  void rendezvous(const std::string& name, int number) const {
    std::ofstream(output((name + std::to_string(number)).c_str())) << "here";
    for (int other = 0; other < kCount; ++other) {
      while (!std::filesystem::exists(output((name + std::to_string(other)).c_str())))
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
};

TEST_F(ClaimingProcesses, OfManyAtOneMomentOneIsGranted) {
  std::vector<pid_t> processes;
  for (int i = 0; i < kCount; ++i) {
    processes.push_back(fork());
    if (processes.back() == 0)
      _exit(is_granted(i) ? 1 : 0);
  }
  int granted = 0;
  for (const pid_t process : processes) {
    int status = 0;
    ASSERT_EQ(waitpid(process, &status, 0), process);
    ASSERT_TRUE(WIFEXITED(status));
    granted += WEXITSTATUS(status);
  }
  EXPECT_EQ(granted, 1);
}

}  // namespace
}  // namespace meshhier::pipeline
