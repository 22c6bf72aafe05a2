#include "storage/io/file.h"

#include "base/error.h"
#include "tests/support/beside.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/pattern.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using tests::Call;
using tests::FaultyFileSystem;
using tests::pattern;
using Bytes = std::vector<std::byte>;

/// The error that `action` throws; the test fails if it throws none.
template <class Action>
Error error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {ErrorCode::internal, ""};
}

class FileTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::path(testing::TempDir()) /
                 (std::string("file_") + info.name() + std::to_string(::getpid()));
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directories(directory_);
    path_ = directory_ / "data";
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path directory_;
  std::filesystem::path path_;
  std::unique_ptr<FileSystem> files_ = make_posix_file_system();
};

TEST_F(FileTest, WhatIsWrittenIsReadBack) {
  for (const std::size_t size : {0U, 1U, 4096U, 1000003U}) {
    const Bytes bytes = pattern(size);
    write_file(*files_, path_, bytes);
    EXPECT_EQ(files_->open(path_)->size(), size);
    EXPECT_EQ(read_file(*files_, path_, size), bytes);
  }
}

TEST_F(FileTest, CreatingEmptiesWhatIsThere) {
  write_file(*files_, path_, pattern(100));
  write_file(*files_, path_, pattern(3));
  EXPECT_EQ(read_file(*files_, path_, 100), pattern(3));
}

TEST_F(FileTest, ReadsAndWritesGoWhereTheyAreTold) {
  const auto file = files_->create(path_);
  file->write_at(10, pattern(5));
  file->write_at(2, pattern(3));
  EXPECT_EQ(file->path(), path_);
  EXPECT_EQ(file->size(), 15U);
  Bytes found(15);
  file->read_exact(0, found);
  Bytes expected(15);
  std::ranges::copy(pattern(5), expected.begin() + 10);
  std::ranges::copy(pattern(3), expected.begin() + 2);
  EXPECT_EQ(found, expected);
}

TEST_F(FileTest, AReadBeyondTheEndGivesWhatIsThere) {
  write_file(*files_, path_, pattern(100));
  const auto file = files_->open(path_);
  Bytes buffer(64);
  EXPECT_EQ(file->read_at(0, buffer), 64U);
  EXPECT_EQ(file->read_at(90, buffer), 10U);
  EXPECT_EQ(file->read_at(100, buffer), 0U);
  EXPECT_EQ(file->read_at(1000, buffer), 0U);
  EXPECT_EQ(file->read_at(90, {}), 0U);
}

TEST_F(FileTest, AFileThatEndsTooEarlyIsAnErrorThatSaysWhere) {
  write_file(*files_, path_, pattern(100));
  const auto file = files_->open(path_);
  Bytes buffer(64);
  const Error error = error_of([&] { file->read_exact(90, buffer); });
  EXPECT_EQ(error.code(), ErrorCode::io);
  EXPECT_THAT(error.what(), AllOf(HasSubstr(path_.string()), HasSubstr("byte 100"),
                                  HasSubstr("64 bytes"), HasSubstr("byte 90")));
  EXPECT_NO_THROW(file->read_exact(36, buffer));
}

TEST_F(FileTest, AnOffsetBeyondWhatFilesHaveIsAnError) {
  const auto file = files_->create(path_);
  Bytes buffer(4);
  constexpr std::uint64_t kFar = std::numeric_limits<std::uint64_t>::max() - 8;
  EXPECT_EQ(error_of([&] { (void)file->read_at(kFar, buffer); }).code(), ErrorCode::io);
  EXPECT_EQ(error_of([&] { file->write_at(kFar, buffer); }).code(), ErrorCode::io);
  EXPECT_EQ(file->size(), 0U);
}

TEST_F(FileTest, ShortTransfersAreContinued) {
  FaultyFileSystem files;
  const Bytes bytes = pattern(10007);
  files.limit_transfers(13);
  write_file(files, path_, bytes);
  EXPECT_EQ(files.calls(Call::write), (10007U + 12) / 13);
  EXPECT_EQ(read_file(files, path_, bytes.size()), bytes);
  EXPECT_EQ(files.calls(Call::read), (10007U + 12) / 13);
  EXPECT_EQ(read_file(*files_, path_, bytes.size()), bytes);
}

