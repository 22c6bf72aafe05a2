#include "server/inbox.h"

#include "tests/server/served_folder.h"
#include "tests/support/zip_archive.h"

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
  Inbox inbox_{directory_.path(),
               {.settle = milliseconds(2000),
                .folders = Inbox::Folders::taken,
                .mark = [this](const std::string&) { return companions_; },
                .clock = [this] { return now_; }}};
};

TEST_F(InboxTest, AFileIsWholeWhenItHasSettled) {
  write_text(directory_.path() / "a.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(1999)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(1)), ElementsAre("a.ply"));
  EXPECT_THAT(whole_after(milliseconds(1000)), ElementsAre("a.ply"));
}

TEST_F(InboxTest, AnArchiveOfAHierarchyIsNoMesh) {
  write_text(directory_.path() / "a.3tz", tests::zip_of({{"tileset.json", "{}"}}));
  write_text(directory_.path() / "b.3tz", tests::zip_of({{"hierarchy.json", "{}"}}));
  write_text(directory_.path() / "c.3tz", "no archive, as a build tells");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  for (int i = 0; i < 2; ++i)
    EXPECT_THAT(whole_after(milliseconds(2000)), ElementsAre("a.3tz", "c.3tz"));
  write_text(directory_.path() / "b.3tz", tests::zip_of({{"tileset.json", "{ }"}}));
  EXPECT_THAT(whole_after(milliseconds(0)), ElementsAre("a.3tz", "c.3tz"));
  EXPECT_THAT(whole_after(milliseconds(2000)), ElementsAre("a.3tz", "b.3tz", "c.3tz"));
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

TEST_F(InboxTest, AFolderWhoseCompanionsChangeBeginsAnew) {
  std::filesystem::create_directory(directory_.path() / "house");
  write_text(directory_.path() / "house/a.obj", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  companions_ = 7;
  EXPECT_THAT(whole_after(milliseconds(2000)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(2000)), ElementsAre("house/a.obj"));
}

TEST_F(InboxTest, AFileThatCameBackIsANewOne) {
  write_text(directory_.path() / "a.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  std::filesystem::remove(directory_.path() / "a.ply");
  EXPECT_THAT(whole_after(milliseconds(2000)), IsEmpty());
  write_text(directory_.path() / "a.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(2000)), IsEmpty());
}

TEST_F(InboxTest, AFolderWithOneMeshIsWholeWhenAllOfItHasSettled) {
  const auto house = directory_.path() / "house";
  std::filesystem::create_directory(house);
  write_text(house / "a.obj", "1");
  write_text(house / "wall.png", "1");
  EXPECT_THAT(whole_after(milliseconds(0)), IsEmpty());
  write_text(house / "wall.png", "12");
  EXPECT_THAT(whole_after(milliseconds(1500)), IsEmpty());
  EXPECT_THAT(whole_after(milliseconds(1000)), IsEmpty()) << "the picture has not settled";
  EXPECT_THAT(whole_after(milliseconds(1000)), ElementsAre("house/a.obj"));
  write_text(house / "b.ply", "1");
  EXPECT_THAT(whole_after(milliseconds(5000)), IsEmpty()) << "it is no longer one mesh";
}

TEST_F(InboxTest, OnlyFoldersThatAreOneMeshAreLookedAt) {
  for (const char* folder : {".hidden", "none", "two", "deep", "deep/er"})
    std::filesystem::create_directory(directory_.path() / folder);
  for (const char* file :
       {".hidden/a.obj", "none/a.mtl", "two/a.obj", "two/b.obj", "deep/er/a.obj"})
    write_text(directory_.path() / file, "1");
  EXPECT_THAT(inbox_.look(), IsEmpty());
}

TEST_F(InboxTest, FoldersMayBeIgnored) {
  std::filesystem::create_directory(directory_.path() / "house");
  write_text(directory_.path() / "house/a.obj", "1");
  EXPECT_EQ(inbox_.look().size(), 1U);
  EXPECT_THAT(Inbox(directory_.path(), {.settle = milliseconds(0)}).look(), IsEmpty());
}

TEST_F(InboxTest, LinksAndDirectoriesAreLeftAlone) {
  std::filesystem::create_directory(directory_.path() / "a.ply");
  std::filesystem::create_symlink("/dev/zero", directory_.path() / "b.ply");
  write_text(directory_.path() / "notes.txt", "1");
  EXPECT_THAT(inbox_.look(), IsEmpty());
}

}  // namespace
}  // namespace meshhier::server
