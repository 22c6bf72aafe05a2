#include "storage/io/output_file.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "tests/support/faulty_file_system.h"

#include <array>
#include <chrono>
#include <climits>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    parent_ = fs::path(testing::TempDir()) /
              (std::string("output_") + info.name() + std::to_string(::getpid()));
    fs::remove_all(parent_);
    fs::create_directories(parent_);
    path_ = parent_ / "a.json";
  }
  void TearDown() override { fs::remove_all(parent_); }

  static std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
  }
  std::string text() { return text(path_); }
  std::string text(const fs::path& path) {
    const std::vector<std::byte> bytes = read_file(files_, path, 1000);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  void put(const fs::path& path, const std::string& text) {
    write_file(files_, path, bytes_of(text));
  }
  void write(const OutputRequest& request, const std::string& text) {
    OutputFile file(files_, request);
    file.publish(bytes_of(text));
  }
  std::optional<ErrorCode> refusal(const OutputRequest& request) {
    try {
      write(request, "new");
    } catch (const Error& error) {
      message_ = error.what();
      return error.code();
    }
    return std::nullopt;
  }
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(parent_))
      found.insert(entry.path().filename());
    return found;
  }

  FaultyFileSystem files_;
  fs::path parent_, path_;
  std::string message_;
};

TEST_F(OutputFileTest, HasItsNameOnlyWhenItIsWhole) {
  OutputFile file(files_, {path_});
  EXPECT_FALSE(fs::exists(path_));
  file.publish(bytes_of("new"));
  EXPECT_EQ(text(), "new");
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(OutputFileTest, WhatIsNotPublishedLeavesNothing) {
  { const OutputFile file(files_, {path_}); }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(OutputFileTest, TheOldContentStaysUntilTheNewIsThere) {
  put(path_, "the old one, which is longer");
  {
    OutputFile file(files_, {path_, true});
    EXPECT_EQ(text(), "the old one, which is longer");
    for (const Call call : {Call::write, Call::sync, Call::rename}) {
      files_.fail(call, 1);
      EXPECT_THROW(file.publish(bytes_of("new")), Error);
      EXPECT_EQ(text(), "the old one, which is longer");
    }
    file.publish(bytes_of("new"));
  }
  EXPECT_EQ(text(), "new");
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(OutputFileTest, ItsNameIsForcedToTheDisk) {
  write({path_}, "old");
  EXPECT_EQ(files_.calls(Call::sync_tree), 1);
  files_.fail(Call::sync, 1);
  EXPECT_EQ(refusal({path_, true}), ErrorCode::io);
  EXPECT_EQ(text(), "old");  // the content comes before the name
  files_.fail(Call::sync_tree, 1);
  EXPECT_EQ(refusal({path_, true}), ErrorCode::io);
  EXPECT_EQ(text(), "new");  // and the directory after it
}

TEST_F(OutputFileTest, AFileThatIsThereStays) {
  put(path_, "old");
  EXPECT_EQ(refusal({path_}), ErrorCode::exists);
  EXPECT_THAT(message_, HasSubstr("--force"));
  EXPECT_EQ(text(), "old");
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(OutputFileTest, AFileThatAppearsMeanwhileStays) {
  {
    OutputFile file(files_, {path_});
    put(path_, "of another program");
    EXPECT_THROW(file.publish(bytes_of("new")), Error);
  }
  EXPECT_EQ(text(), "of another program");
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(OutputFileTest, ADirectoryThatAppearsMeanwhileStays) {
  {
    OutputFile file(files_, {path_, true});
    fs::create_directories(path_);
    put(path_ / "precious", "of another program");
    EXPECT_THROW(file.publish(bytes_of("new")), Error);
  }
  EXPECT_EQ(text(path_ / "precious"), "of another program");
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(OutputFileTest, FilesThatBelongTogetherComeTogether) {
  FaultyFileSystem faulty;
  const fs::path other = parent_ / "b.json";
  bool is_done = false;
  for (const bool is_there : {false, true}) {
    is_done = false;
    for (std::uint64_t call = 1; !is_done; ++call) {
      SCOPED_TRACE(call);
      fs::remove(path_);
      fs::remove(other);
      if (is_there) {
        put(path_, "old");
        put(other, "old");
      }
      {
        OutputFile first(faulty, {path_, is_there}), second(faulty, {other, is_there});
        first.file()->write_at(0, bytes_of("new"));
        second.file()->write_at(0, bytes_of("new"));
        faulty.fail(Call::any, call);
        try {
          publish_all(std::array{&first, &second});
          is_done = true;
        } catch (const Error&) {
        }
        faulty.fail(Call::any, 1, 0);
      }
      ASSERT_EQ(fs::exists(path_), fs::exists(other));
      if (fs::exists(path_)) {
        ASSERT_EQ(text(path_), text(other));
      }
      for (const auto& entry : fs::directory_iterator(parent_))
        ASSERT_FALSE(entry.path().string().ends_with("-part")) << entry.path();
    }
    EXPECT_EQ(text(), "new");
  }
}

TEST_F(OutputFileTest, AStreamsScratchIsItsOwnAndGoes) {
  fs::path scratch;
  {
    const OutputFile file(files_, {"/dev/null"});
    scratch = file.scratch();
    EXPECT_EQ(fs::status(scratch.parent_path()).permissions(), fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(scratch.parent_path()));
}

TEST_F(OutputFileTest, LinksAreFollowed) {
  fs::create_directory(parent_ / "elsewhere");
  const fs::path real = parent_ / "elsewhere" / "real.json";
  fs::create_symlink("elsewhere/real.json", path_);
  write({path_}, "first");  // the link leads to nothing
  EXPECT_EQ(text(real), "first");
  EXPECT_EQ(refusal({path_}), ErrorCode::exists);
  write({path_, true}, "second");
  EXPECT_EQ(text(real), "second");
  EXPECT_TRUE(fs::is_symlink(path_));
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "elsewhere"}));
}

TEST_F(OutputFileTest, AnInputIsNeverReplaced) {
  const fs::path scan = parent_ / "scan.ply";
  put(scan, "a scan");
  fs::create_symlink(scan, path_);
  fs::create_directory_symlink(parent_, parent_ / "here");
  for (const fs::path& output : {scan, path_, parent_ / "here" / "scan.ply"}) {
    EXPECT_EQ(refusal({output, true, {scan}}), ErrorCode::usage) << output;
    EXPECT_THAT(message_, HasSubstr("would replace"));
  }
  EXPECT_EQ(refusal({parent_ / "here" / "new.ply", true, {parent_}}), ErrorCode::usage);
  EXPECT_THAT(message_, HasSubstr("lies in"));
  fs::create_hard_link(scan, parent_ / "second.ply");
  EXPECT_EQ(refusal({parent_ / "second.ply", true, {scan}}), ErrorCode::usage);
  EXPECT_EQ(refusal({scan, true, {parent_ / "second.ply"}}), ErrorCode::usage);
  EXPECT_THAT(message_, HasSubstr("would replace"));
  EXPECT_EQ(text(scan), "a scan");
}

TEST_F(OutputFileTest, AFolderThatHoldsAnInputIsNotReplaced) {
  fs::create_directories(parent_ / "site/models");
  put(parent_ / "site/models/a", "a model");
  fs::create_directory_symlink(parent_ / "site", parent_ / "link");
  const auto refused = [&](const fs::path& output, const fs::path& input) {
    try {
      require_apart(files_, output, std::array{input});
    } catch (const Error& error) {
      message_ = error.what();
      return error.code() == ErrorCode::usage;
    }
    return false;
  };
  EXPECT_TRUE(refused(parent_ / "site", parent_ / "site/models/a"));
  EXPECT_THAT(message_, HasSubstr("a lies in it"));
  EXPECT_TRUE(refused(parent_ / "link", parent_ / "site/models"));
  EXPECT_TRUE(refused(parent_ / "site/", parent_ / "link/models/a"));
  fs::create_symlink(parent_ / "elsewhere", parent_ / "site/models/b");
  EXPECT_TRUE(refused(parent_ / "site", parent_ / "site/models/b")) << "the link would go";
  EXPECT_FALSE(refused(parent_ / "sites", parent_ / "site/models/a"));
  EXPECT_FALSE(refused(parent_ / "site", ""));
}

TEST_F(OutputFileTest, NamesThatItTakesMeanwhileAreNoInputs) {
  for (const fs::path& own :
       {unfinished_path(path_), scratch_path(path_), output_lock_path(path_)}) {
    put(own, "an input");
    EXPECT_EQ(refusal({path_, false, {own}}), ErrorCode::usage) << own;
    EXPECT_EQ(text(own), "an input");
    fs::remove(own);
  }
}

TEST_F(OutputFileTest, OneWriterAtATime) {
  OutputFile first(files_, {path_});
  EXPECT_EQ(refusal({path_}), ErrorCode::locked);
  EXPECT_THAT(message_, HasSubstr("another command"));
  first.publish(bytes_of("of the first"));
  EXPECT_EQ(text(), "of the first");
}

TEST_F(OutputFileTest, AWriterThatIsAboutToEndIsWaitedFor) {
  auto lock = files_.try_lock(output_lock_path(path_));
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    put(path_, "of another");
    lock.reset();
  });
  EXPECT_EQ(refusal({path_}), ErrorCode::exists) << "it is there by now";
  other.join();
  EXPECT_EQ(text(), "of another");
  EXPECT_EQ(refusal({path_, true}), std::nullopt);
}

TEST_F(OutputFileTest, AFifoTakesTheBytesAndStays) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] {
    std::ifstream in(path_);
    received.assign(std::istreambuf_iterator<char>(in), {});
  });
  const std::string sent(300'000, 'x');  // more than a pipe holds
  write({path_}, sent);
  reader.join();
  EXPECT_EQ(received, sent);
  EXPECT_TRUE(fs::is_fifo(path_));
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(OutputFileTest, WaitingForAReaderCanBeCancelled) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  int waits = 0;
  const auto check = [&] {
    if (++waits == 3)
      throw Error(ErrorCode::interrupted, "interrupted");
  };
  EXPECT_THROW(OutputFile(files_, {path_}, check), Error);
  EXPECT_EQ(waits, 3);
}