TEST_F(FileTest, AFullDiskIsAnErrorAfterWhatFitted) {
  FaultyFileSystem files;
  files.limit_room(1000);
  const auto file = files.create(path_);
  const Error error = error_of([&] { file->write_at(0, pattern(1500)); });
  EXPECT_EQ(error.code(), ErrorCode::io);
  EXPECT_THAT(error.what(), HasSubstr(path_.string()));
  EXPECT_EQ(file->size(), 1000U);
  EXPECT_EQ(files.free_bytes(directory_), 0U);
}

TEST_F(FileTest, AWriteThatMakesNoProgressEnds) {
  class Stuck final : public File {
   public:
    Stuck() : File("stuck") {}
    std::uint64_t size() const override { return 0; }
    void sync() override {}

   protected:
    std::size_t read_some(std::uint64_t, std::span<std::byte>) const override { return 0; }
    std::size_t write_some(std::uint64_t, std::span<const std::byte>) override { return 0; }
  };
  Stuck file;
  const Error error = error_of([&] { file.write_at(0, pattern(1)); });
  EXPECT_EQ(error.code(), ErrorCode::io);
  EXPECT_THAT(error.what(), HasSubstr("stuck"));
  EXPECT_NO_THROW(file.write_at(0, {}));
}

TEST_F(FileTest, AFileThatIsOnlyReadRefusesWrites) {
  class Zeros final : public ReadOnlyFile {
   public:
    Zeros() : ReadOnlyFile("zeros") {}
    std::uint64_t size() const override { return 8; }

   private:
    std::size_t read_some(std::uint64_t, std::span<std::byte> bytes) const override {
      std::ranges::fill(bytes, std::byte{});
      return bytes.size();
    }
  };
  Zeros file;
  const Error error = error_of([&] { file.write_at(0, pattern(1)); });
  EXPECT_EQ(error.code(), ErrorCode::io);
  EXPECT_THAT(error.what(), HasSubstr("zeros: it can only be read"));
  EXPECT_NO_THROW(file.sync([] {}));
}

TEST_F(FileTest, FailedCallsReachTheCaller) {
  FaultyFileSystem files;
  write_file(files, path_, pattern(10));
  const auto file = files.create(path_);
  Bytes buffer(4);
  const auto fails = [&](Call call, const auto& action) {
    files.fail(call, 1);
    EXPECT_EQ(error_of(action).code(), ErrorCode::io);
    EXPECT_NO_THROW(action());
  };
  fails(Call::write, [&] { file->write_at(0, pattern(10)); });
  fails(Call::read, [&] { file->read_exact(0, buffer); });
  fails(Call::size, [&] { (void)file->size(); });
  fails(Call::sync, [&] { file->sync(); });
  fails(Call::open, [&] { (void)files.open(path_); });
  fails(Call::create, [&] { (void)files.create(path_); });
  fails(Call::sync_tree, [&] { files.sync_tree(directory_); });
  fails(Call::free_bytes, [&] { (void)files.free_bytes(directory_); });
}

TEST_F(FileTest, BytesMovedAreCounted) {
  write_file(*files_, path_, pattern(1000));
  EXPECT_EQ(files_->counters().bytes_written, 1000U);
  EXPECT_EQ(files_->counters().bytes_read, 0U);
  const auto file = files_->open(path_);
  Bytes buffer(600);
  (void)file->read_at(0, buffer);
  (void)file->read_at(600, buffer);  // 400 are left
  EXPECT_EQ(files_->counters().bytes_read, 1000U);
  EXPECT_EQ(files_->counters().bytes_written, 1000U);
}

TEST_F(FileTest, CountersOutliveTheirFilesAndFilesTheirSystem) {
  auto file = files_->create(path_);
  files_.reset();
  EXPECT_NO_THROW(file->write_at(0, pattern(10)));
  EXPECT_EQ(file->size(), 10U);
}

TEST_F(FileTest, ALargerFileThanExpectedIsNotLoaded) {
  write_file(*files_, path_, pattern(101));
  const Error error = error_of([&] { (void)read_file(*files_, path_, 100); });
  EXPECT_EQ(error.code(), ErrorCode::corrupt);
  EXPECT_THAT(error.what(), AllOf(HasSubstr(path_.string()), HasSubstr("101"), HasSubstr("100")));
  EXPECT_EQ(files_->counters().bytes_read, 0U);
}

