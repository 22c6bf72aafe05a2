#include "progressive/stream_index.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/io/hash.h"
#include "tests/support/error_message.h"
#include "tests/support/memory_files.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using progressive::ProgressiveFile;
using progressive::ProgressiveIndex;
using testing::HasSubstr;
using testing::StartsWith;
using IndexJson = nlohmann::ordered_json;

constexpr const char* kStreamName = "some/progressive.json";

progressive::ProgressiveIndex some_index() {
  progressive::ProgressiveIndex index;
  index.generator = "meshhier 0.1.0";
  index.source.file_name = "a \"b\".ply";
  index.source.vertices = 10;
  index.source.places = 9;
  index.source.triangles = 12;
  index.source.bounds = {{-1, 0.1, 2}, {3, 4, 5}};
  index.source.attributes = {true, ColourType::u16, false, true};
  index.node = {static_cast<Level>(3), 5};
  index.vertices = UINT32_MAX;
  index.own_vertices = 7;
  index.triangles = 12;
  index.origin = {1234567.891, 0, -0.0};
  index.up = UpAxis::z;
  index.licence = "CC BY";
  index.files = {{static_cast<Level>(3), 1, 2, 3, 4, 5, 6, 0xFEDCBA9876543210},
                 {static_cast<Level>(32), UINT32_MAX, 8, 9, 10, 11,
                  128 * (UINT32_MAX + std::uint64_t{18}), 0}};
  return index;
}

progressive::ProgressiveIndex parse(const std::string& text) {
  return progressive::parse_progressive_index(text, kStreamName);
}

std::string index_flaw(const std::string& text) {
  return tests::error_message(
      ErrorCode::corrupt, [&] { parse(text); }, std::string(kStreamName) + ": ");
}

/// With the checksum that fits it.
std::string resealed(IndexJson document) {
  document.erase("checksum");
  document["checksum"] = std::string(16, '0');
  std::string text = document.dump(2) + "\n";
  const auto sum = storage::checksum(std::as_bytes(std::span(text)));
  return text.replace(text.size() - 20, 16, fmt::format("{:016x}", sum));
}

TEST(ProgressiveIndex, GivesEveryValueBack) {
  const progressive::ProgressiveIndex index = some_index();
  const progressive::ProgressiveIndex again = parse(to_json_text(index));
  EXPECT_EQ(again.generator, index.generator);
  EXPECT_EQ(again.source.file_name, index.source.file_name);
  EXPECT_EQ(again.source.attributes, index.source.attributes);
  EXPECT_EQ(again.source.bounds, index.source.bounds);
  EXPECT_EQ(again.node, index.node);
  EXPECT_EQ(again.vertices, index.vertices);
  EXPECT_EQ(again.own_vertices, index.own_vertices);
  EXPECT_EQ(again.triangles, index.triangles);
  EXPECT_EQ(again.origin, index.origin);
  EXPECT_EQ(again.up, index.up);
  EXPECT_EQ(again.licence, index.licence);
  ASSERT_EQ(again.files.size(), index.files.size());
  for (std::size_t i = 0; i < index.files.size(); ++i) {
    const progressive::ProgressiveFile &a = again.files[i], &b = index.files[i];
    EXPECT_EQ(a.level, b.level);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.merges, b.merges);
    EXPECT_EQ(a.shown_vertices, b.shown_vertices);
    EXPECT_EQ(a.shown_triangles, b.shown_triangles);
    EXPECT_EQ(a.bytes, b.bytes);
    EXPECT_EQ(a.checksum, b.checksum);
  }
  EXPECT_EQ(to_json_text(again), to_json_text(index));
}

TEST(ProgressiveIndex, IsReadable) {
  const std::string text = to_json_text(some_index());
  EXPECT_THAT(text,
              StartsWith("{\n  \"format\": \"meshhier-progressive\",\n  \"format_version\": 2,\n"));
  EXPECT_THAT(text, HasSubstr("\"file\": \"base.bin\""));
  EXPECT_THAT(text, HasSubstr("\"file\": \"detail_01.bin\""));
  EXPECT_EQ(resealed(IndexJson::parse(text)), text);
}

TEST(ProgressiveIndex, SANITIZED_EveryFlippedBitIsFound) {
  std::string text = to_json_text(some_index());
  for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
    const char whole = text[bit / 8];
    text[bit / 8] = static_cast<char>(whole ^ (1 << bit % 8));
    EXPECT_NE(index_flaw(text), "") << bit;
    text[bit / 8] = whole;
  }
}

TEST(ProgressiveIndex, SANITIZED_TruncationAtEveryByteIsRefused) {
  const std::string text = to_json_text(some_index());
  for (std::size_t size = 0; size < text.size(); ++size)
    EXPECT_NE(index_flaw(text.substr(0, size)), "") << size;
  EXPECT_NE(index_flaw(text + " "), "");
}