TEST_F(OutputFileTest, WaitingForASlowReaderCanBeCancelled) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  const int reader = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK);  // which reads nothing
  constexpr int kMost = 30;                                         // a pipe holds 16 writes
  int checks = 0;
  const auto check = [&] {
    if (++checks == kMost)
      throw Error(ErrorCode::interrupted, "interrupted");
  };
  OutputFile file(files_, {path_}, check);
  const std::shared_ptr<File> pipe = file.file();
  EXPECT_THROW(file.publish(bytes_of(std::string(10'000'000, 'x'))), Error);
  EXPECT_LT(pipe->size(), (kMost - 1) * std::uint64_t{PIPE_BUF}) << "nothing waited";
  ::close(reader);
}

TEST_F(OutputFileTest, AReaderThatGoesAwayIsAFailure) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  const int reader = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK);
  OutputFile file(files_, {path_});
  ::close(reader);
  EXPECT_THROW(file.publish(bytes_of("new")), Error);
}

TEST_F(OutputFileTest, DevicesTakeTheBytesAndStay) {
  EXPECT_EQ(refusal({"/dev/null"}), std::nullopt);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(refusal({"/dev/full", true}), ErrorCode::io);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(OutputFileTest, WhatIsNoPlaceForAFileIsRefusedAtOnce) {
  for (const fs::path& path : {parent_, fs::path("."), parent_ / "..", parent_ / ""})
    EXPECT_EQ(refusal({path, true}), ErrorCode::usage) << path;
  EXPECT_EQ(refusal({parent_ / "absent" / "a.json"}), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr("there is no directory"));
  put(path_, "a file");
  EXPECT_EQ(refusal({path_ / "below.json"}), ErrorCode::io);
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

}  // namespace
}  // namespace meshhier::storage