TEST_F(FileTest, WhatIsNotThereOrNoFileIsNamed) {
  for (const auto& path : {directory_ / "missing", directory_, directory_ / "no" / "where"}) {
    const Error error = error_of([&] { (void)files_->open(path); });
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr(path.string()));
  }
  EXPECT_EQ(error_of([&] { (void)files_->create(directory_); }).code(), ErrorCode::io);
  EXPECT_EQ(error_of([&] { (void)files_->create(directory_ / "no" / "where"); }).code(),
            ErrorCode::io);
  EXPECT_EQ(error_of([&] { files_->sync_tree(directory_ / "missing"); }).code(), ErrorCode::io);
  EXPECT_EQ(error_of([&] { (void)files_->free_bytes(directory_ / "missing"); }).code(),
            ErrorCode::io);
  EXPECT_EQ(error_of([&] { files_->rename(directory_ / "missing", path_); }).code(), ErrorCode::io);
}

/// A folder `in` with files and links; beside it `out`, with a file.
class InputRuleTest : public FileTest {
 protected:
  void SetUp() override {
    FileTest::SetUp();
    namespace fs = std::filesystem;
    fs::create_directories(in() / "sub/deep");
    fs::create_directories(directory_ / "out");
    for (const fs::path& file : {in() / "a", in() / "sub/b", in() / "sub/deep/c", out()})
      write_file(*files_, file, pattern(10));
    fs::create_symlink("a", in() / "link");
    fs::create_directory_symlink("../out", in() / "away");
    fs::create_directory_symlink("sub", in() / "inside");
    fs::create_directory_symlink("in", directory_ / "door");
  }
  std::filesystem::path in() const { return directory_ / "in"; }
  std::filesystem::path out() const { return directory_ / "out/secret"; }

  static std::string refusal(FileSystem& files, const std::filesystem::path& path) {
    EXPECT_EQ(files.input().kind(path), FileKind::none) << path;
    EXPECT_FALSE(files.input().exists(path)) << path;
    EXPECT_EQ(error_of([&] { (void)files.input().identity(path); }).code(), ErrorCode::io);
    const Error error = error_of([&] { (void)files.input().open(path); });
    EXPECT_EQ(error.code(), ErrorCode::io);
    return error.what();
  }
  void expect_read(FileSystem& files, const std::filesystem::path& path) {
    EXPECT_EQ(files.input().kind(path), FileKind::regular) << path;
    EXPECT_EQ(files.input().identity(path), files_->identity(path)) << path;
    EXPECT_EQ(read_file(files.input(), path, 10), pattern(10)) << path;
  }
};

TEST_F(InputRuleTest, WithoutLinksNoPartOfAPathMayBeOne) {
  const auto files = make_posix_file_system({.follows_links = false});
  for (const auto& path : {in() / "a", in() / "sub/deep/c", in() / "sub/.././a", out(),
                           std::filesystem::relative(in() / "sub/b")})
    expect_read(*files, path);
  EXPECT_THAT(refusal(*files, in() / "link"), HasSubstr(": it is a link"));
  EXPECT_THAT(refusal(*files, in() / "away/secret"),
              HasSubstr(": " + (in() / "away").string() + " is a link"));
  EXPECT_THAT(refusal(*files, in() / "inside/deep/c"), HasSubstr("inside is a link"));
  EXPECT_THAT(refusal(*files, directory_ / "door/a"), HasSubstr("door is a link"));
  EXPECT_THAT(refusal(*files, in() / "none/c"), HasSubstr("No such file"));
  EXPECT_THAT(refusal(*files, in() / "a/c"), HasSubstr("Not a directory"));
  EXPECT_THAT(refusal(*files, "/proc/self/root/etc/passwd"), HasSubstr("is a link"));
}

TEST_F(InputRuleTest, WithinAFolderNothingElseIsRead) {
  const auto files = make_posix_file_system({.within = directory_ / "door"});
  for (const char* name : {"door/a", "door/sub/b", "door/sub/deep/../../a", "out/../door/a"})
    expect_read(*files, directory_ / name);
  EXPECT_THAT(refusal(*files, out()),
              HasSubstr("does not lie in " + directory_.string() + "/door"));
  EXPECT_THAT(refusal(*files, directory_ / "door/../out/secret"), HasSubstr("does not lie in"));
  EXPECT_THAT(refusal(*files, directory_ / "doorway"), HasSubstr("does not lie in"));
  for (const char* name : {"door/link", "door/away/secret", "door/inside/b"})
    EXPECT_THAT(refusal(*files, directory_ / name), HasSubstr("is a link"));
}

