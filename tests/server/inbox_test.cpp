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
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;
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

  void put(const std::filesystem::path& name) const {
    std::filesystem::create_directories((directory_.path() / name).parent_path());
    write_text(directory_.path() / name, "1");
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

TEST_F(InboxTest, FoldersThatGiveNoModelAreToldOnceTheyHaveSettled) {
  put("one/a.ply");
  put("two/a.ply");
  put("two/b.obj");
  put("none/notes.txt");
  put("made.hier/hierarchy.json");
  put(".hidden/notes.txt");
  std::filesystem::create_symlink(directory_.path() / "two", directory_.path() / "link");
  whole_after(milliseconds(0));
  EXPECT_THAT(inbox_.left_out(), IsEmpty());
  whole_after(milliseconds(2000));
  EXPECT_THAT(inbox_.left_out(),
              ElementsAre(Pair("none", "it holds no mesh"), Pair("two", HasSubstr("2 meshes"))));
  std::filesystem::remove(directory_.path() / "two/b.obj");
  put("one/b.ply");
  whole_after(milliseconds(0));
  EXPECT_THAT(inbox_.left_out(), ElementsAre(Pair("none", "it holds no mesh")))
      << "they have changed";
  whole_after(milliseconds(2000));
  EXPECT_THAT(inbox_.left_out(),
              ElementsAre(Pair("none", "it holds no mesh"), Pair("one", HasSubstr("2 meshes"))));
}

TEST_F(InboxTest, WithoutFoldersAllAreToldWithWhatTakesThem) {
  Inbox inbox{directory_.path(), {.settle = milliseconds(0)}};
  put("one/a.ply");
  put("made.hier/hierarchy.json");
  inbox.look();
  EXPECT_THAT(inbox.left_out(), ElementsAre(Pair("one", HasSubstr("--inbox"))));
  inbox.look();
  EXPECT_THAT(inbox.left_out(), SizeIs(1));
  std::filesystem::remove_all(directory_.path() / "one");
  inbox.look();
  EXPECT_THAT(inbox.left_out(), IsEmpty());
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
