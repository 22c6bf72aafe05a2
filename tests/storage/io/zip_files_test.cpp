// 3D Tiles archives as folders: what is found in them, and what is refused.
#include "storage/io/zip_files.h"

#include "base/error.h"
#include "tests/support/memory_files.h"
#include "tests/support/zip_archive.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::zip_of;

class ZipFilesTest : public testing::Test {
 protected:
  void put(const std::string& bytes) { files_.put("w/a.3tz", bytes); }
  std::string read(const fs::path& path) {
    const auto file = zip_.open(path);
    std::string text(file->size(), '\0');
    file->read_exact(0, std::as_writable_bytes(std::span(text)));
    return text;
  }
  std::string failure(const std::string& bytes, const fs::path& path = "w/a.3tz/t") {
    put(bytes);
    try {
      const auto file = ZipFiles(files_).open(path);  // one that knows no archive before
      std::vector<std::byte> all(file->size());
      file->read_exact(0, all);
    } catch (const Error& error) {
      EXPECT_TRUE(error.code() == ErrorCode::input || error.code() == ErrorCode::io);
      return error.what();
    }
    return {};
  }

  tests::MemoryFiles files_;
  ZipFiles zip_{files_};
};

TEST_F(ZipFilesTest, FilesAreReadHoweverTheyArePacked) {
  for (const bool is_zip64 : {false, true}) {
    put(zip_of({{"tileset.json", "stored", 0, 0, is_zip64},
                {"b/c.glb", "deflated", 8, 0, is_zip64},
                {"b/d/e.glb", "zstandard", 93, 0, is_zip64},
                {"b/", ""}},
               "a comment"));
    EXPECT_EQ(read("w/a.3tz/tileset.json"), "stored");
    EXPECT_EQ(read("w/a.3tz/b/c.glb"), "deflated");
    EXPECT_EQ(read("w/a.3tz/b/./d/e.glb"), "zstandard");
    EXPECT_EQ(zip_.identity("w/a.3tz/b/c.glb").bytes, 8U);
  }
}

TEST_F(ZipFilesTest, PackedFilesAreReadInAnyOrder) {
  std::string text(200'000, '\0');
  for (std::size_t i = 0; i < text.size(); ++i)
    text[i] = static_cast<char>(i * 7919 >> 8);
  put(zip_of({{"d", text, 8}, {"z", text.substr(0, 255), 93}}));
  EXPECT_EQ(read("w/a.3tz/d"), text);
  EXPECT_EQ(read("w/a.3tz/z"), text.substr(0, 255));
  const auto file = zip_.open("w/a.3tz/d");
  std::string part(70'000, '\0');
  for (const std::size_t at : {130'000U, 65'530U, 0U, 65'536U, 100U, 190'000U}) {
    const std::size_t count = file->read_at(at, std::as_writable_bytes(std::span(part)));
    EXPECT_EQ(part.substr(0, count), text.substr(at, part.size())) << at;
  }
  EXPECT_EQ(file->read_at(text.size(), std::as_writable_bytes(std::span(part))), 0U);
}

TEST_F(ZipFilesTest, NamesAreThoseOfAnyProgram) {
  put(zip_of({{"./tileset.json", "t"}, {"b\\c.glb", "c"}, {"/d/e.glb", "e"}, {"././f/", ""}}));
  EXPECT_EQ(read("w/a.3tz/tileset.json"), "t");
  EXPECT_EQ(read("w/a.3tz/b/c.glb"), "c");
  EXPECT_THAT(zip_.list("w/a.3tz"),
              ElementsAre("w/a.3tz/b/c.glb", "w/a.3tz/d/e.glb", "w/a.3tz/tileset.json"));
}

TEST_F(ZipFilesTest, TwoDifferentFilesOfOneNameAreRefused) {
  EXPECT_THAT(failure(zip_of({{"t", "one"}, {"u", "x"}, {"t", "two"}})),
              HasSubstr("has two different files t; unpack it"));
  EXPECT_THAT(failure(zip_of({{"t", "one"}, {"./t", "three"}})), HasSubstr("two different files"));
  put(zip_of({{"t", "one"}, {"./t", "one", 8}}));
  EXPECT_EQ(read("w/a.3tz/t"), "one") << "the same file twice";
}

TEST_F(ZipFilesTest, ItLooksAsAFolderDoes) {
  put(zip_of({{"tileset.json", "t"}, {"b/c.glb", "c"}, {"b/d/e.glb", "e"}, {"b/d/f.glb", "f"}}));
  EXPECT_EQ(zip_.kind("w/a.3tz"), FileKind::regular);
  EXPECT_EQ(zip_.kind("w/a.3tz/b"), FileKind::directory);
  EXPECT_EQ(zip_.kind("w/a.3tz/b/c.glb"), FileKind::regular);
  EXPECT_EQ(zip_.kind("w/a.3tz/c.glb"), FileKind::none);
  EXPECT_TRUE(zip_.exists("w/a.3tz/b/d/f.glb"));
  EXPECT_THAT(zip_.children("w/a.3tz/b"), ElementsAre("w/a.3tz/b/c.glb", "w/a.3tz/b/d"));
  EXPECT_THAT(zip_.list("w/a.3tz/b/d"), ElementsAre("w/a.3tz/b/d/e.glb", "w/a.3tz/b/d/f.glb"));
  EXPECT_THAT(failure(zip_of({}), "w/a.3tz/x"), HasSubstr("the archive has no such file"));
  files_.put("w/b.3tz/tileset.json", "a folder of that name");
  EXPECT_EQ(read("w/b.3tz/tileset.json"), "a folder of that name");
}

TEST_F(ZipFilesTest, AnArchiveThatIsReplacedIsReadAnew) {
  put(zip_of({{"t", "before"}}));
  EXPECT_EQ(read("w/a.3tz/t"), "before");
  put(zip_of({{"t", "behind it"}}));
  EXPECT_EQ(read("w/a.3tz/t"), "behind it");
}

TEST_F(ZipFilesTest, WhatIsNotReadIsRefused) {
  EXPECT_THAT(failure("no archive at all, but some bytes"), HasSubstr("has no end"));
  EXPECT_THAT(failure(zip_of({{"t", "t", 0, 1}})), HasSubstr("w/a.3tz/t: is encrypted"));
  EXPECT_THAT(failure(zip_of({{"t", "t", 12}})), HasSubstr("is packed by method 12"));
  std::string damaged = zip_of({{"t", "some text", 8}});
  damaged[damaged.find("some")] = 'S';
  EXPECT_THAT(failure(damaged), HasSubstr("is damaged"));
}

TEST_F(ZipFilesTest, NoBrokenArchiveIsReadBeyondItsEnd) {
  const std::string whole =
      zip_of({{"t", "stored"}, {"u", "deflated", 8}, {"v", "zstandard", 93, 0, true}});
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes)
    EXPECT_NE(failure(whole.substr(0, bytes)), "") << bytes;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char mask : {'\x01', '\x80', '\xff'}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ mask);
      for (const char* name : {"t", "u", "v"})
        failure(changed, fs::path("w/a.3tz") / name);  // or not, but no other error
    }
  }
}

}  // namespace
}  // namespace meshhier::storage
