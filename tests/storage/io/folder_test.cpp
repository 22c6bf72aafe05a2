#include "storage/io/folder.h"

#include "base/error.h"
#include "tests/support/make_later.h"
#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;
using std::string_literals::operator""s;
using testing::ElementsAre;
using testing::IsEmpty;

class FolderTest : public testing::Test {
 protected:
  FolderTest() {
    fs::create_directories(root() / "a/b");
    for (const char* name : {"root/x", "root/a/y", "root/a/b/z", "outside"})
      write(directory_.path() / name, name);
    fs::create_symlink("x", root() / "link");
    fs::create_symlink("../outside", root() / "out");
    fs::create_directory_symlink("a", root() / "a_link");
    fs::create_directory_symlink("/", root() / "a/everything");
    ::mkfifo((root() / "pipe").c_str(), 0600);
    folder_ = open_folder(root());
  }

  static void write(const fs::path& path, std::string_view text) {
    write_file(*make_posix_file_system(), path, std::as_bytes(std::span(text)));
  }
  fs::path root() const { return directory_.path() / "root"; }

  std::string read(const std::string& name) const {
    const auto file = folder_->open(name);
    if (!file)
      return "nothing";
    std::string text(file->size(), '\0');
    file->read_exact(0, std::as_writable_bytes(std::span(text)));
    return text;
  }
  std::vector<std::string> names(const std::string& directory) const {
    std::vector<std::string> found;
    for (const FolderEntry& entry : folder_->entries(directory))
      found.push_back(entry.name + (entry.is_directory ? "/" : ""));
    return found;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<Folder> folder_;
};

TEST_F(FolderTest, WhatIsBelowIsOpened) {
  EXPECT_EQ(read("x"), "root/x");
  EXPECT_EQ(read("a/y"), "root/a/y");
  EXPECT_EQ(read("a/b/z"), "root/a/b/z");
}

TEST_F(FolderTest, NothingElseIs) {
  for (const std::string& name : {""s,
                                  "."s,
                                  ".."s,
                                  "/"s,
                                  "../outside"s,
                                  "a/../x"s,
                                  "a/./y"s,
                                  "a//y"s,
                                  "/x"s,
                                  "x/"s,
                                  "x/y"s,
                                  "a"s,
                                  "link"s,
                                  "out"s,
                                  "a_link/y"s,
                                  "a_link"s,
                                  "a/everything/etc/passwd"s,
                                  "pipe"s,
                                  "missing"s,
                                  "x\0"s,
                                  "x\0y"s,
                                  std::string(300, 'x'),
                                  root().string() + "/x"})
    EXPECT_EQ(read(name), "nothing") << name;
}

TEST_F(FolderTest, ItStaysTheSameDirectoryWhateverTakesItsName) {
  fs::rename(root(), directory_.path() / "moved");
  fs::create_directory_symlink("/etc", root());
  EXPECT_EQ(read("passwd"), "nothing");
  EXPECT_EQ(read("x"), "root/x");
}

TEST_F(FolderTest, FilesAndDirectoriesAreListedInOrder) {
  EXPECT_THAT(names(""), ElementsAre("a/", "x"));
  EXPECT_THAT(names("a"), ElementsAre("b/", "y"));
  for (const char* none : {"missing", "x", "a_link", "..", "a/everything", "."})
    EXPECT_THAT(names(none), IsEmpty()) << none;
  EXPECT_EQ(folder_->entries("")[1].version, folder_->open("x")->version());
}

TEST_F(FolderTest, VersionsTellFilesApartAndChanges) {
  const FileVersion before = folder_->open("x")->version();
  EXPECT_EQ(before.bytes, 6U);
  EXPECT_EQ(before, folder_->open("x")->version());
  EXPECT_NE(before, folder_->open("a/y")->version());
  fs::remove(root() / "x");
  write(root() / "x", "root/y");
  tests::make_later(root() / "x");
  EXPECT_NE(before, folder_->open("x")->version());
}

TEST_F(FolderTest, OnlyADirectoryIsAFolder) {
  for (const fs::path& path : {root() / "x", root() / "missing"}) {
    try {
      open_folder(path);
      ADD_FAILURE() << path << " was opened";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::io);
    }
  }
}

}  // namespace
}  // namespace meshhier::storage
