#include "storage/format/archive.h"

#include "base/error.h"
#include "storage/format/archive_check.h"
#include "storage/format/archive_files.h"
#include "storage/format/archive_writer.h"
#include "storage/format/glb.h"
#include "storage/format/gzip.h"
#include "storage/io/hash.h"
#include "tests/support/error_message.h"
#include "tests/support/hollow_file.h"
#include "tests/support/memory_files.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Bytes = tests::MemoryFiles::Bytes;

constexpr const char* kPath = "/m/a.3tz";

/// Names and contents, in the archive's order.
using Members = std::vector<std::pair<std::string, std::string>>;

const Members& some_members() {
  static const Members members = {{"hierarchy.json", "{}"},
                                  {"tiles.bin", std::string(300, 'x')},
                                  {"tiles/00/000000.glb", "glTF"},
                                  {"tileset.json", "{ }"}};
  return members;
}

class ArchiveTest : public testing::Test {
 protected:
  Bytes& pack(const Members& members) {
    const auto archive = files_.create(kPath);
    ArchiveWriter writer(*archive, [] {});
    for (const auto& [name, content] : members) {
      files_.put("/m/content", content);
      writer.add(name, *files_.open("/m/content"));
    }
    writer.finish();
    EXPECT_EQ(writer.bytes(), archive->size());
    return files_.bytes(kPath);
  }

  /// Returns the error of opening the archive, or of checking it; empty if there is none.
  std::string complaint() {
    std::string all;
    try {
      const Archive archive(files_.open(kPath));
      check_archive(
          archive, [] {}, [&](const std::string& problem) { all += problem + '\n'; });
    } catch (const Error& error) {
      EXPECT_TRUE(error.code() == ErrorCode::corrupt || error.code() == ErrorCode::io);
      all += error.what();
    }
    return all;
  }

  /// The message of the Error(corrupt) that opening the archive ends with.
  std::string refusal() {
    return tests::error_message(ErrorCode::corrupt,
                                [&] { const Archive archive(files_.open(kPath)); });
  }

  tests::MemoryFiles files_;
};

/// An archive as somebody else may make it: any headers, in a zip that adds up.
struct Forged {
  std::vector<ArchiveEntry> local;
  std::vector<ArchiveEntry> central;
};

Bytes bytes_of(const Forged& forged, std::uint64_t index_bytes) {
  Bytes bytes;
  for (const ArchiveEntry& entry : forged.local) {
    append_local_header(bytes, entry);
    bytes.resize(bytes.size() + entry.bytes);
  }
  const ArchiveEntry index{std::string(kArchiveIndexName), bytes.size(),
                           static_cast<std::uint32_t>(index_bytes), 0};
  append_local_header(bytes, index);
  bytes.resize(index.end());
  ArchiveEnd end{forged.central.size() + 1, index.end(), 0};
  for (const ArchiveEntry& entry : forged.central)
    append_central_header(bytes, entry);
  append_central_header(bytes, index);
  end.directory_bytes = bytes.size() - end.directory;
  const Bytes last = encode_archive_end(end);
  bytes.insert(bytes.end(), last.begin(), last.end());
  return bytes;
}

/// Entries of these names and sizes, one behind the other.
std::vector<ArchiveEntry> in_a_row(const std::vector<std::pair<std::string, std::uint32_t>>& all) {
  std::vector<ArchiveEntry> entries;
  for (const auto& [name, bytes] : all)
    entries.push_back({name, entries.empty() ? 0 : entries.back().end(), bytes, 0});
  return entries;
}

TEST_F(ArchiveTest, HoldsWhatWasPutIntoIt) {
  pack(some_members());
  EXPECT_EQ(complaint(), "");
  ArchiveFiles inside(files_, kPath);
  std::vector<fs::path> paths;
  for (const auto& [name, content] : some_members()) {
    const fs::path path = fs::path(kPath) / name;
    EXPECT_TRUE(inside.exists(path));
    const Bytes bytes = read_file(inside, path, 1000);
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), content);
    EXPECT_EQ(inside.identity(path).bytes, content.size());
    paths.push_back(path);
  }
  std::sort(paths.begin(), paths.end());
  EXPECT_EQ(inside.list(kPath), paths);
  EXPECT_THAT(inside.list(fs::path(kPath) / "tiles"),
              ElementsAre(fs::path(kPath) / "tiles/00/000000.glb"));
}

