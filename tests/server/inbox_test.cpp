#include "server/inbox.h"

#include "tests/server/served_folder.h"

#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;
using tests::write_text;

class InboxTest : public testing::Test {
 protected:
  std::vector<std::string> whole_after(milliseconds time) {
    now_ += time;
    std::vector<std::string> names;
    for (const InboxFile& file : inbox_.look()) {
      if (file.is_whole)
        names.push_back(file.name);
    }
    return names;
  }

  tests::TemporaryDirectory directory_;
  std::chrono::steady_clock::time_point now_;
  std::uint64_t companions_ = 0;
  Inbox inbox_{directory_.path(), milliseconds(2000),
               [this](const std::string&) { return companions_; }, [this] { return now_; }};
};

TEST_F(InboxTest, AFileIsWholeWhenItHasSettled) {
  write_text(directory_.path() / "a.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(1999)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(1)), ElementsAre("a.ply"));
  EXPECT_THAT(whole_after(milliseconds(1000)), ElementsAre("a.ply"));
}

TEST_F(InboxTest, AFileThatGrowsBeginsAnew) {
  write_text(directory_.path() / "a.ply", "1");
  write_text(directory_.path() / "b.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  write_text(directory_.path() / "a.ply", "12");
  EXPECT_THAT(whole_after(milliseconds(1500)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(500)), ElementsAre("b.ply"));
  EXPECT_THAT(whole_after(milliseconds(1500)), ElementsAre("a.ply", "b.ply"));
}

TEST_F(InboxTest, AFileWhoseCompanionsChangeBeginsAnew) {
  write_text(directory_.path() / "a.obj", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  companions_ = 7;
  EXPECT_THAT(whole_after(milliseconds(2000)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(2000)), ElementsAre("a.obj"));
}

TEST_F(InboxTest, AFileThatCameBackIsANewOne) {
  write_text(directory_.path() / "a.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  std::filesystem::remove(directory_.path() / "a.ply");
  EXPECT_THAT(whole_after(milliseconds(2000)), IsEmpty());
  write_text(directory_.path() / "a.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(2000)), IsEmpty());
}

TEST_F(InboxTest, LinksAndDirectoriesAreLeftAlone) {
  std::filesystem::create_directory(directory_.path() / "a.ply");
  std::filesystem::create_symlink("/dev/zero", directory_.path() / "b.ply");
  write_text(directory_.path() / "notes.txt", "1");
  EXPECT_THAT(inbox_.look(), IsEmpty());
}

}  // namespace
}  // namespace meshhier::server
