// 3D Tiles archives as folders: what is found in them, and what is refused.
#include "storage/io/zip_files.h"

#include "base/error.h"
#include "storage/io/little_endian.h"
#include "tests/support/memory_files.h"

#include <cstdint>
#include <filesystem>
#include <functional>
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

template <class T>
std::string zip_number(T value) {
  std::string bytes(sizeof(T), '\0');
  store_little(value, reinterpret_cast<std::byte*>(bytes.data()));
  return bytes;
}
std::string u16(std::size_t value) {
  return zip_number(static_cast<std::uint16_t>(value));
}
std::string u32(std::size_t value) {
  return zip_number(static_cast<std::uint32_t>(value));
}
std::string u64(std::uint64_t value) {
  return zip_number(value);
}

std::uint32_t zip_crc(const std::string& text) {
  std::uint32_t sum = 0xffffffff;
  for (const char c : text) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit)
      sum = sum >> 1 ^ (sum & 1 ? 0xedb88320U : 0U);
  }
  return ~sum;
}

/// Text in a block of Deflate, or in a frame of Zstandard, that packs nothing.
std::string deflated(const std::string& text) {
  return "\x01" + u16(text.size()) + u16(~text.size()) + text;
}
std::string in_zstd(const std::string& text) {
  return "\x28\xB5\x2F\xFD\x20" + std::string(1, static_cast<char>(text.size())) +
         u32(text.size() << 3 | 1).substr(0, 3) + text;
}

struct ZipPart {
  std::string name, content;
  std::uint16_t method = 0;
  std::uint16_t flags = 0;
  bool is_zip64 = false;
};

std::string packed_text(const ZipPart& part) {
  return part.method == 8    ? deflated(part.content)
         : part.method == 93 ? in_zstd(part.content)
                             : part.content;
}

std::string zip_of(const std::vector<ZipPart>& parts, const std::string& comment = "") {
  std::string bytes, directory;
  bool is_zip64 = false;
  for (const ZipPart& part : parts) {
    const std::string packed = packed_text(part);
    const std::string middle =
        u16(part.flags) + u16(part.method) + u32(0) + u32(zip_crc(part.content));
    const std::string sizes = part.is_zip64 ? u32(0xffffffff) + u32(0xffffffff)
                                            : u32(packed.size()) + u32(part.content.size());
    const std::string extra = part.is_zip64 ? u16(1) + u16(24) + u64(part.content.size()) +
                                                  u64(packed.size()) + u64(bytes.size())
                                            : "";
    directory += "PK\1\2" + u16(45) + u16(45) + middle + sizes + u16(part.name.size()) +
                 u16(extra.size()) + u16(0) + u16(0) + u16(0) + u32(0) +
                 u32(part.is_zip64 ? 0xffffffff : bytes.size()) + part.name + extra;
    bytes += "PK\3\4" + u16(45) + middle + sizes + u16(part.name.size()) + u16(3) + part.name +
             "xyz" + packed;
    is_zip64 = is_zip64 || part.is_zip64;
  }
  const std::size_t begin = bytes.size();
  bytes += directory;
  if (is_zip64) {
    const std::size_t end64 = bytes.size();
    bytes += "PK\6\6" + u64(44) + u16(45) + u16(45) + u32(0) + u32(0) + u64(parts.size()) +
             u64(parts.size()) + u64(directory.size()) + u64(begin) + "PK\6\7" + u32(0) +
             u64(end64) + u32(1);
  }
  return bytes + "PK\5\6" + u16(0) + u16(0) + u16(parts.size()) + u16(parts.size()) +
         u32(is_zip64 ? 0xffffffff : directory.size()) + u32(is_zip64 ? 0xffffffff : begin) +
         u16(comment.size()) + comment;
}

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
      ZipFiles(files_).open(path);  // one that knows no archive before
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
    EXPECT_EQ(read("w/a.3tz/b/c.glb"), "deflated") << "as it was kept";
    EXPECT_EQ(read("w/a.3tz/b/./d/e.glb"), "zstandard");
    EXPECT_EQ(zip_.identity("w/a.3tz/b/c.glb").bytes, 8U);
  }
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