TEST_F(ArchiveTest, HasItsIndexLastInTheOrderOfTheMd5s) {
  const Bytes& bytes = pack(some_members());
  std::vector<ArchiveEntry> entries;
  Archive(files_.open(kPath)).for_each([&](const ArchiveEntry& e) { entries.push_back(e); });
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(entries.back().name, "@3dtilesIndex1@");
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t> expected;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto digest = md5(entries[i].name);
    expected[{load_little<std::uint64_t>(digest.data()),
              load_little<std::uint64_t>(digest.data() + 8)}] = entries[i].offset;
  }
  const std::byte* at = bytes.data() + entries.back().content();
  for (const auto& [hash, offset] : expected) {
    EXPECT_EQ(load_little<std::uint64_t>(at), hash.first);
    EXPECT_EQ(load_little<std::uint64_t>(at + 8), hash.second);
    EXPECT_EQ(load_little<std::uint64_t>(at + 16), offset);
    at += 24;
  }
}

TEST_F(ArchiveTest, OfNoFilesIsOne) {
  pack({});
  EXPECT_EQ(complaint(), "");
  EXPECT_FALSE(is_hierarchy_archive(files_, kPath));
}

TEST_F(ArchiveTest, IsAHierarchysIfItBeginsWithAManifest) {
  pack(some_members());
  EXPECT_TRUE(is_hierarchy_archive(files_, kPath));
  EXPECT_FALSE(is_hierarchy_archive(files_, "/m"));
  EXPECT_FALSE(is_hierarchy_archive(files_, "/nothing"));
  files_.put(kPath, "a text");
  EXPECT_FALSE(is_hierarchy_archive(files_, kPath));
}

TEST_F(ArchiveTest, IsReadOnly) {
  pack(some_members());
  ArchiveFiles inside(files_, kPath);
  const auto file = inside.open(fs::path(kPath) / "tiles.bin");
  EXPECT_THROW(file->write_at(0, Bytes(1)), Error);
  EXPECT_THROW(inside.open(fs::path(kPath) / "tiles"), Error);
  Bytes two(2);
  EXPECT_THROW(file->read_exact(299, two), Error);
}

TEST_F(ArchiveTest, SANITIZED_AFlippedBitAnywhereIsFound) {
  Bytes& bytes = pack(some_members());
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[at] ^= std::byte{1} << bit;
      EXPECT_NE(complaint(), "") << "bit " << bit << " of byte " << at;
      bytes[at] ^= std::byte{1} << bit;
    }
  }
  EXPECT_EQ(complaint(), "");
}

TEST_F(ArchiveTest, SANITIZED_ATruncationAnywhereIsOneError) {
  const Bytes whole = pack(some_members());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    files_.bytes(kPath).assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    try {
      Archive archive(files_.open(kPath));
      ADD_FAILURE() << size;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), size < 4 ? ErrorCode::io : ErrorCode::corrupt) << size;
      EXPECT_THAT(error.what(), HasSubstr(kPath));
    }
  }
}

TEST_F(ArchiveTest, SANITIZED_MoreBytesAtItsEndAreRefused) {
  pack(some_members()).resize(files_.bytes(kPath).size() + 1);
  EXPECT_THAT(refusal(), HasSubstr("does not end as an archive does"));
}

TEST_F(ArchiveTest, SANITIZED_NamesThatLeadElsewhereAreRefused) {
  for (const char* name : {"../a", "/a", "a/../b", "a/", "", ".", "a//b", "a\\b", "a\nb", "a b"}) {
    const auto entries = in_a_row({{name, 5}});
    files_.create(kPath)->write_at(0, bytes_of({entries, entries}, 24));
    EXPECT_THAT(refusal(), HasSubstr("is no name of a file in a hierarchy")) << name;
  }
}