TEST_F(InputRuleTest, FoldersAreListedUnlessALinkLeadsThere) {
  const auto files = make_posix_file_system({.within = in()});
  EXPECT_TRUE(files->input().is_directory(in()));
  EXPECT_EQ(files->input().children(in() / "sub"), files_->children(in() / "sub"));
  for (const char* name : {"away", "inside", "none", "../out"}) {
    EXPECT_FALSE(files->input().is_directory(in() / name));
    EXPECT_EQ(error_of([&] { (void)files->input().children(in() / name); }).code(), ErrorCode::io);
  }
}

TEST_F(InputRuleTest, OnlyInputIsGuardedAndItsBytesAreCounted) {
  const auto files = make_posix_file_system({.within = in()});
  EXPECT_EQ(read_file(*files, in() / "away/secret", 10), pattern(10));
  EXPECT_EQ(read_file(files->input(), in() / "a", 10), pattern(10));
  EXPECT_EQ(files->counters().bytes_read, 20U);
}

TEST_F(FileTest, AnOpenedFileCannotBeWritten) {
  write_file(*files_, path_, pattern(10));
  const auto file = files_->open(path_);
  EXPECT_EQ(error_of([&] { file->write_at(0, pattern(1)); }).code(), ErrorCode::io);
  EXPECT_EQ(read_file(*files_, path_, 10), pattern(10));
}

TEST_F(FileTest, DirectoriesAreMadeFoundRenamedAndRemoved) {
  const auto inner = directory_ / "a" / "b";
  EXPECT_FALSE(files_->exists(inner));
  files_->make_directories(inner);
  files_->make_directories(inner);  // being there is enough
  EXPECT_TRUE(files_->exists(inner));
  write_file(*files_, inner / "f", pattern(5));
  files_->rename(directory_ / "a", directory_ / "c");
  EXPECT_FALSE(files_->exists(directory_ / "a"));
  EXPECT_EQ(read_file(*files_, directory_ / "c" / "b" / "f", 5), pattern(5));
  files_->sync_tree(directory_ / "c");
  files_->remove_all(directory_ / "c");
  EXPECT_FALSE(files_->exists(directory_ / "c"));
  EXPECT_NO_THROW(files_->remove_all(directory_ / "c"));
}

TEST_F(FileTest, ADirectoryIsNotMadeOverAFile) {
  write_file(*files_, path_, pattern(5));
  const Error error = error_of([&] { files_->make_directories(path_ / "below"); });
  EXPECT_EQ(error.code(), ErrorCode::io);
  EXPECT_THAT(error.what(), HasSubstr(path_.string()));
}

TEST_F(FileTest, RenamingReplacesAFile) {
  write_file(*files_, path_, pattern(5));
  write_file(*files_, directory_ / "new", pattern(7));
  files_->rename(directory_ / "new", path_);
  EXPECT_EQ(read_file(*files_, path_, 10), pattern(7));
  EXPECT_FALSE(files_->exists(directory_ / "new"));
}

TEST_F(FileTest, ALinkToNowhereExists) {
  std::filesystem::create_symlink(directory_ / "nowhere", path_);
  EXPECT_TRUE(files_->exists(path_));
}

// "Not there" must not be the answer to a question that could not be answered.
TEST_F(FileTest, APathThatCannotBeLookedAtIsAnErrorNotAbsent) {
  std::filesystem::create_symlink(path_, path_);  // a link to itself
  const Error error = error_of([&] { (void)files_->exists(path_ / "below"); });
  EXPECT_EQ(error.code(), ErrorCode::io);
}

TEST_F(FileTest, CanonicalPathsHaveNoLinksAndDotsAsFarAsTheyExist) {
  files_->make_directories(directory_ / "real");
  std::filesystem::create_symlink(directory_ / "real", directory_ / "link");
  const std::filesystem::path real = std::filesystem::canonical(directory_) / "real";
  EXPECT_EQ(files_->canonical(directory_ / "real"), real);
  EXPECT_EQ(files_->canonical(directory_ / "link"), real);
  EXPECT_EQ(files_->canonical(directory_ / "." / "link" / ".." / "real"), real);
  EXPECT_EQ(files_->canonical(directory_ / "link" / "not" / "yet"), real / "not" / "yet");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(directory_);
  EXPECT_EQ(files_->canonical("link/new"), real / "new");
  std::filesystem::current_path(before);
}

