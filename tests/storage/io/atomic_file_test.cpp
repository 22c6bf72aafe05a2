#include "storage/io/atomic_file.h"

#include "hierarchy/error.h"
#include "storage/format/layout.h"
#include "tests/support/faulty_file_system.h"

#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    parent_ = std::filesystem::path(testing::TempDir()) / (std::string("atomic_") + info.name());
    std::filesystem::remove_all(parent_);
    std::filesystem::create_directories(parent_);
    path_ = parent_ / "a.json";
  }
  void TearDown() override { std::filesystem::remove_all(parent_); }

  static std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
  }
  std::string text() {
    const std::vector<std::byte> bytes = read_file(files_, path_, 1000);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(parent_))
      found.insert(entry.path().filename());
    return found;
  }

  FaultyFileSystem files_;
  std::filesystem::path parent_, path_;
};

TEST_F(AtomicFileTest, HasItsNameOnlyWhenItIsWhole) {
  AtomicFile file(files_, path_);
  EXPECT_FALSE(std::filesystem::exists(path_));
  file.publish(bytes_of("new"));
  EXPECT_EQ(text(), "new");
  EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(AtomicFileTest, WhatIsNotPublishedLeavesNothing) {
  { const AtomicFile file(files_, path_); }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(AtomicFileTest, TheOldContentStaysUntilTheNewIsThere) {
  write_file(files_, path_, bytes_of("the old one, which is longer"));
  {
    AtomicFile file(files_, path_);
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

TEST_F(AtomicFileTest, WhatCannotBeWrittenIsRefusedAtOnce) {
  for (const std::filesystem::path& path : {parent_, parent_ / "absent" / "a.json"}) {
    try {
      const AtomicFile file(files_, path);
      ADD_FAILURE() << path << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::io);
    }
  }
  EXPECT_THAT(names(), IsEmpty());
}

}  // namespace
}  // namespace meshhier::storage