TEST_F(ArchiveTest, SANITIZED_TwoFilesOfOneNameAreRefused) {
  const auto entries = in_a_row({{"a", 5}, {"b", 5}, {"a", 5}});
  files_.create(kPath)->write_at(0, bytes_of({entries, entries}, 72));
  EXPECT_THAT(refusal(), HasSubstr("two files of one name"));
}

TEST_F(ArchiveTest, SANITIZED_FilesThatOverlapOrLeaveGapsAreRefused) {
  const auto local = in_a_row({{"a", 5}, {"b", 5}});
  for (const std::uint64_t offset : {0U, 35U, 37U, 1000U}) {
    auto central = local;
    central[1].offset = offset;
    files_.create(kPath)->write_at(0, bytes_of({local, central}, 48));
    EXPECT_THAT(refusal(), HasSubstr("not that of a stored file at byte 36")) << offset;
  }
}

TEST_F(ArchiveTest, SANITIZED_WrongSizesAreRefused) {
  const auto local = in_a_row({{"a", 5}, {"b", 5}});
  for (const std::uint32_t bytes : {0U, 4U, 6U, 1000U, 0xffffffffU}) {
    auto central = local;
    central[1].bytes = bytes;
    files_.create(kPath)->write_at(0, bytes_of({local, central}, 48));
    EXPECT_NE(refusal(), "") << bytes;
  }
  files_.create(kPath)->write_at(0, bytes_of({local, local}, 24));
  EXPECT_THAT(refusal(), HasSubstr("expected 24 for each of 2 files"));
}

TEST_F(ArchiveTest, SANITIZED_PackedEncryptedAndCommentedFilesAreRefused) {
  const Bytes whole = pack(some_members());
  std::uint64_t directory = load_little<std::uint32_t>(whole.data() + whole.size() - 6);
  for (const std::size_t field : {4U, 6U, 8U, 10U, 12U, 14U, 30U, 32U, 34U, 36U, 38U}) {
    files_.bytes(kPath) = whole;
    files_.bytes(kPath)[directory + field] ^= std::byte{8};
    EXPECT_NE(refusal(), "") << field;
  }
}

TEST_F(ArchiveTest, SANITIZED_ZeroFilesOrMoreThanThereAreAreRefused) {
  const Bytes whole = pack(some_members());
  for (const int entries : {0, 1, 4, 6, 1000, 65535}) {
    Bytes& bytes = files_.bytes(kPath) = whole;
    store_little(static_cast<std::uint16_t>(entries), bytes.data() + bytes.size() - 14);
    store_little(static_cast<std::uint16_t>(entries), bytes.data() + bytes.size() - 12);
    EXPECT_NE(refusal(), "") << entries;
  }
}

TEST_F(ArchiveTest, SANITIZED_Zip64RecordsThatLieAreRefused) {
  const Bytes whole = pack(some_members());
  const std::uint64_t size = whole.size() - 22;
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  for (const ArchiveEnd end :
       {ArchiveEnd{most, 1, 1}, ArchiveEnd{5, most, 1}, ArchiveEnd{5, most, most},
        ArchiveEnd{5, 1, most}, ArchiveEnd{65535, size, 0}, ArchiveEnd{65536, 0, size},
        ArchiveEnd{std::uint64_t{1} << 40, size - 300, 300}}) {
    Bytes& bytes = files_.bytes(kPath) = whole;
    bytes.resize(size);
    const Bytes last = encode_archive_end(end);
    ASSERT_EQ(last.size(), kLongestArchiveEnd);
    bytes.insert(bytes.end(), last.begin(), last.end());
    EXPECT_NE(refusal(), "");
  }
}