// As /dev/stdin leads to a pipe, which has no path of its own.
TEST_F(FileTest, APipeBehindALinkOfTheSystemKeepsItsPath) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const std::filesystem::path path = fmt::format("/proc/self/fd/{}", ends[0]);
  EXPECT_EQ(files_->canonical(path), path);
  EXPECT_THAT(error_of([&] { (void)files_->open(path); }).what(), HasSubstr("not a regular file"));
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(FileTest, WhoMeansStandardInputIsToldThatItIsNotRead) {
  EXPECT_THAT(error_of([&] { (void)files_->open("-"); }).what(), HasSubstr("save what it has"));
}

TEST_F(FileTest, APathThatCannotBeResolvedIsAnError) {
  std::filesystem::create_symlink(path_, path_);  // a link to itself
  for (const auto& path : {path_, path_ / "below", std::filesystem::path()})
    EXPECT_EQ(error_of([&] { (void)files_->canonical(path); }).code(), ErrorCode::io) << path;
}

TEST_F(FileTest, EveryFileBelowADirectoryIsListedInOrder) {
  const auto top = directory_ / "top";
  files_->make_directories(top / "b" / "empty");
  files_->make_directories(top / "a");
  for (const auto& path : {top / "z", top / "b" / "y", top / "a" / "2", top / "a" / "10"})
    write_file(*files_, path, pattern(1));
  files_->make_directories(directory_ / "elsewhere");
  write_file(*files_, directory_ / "elsewhere" / "hidden", pattern(1));
  std::filesystem::create_symlink(directory_ / "elsewhere", top / "link");
  std::filesystem::create_symlink(directory_ / "nowhere", top / "dangling");
  const std::vector<std::filesystem::path> expected{top / "a" / "10", top / "a" / "2",
                                                    top / "b" / "y",  top / "dangling",
                                                    top / "link",     top / "z"};
  EXPECT_EQ(files_->list(top), expected);
  EXPECT_TRUE(files_->list(top / "b" / "empty").empty());
  EXPECT_EQ(error_of([&] { (void)files_->list(top / "missing"); }).code(), ErrorCode::io);
}

TEST_F(FileTest, WhatGoesWhileItIsLookedAtIsNoError) {
  const auto top = directory_ / "top", deep = top / "a" / "b" / "c";
  files_->make_directories(top);
  write_file(*files_, top / "stays", pattern(3));
  const auto come_and_go = [&] {
    for (int i = 0; i < 3000; ++i) {
      files_->make_directories(deep);
      write_file(*files_, deep / "file", pattern(5));
      std::filesystem::create_directory_symlink(deep, top / "link");
      std::filesystem::remove(top / "link");
      files_->remove_all(top / "a");
    }
    return true;
  };
  EXPECT_TRUE(tests::do_beside(come_and_go, [&] {
    EXPECT_THAT(files_->list(top), testing::Contains(top / "stays"));
    EXPECT_GE(bytes_at(*files_, top), 3U);
    EXPECT_LE(bytes_at(*files_, deep / "file"), 5U);
    static_cast<void>(files_->canonical(top / "link" / "file"));
  }));
}

TEST_F(FileTest, DirectoriesAreMadeWhileOthersRemoveThem) {
  const auto top = directory_ / "a", deep = top / "b" / "c" / "d";
  const auto come_and_go = [&] {
    for (int i = 0; i < 5000; ++i) {
      files_->make_directories(deep);
      for (auto path = deep; path != directory_; path = path.parent_path())
        files_->remove_if_empty(path);
    }
    return true;
  };
  EXPECT_TRUE(tests::do_beside(come_and_go, [&] { files_->make_directories(deep); }));
}

TEST_F(FileTest, OnlyAnEmptyDirectoryIsRemovedIfItIsEmpty) {
  files_->make_directories(directory_ / "a" / "b");
  files_->remove_if_empty(directory_ / "a");
  EXPECT_TRUE(files_->exists(directory_ / "a" / "b"));
  files_->remove_if_empty(directory_ / "a" / "b");
  files_->remove_if_empty(directory_ / "a");
  EXPECT_FALSE(files_->exists(directory_ / "a"));
  files_->remove_if_empty(directory_ / "a");
}

TEST_F(FileTest, FreeBytesAreThoseOfTheDisk) {
  EXPECT_GT(files_->free_bytes(directory_), 0U);
  EXPECT_LE(files_->free_bytes(directory_), std::filesystem::space(directory_).capacity);
}

}  // namespace
}  // namespace meshhier::storage