TEST(ProgressiveIndex, SANITIZED_OtherFormatsAndVersionsAreRefusedByTheirNumber) {
  IndexJson document = IndexJson::parse(to_json_text(some_index()));
  document["format_version"] = 3;
  EXPECT_THAT(index_flaw(document.dump()),
              HasSubstr("format version 3 is newer than 2, the newest known"));
  document["format_version"] = 1;
  EXPECT_THAT(index_flaw(document.dump()),
              HasSubstr("was made with format version 1, this program reads 2: make it again from "
                        "its hierarchy"));
  document["format"] = "meshhier";
  EXPECT_THAT(index_flaw(document.dump()), HasSubstr("\"format\" is wrong"));
}

TEST(ProgressiveIndex, EveryMissingKeyIsNamed) {
  const IndexJson good = IndexJson::parse(to_json_text(some_index()));
  for (const char* key : {"generator", "source", "level", "index", "vertices", "own_vertices",
                          "triangles", "origin", "up", "licence", "files"}) {
    IndexJson changed = good;
    changed.erase(key);
    EXPECT_THAT(index_flaw(resealed(changed)), HasSubstr(fmt::format("\"{}\" is missing", key)));
  }
  for (const char* key : {"level", "vertices", "triangles", "merges", "shown_vertices",
                          "shown_triangles", "bytes", "checksum"}) {
    IndexJson changed = good;
    changed["files"][1].erase(key);
    EXPECT_THAT(index_flaw(resealed(changed)),
                HasSubstr(fmt::format("\"files.{}\" is missing", key)));
  }
}

TEST(ProgressiveIndex, SANITIZED_EveryWrongValueIsNamed) {
  struct Damage {
    const char* pointer;
    IndexJson value;
    const char* message;
  };
  const std::vector<Damage> damages{
      {"/level", 33, "\"level\" is wrong, expected an integer from 0 to 32"},
      {"/index", 4294967296ULL, "\"index\" is wrong"},
      {"/vertices", 0, "\"vertices\" is wrong, expected at least 1"},
      {"/vertices", 4294967296ULL, "\"vertices\" is wrong"},
      {"/own_vertices", -1, "\"own_vertices\" is wrong"},
      {"/own_vertices", 4294967296ULL, "\"own_vertices\" is wrong"},
      {"/triangles", 1.5, "\"triangles\" is wrong"},
      {"/triangles", 72057594037927937ULL, "\"triangles\" is wrong"},
      {"/origin", IndexJson::array({1, 2}), "\"origin\" is wrong, expected three numbers"},
      {"/up", "x", "\"up\" is wrong"},
      {"/licence", nullptr, "\"licence\" is wrong"},
      {"/files", IndexJson::array(), "\"files\" is wrong, expected at least one"},
      {"/files", 3, "\"files\" is wrong, expected an array"},
      {"/files/0", 3, "\"files\" is wrong, expected an array of objects"},
      {"/files/0/level", 33, "\"files.level\" is wrong"},
      {"/files/1/vertices", 4294967296ULL, "\"files.vertices\" is wrong"},
      {"/files/1/triangles", 13, "\"files.triangles\" is wrong"},
      {"/files/1/merges", 4294967296ULL, "\"files.merges\" is wrong"},
      {"/files/1/shown_triangles", 13, "\"files.shown_triangles\" is wrong"},
      {"/files/0/bytes", 897, "\"files.bytes\" is wrong, expected an integer from 0 to 896"},
      {"/files/1/bytes", -1, "\"files.bytes\" is wrong"},
      {"/files/1/checksum", "FEDCBA9876543210", "\"files.checksum\" is wrong"},
      {"/source/vertices", 0, "\"source.vertices\" is wrong"},
      {"/source/places", 11, "\"source.places\" is wrong"}};
  const IndexJson good = IndexJson::parse(to_json_text(some_index()));
  for (const Damage& damage : damages) {
    IndexJson changed = good;
    changed[IndexJson::json_pointer(damage.pointer)] = damage.value;
    EXPECT_THAT(index_flaw(resealed(changed)), HasSubstr(damage.message)) << damage.pointer;
  }
  IndexJson fewer = good;
  fewer["vertices"] = 6;
  EXPECT_THAT(index_flaw(resealed(fewer)), HasSubstr("\"own_vertices\" is wrong"));
}

TEST(ProgressiveIndex, ADetailFileIsTheOneThatIsTold) {
  MemoryFiles files;
  progressive::ProgressiveIndex index = some_index();
  files.put("a.prog/base.bin", "content");
  index.files[0].bytes = 7;
  index.files[0].checksum = storage::checksum(std::as_bytes(std::span("content", 7)));
  EXPECT_EQ(progressive::read_detail_file(files, "a.prog", index, 0).size(), 7U);
  const auto code = [&](std::uint32_t step) {
    try {
      progressive::read_detail_file(files, "a.prog", index, step);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(storage::detail_path("a.prog", step).string()));
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code(1), ErrorCode::io);
  files.put("a.prog/base.bin", "Content");
  EXPECT_EQ(code(0), ErrorCode::corrupt);
  files.put("a.prog/base.bin", "conten");
  EXPECT_EQ(code(0), ErrorCode::corrupt);
  files.put("a.prog/base.bin", "contents");
  EXPECT_EQ(code(0), ErrorCode::corrupt);
}

}  // namespace
}  // namespace meshhier::tests
