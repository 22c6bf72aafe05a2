#include "server/sources.h"

#include "base/error.h"
#include "storage/io/file_checksum.h"
#include "tests/server/served_folder.h"
#include "tests/support/make_later.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using Unknown = Sources::Unknown;

class SourcesTest : public testing::Test {
 protected:
  SourcesTest() {
    write("a.ply", "some mesh");
    model_.mesh_bytes = version().bytes;
    model_.mesh_checksum = storage::FileChecksum(version().bytes).complete(*opened(), [] {});
  }

  static std::filesystem::path made(std::filesystem::path directory) {
    std::filesystem::create_directories(directory);
    return directory;
  }
  void write(const std::string& name, const std::string& text) const {
    tests::write_text(inbox_.directory() / name, text);
  }
  std::unique_ptr<storage::File> opened() const {
    return storage::open_folder(inbox_.directory())->open("a.ply");
  }
  storage::FileVersion version() const { return opened()->version(); }
  bool is_made_of(Unknown unknown) {
    return sources_.is_made_of("a.ply", version(), model_, unknown);
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  InputNotes notes_{*files_, storage::open_folder(directory_.path())};
  Inbox inbox_{made(directory_.path() / "inbox"), {}};
  execution::CancelToken cancel_;
  std::vector<std::string> warned_;
  Sources sources_{inbox_, notes_, cancel_,
                   [this](const std::string& message) { warned_.push_back(message); }};
  Model model_{.path = "a.hier", .source = "a.ply", .source_checksum = 7};
};

TEST_F(SourcesTest, AMeshThatNobodyNotedIsReadOnceAndThenKnown) {
  EXPECT_FALSE(is_made_of(Unknown::is_another));
  EXPECT_FALSE(notes_.find("a.hier"));
  EXPECT_TRUE(is_made_of(Unknown::is_read));
  EXPECT_TRUE(notes_.find("a.hier"));
  EXPECT_TRUE(is_made_of(Unknown::is_another));
  EXPECT_TRUE(warned_.empty());
}

TEST_F(SourcesTest, AnotherMeshOfTheSameSizeIsAnother) {
  const storage::FileVersion before = version();
  EXPECT_TRUE(sources_.is_still("a.ply", before));
  write("a.ply", "same size");
  tests::make_later(inbox_.directory() / "a.ply");
  EXPECT_FALSE(is_made_of(Unknown::is_read));
  EXPECT_FALSE(sources_.is_still("a.ply", before));
  EXPECT_FALSE(sources_.is_still("none.ply", before));
}

TEST_F(SourcesTest, WhatBelongsToAMeshIsMarkedOnceItIsKnown) {
  write("a.png", "picture");
  notes_.write("a.hier", {7, {{"a.ply", {}, 1}, {"a.png", {7, 1, 1}, 2}}, {}});
  EXPECT_EQ(sources_.mark("a.ply"), 0U);
  is_made_of(Unknown::is_another);
  const std::uint64_t mark = sources_.mark("a.ply");
  EXPECT_NE(mark, 0U);
  EXPECT_EQ(sources_.mark_when_asked("a.ply"), mark);
  write("a.png", "other");
  EXPECT_NE(sources_.mark("a.ply"), mark);
  EXPECT_EQ(sources_.mark_when_asked("a.ply"), mark);
  sources_.forget_all_but({{"b.ply", {}, true}});
  EXPECT_EQ(sources_.mark("a.ply"), 0U);
}

TEST_F(SourcesTest, WarningsAreKeptInTheNote) {
  ASSERT_TRUE(is_made_of(Unknown::is_read));
  sources_.keep_warnings("a.ply", model_, {"it is odd"});
  EXPECT_EQ(notes_.find("a.hier").value().warnings, std::vector<std::string>{"it is odd"});
}

TEST_F(SourcesTest, ReadingEndsWhenItIsNotWanted) {
  cancel_.cancel();
  EXPECT_THROW(is_made_of(Unknown::is_read), Error);
}

}  // namespace
}  // namespace meshhier::server