TEST_F(ArchiveTest, AnIndexThatLeadsElsewhereIsFound) {
  const Bytes whole = pack(some_members());
  std::optional<ArchiveEntry> index;
  Archive(files_.open(kPath)).for_each([&](const ArchiveEntry& entry) { index = entry; });
  const auto content = whole.begin() + static_cast<std::ptrdiff_t>(index->content());
  const auto changed = [&](const std::function<void(Bytes&)>& change) {
    Bytes places(content, content + index->bytes);
    change(places);
    ArchiveEntry entry = *index;
    entry.crc = crc32(places);
    Bytes headers[2], was[2];
    append_local_header(headers[0], entry);
    append_central_header(headers[1], entry);
    append_local_header(was[0], *index);
    append_central_header(was[1], *index);
    Bytes& bytes = files_.bytes(kPath) = whole;
    std::copy(places.begin(), places.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(index->content()));
    for (int i = 0; i < 2; ++i) {
      const auto at = std::search(bytes.begin(), bytes.end(), was[i].begin(), was[i].end());
      ASSERT_NE(at, bytes.end());
      std::copy(headers[i].begin(), headers[i].end(), at);
    }
    EXPECT_THAT(complaint(), HasSubstr("@3dtilesIndex1@: its place at byte"));
  };
  changed([](Bytes& places) { std::swap_ranges(&places[0], &places[24], &places[24]); });
  changed([](Bytes& places) { std::copy_n(places.begin(), 24, places.begin() + 24); });
  changed([](Bytes& places) { places[16] ^= std::byte{1}; });
  changed([](Bytes& places) { places[23] = std::byte{0xff}; });
  changed([&](Bytes& places) { store_little(index->offset, &places[16]); });
}

TEST_F(ArchiveTest, SLOW_MoreFilesThanOldZipCountsAreThere) {
  Members members;
  for (int i = 0; i < 70'000; ++i)
    members.emplace_back(fmt::format("tiles/17/{:06}.glb", i), std::to_string(i));
  for (const std::size_t count : {65533U, 65534U, 70000U}) {
    members.resize(count);
    pack(members);
    EXPECT_EQ(complaint(), "") << count;
    ArchiveFiles inside(files_, kPath);
    EXPECT_EQ(inside.archive().entry_count(), count + 1);
    EXPECT_EQ(inside.open(fs::path(kPath) / members.back().first)->size(), 5U);
    members.resize(70'000, {"", ""});
    for (std::size_t i = count; i < members.size(); ++i)
      members[i] = {fmt::format("tiles/17/{:06}.glb", i), std::to_string(i)};
  }
}

TEST_F(ArchiveTest, SLOW_OffsetsBeyondFourGigabytesAreFound) {
  auto archive = std::make_unique<tests::HollowFile>();
  ArchiveWriter writer(*archive, [] {});
  const tests::HollowFile large((std::uint64_t{3} << 30) + 1);
  files_.put("/m/small", "small");
  writer.add("a/large", large);
  writer.add("b/large", large);
  writer.add("c/small", *files_.open("/m/small"));
  writer.finish();
  EXPECT_GT(writer.bytes(), std::uint64_t{6} << 30);
  const Archive made(std::move(archive));
  const auto place = made.find("c/small");
  ASSERT_TRUE(place);
  EXPECT_EQ(place->offset, 2 * (large.size() + 30 + 7) + 30 + 7);
  Bytes content(place->bytes);
  made.file().read_exact(place->offset, content);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(content.data()), content.size()), "small");
  std::string problems;
  check_archive(
      made, [] {}, [&](const std::string& problem) { problems += problem; });
  EXPECT_EQ(problems, "");
}

TEST_F(ArchiveTest, AFileOfFourGigabytesDoesNotFit) {
  tests::HollowFile archive;
  ArchiveWriter writer(archive, [] {});
  try {
    writer.add("a", tests::HollowFile(std::uint64_t{0xffffffff}));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("a has 4294967295 bytes"));
  }
}

}  // namespace
}  // namespace meshhier::storage
