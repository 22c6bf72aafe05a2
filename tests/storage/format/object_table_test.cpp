#include "storage/format/object_table.h"

#include "base/error.h"
#include "storage/format/gzip.h"
#include "storage/format/object_block.h"
#include "storage/format/object_facts.h"
#include "storage/io/little_endian.h"
#include "support/memory_files.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <map>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::ObjectTable;
using storage::ObjectTableFacts;
using storage::ObjectTableWriter;
using testing::HasSubstr;
using Rows = std::vector<ObjectRow>;
using Range = ObjectTable::Range;

const char* const kTable = "/models/objects.bin";

std::vector<ObjectProperty> four_properties() {
  return {{"height", ObjectPropertyType::number},
          {"is listed", ObjectPropertyType::boolean},
          {"address", ObjectPropertyType::text},
          {"built", ObjectPropertyType::date}};
}

/// A row whose values differ from one to the next; each value is missing now and then.
ObjectRow sample_row(std::string name, std::uint32_t i) {
  ObjectRow row{std::move(name), std::vector<ObjectValue>(4), {}, 3 * i, 0.5 * i};
  if (i % 3 != 0)
    row.values[0] = 1.0 / i;
  if (i % 4 != 0)
    row.values[1] = i % 8 < 4;
  if (i % 5 != 0)
    row.values[2] = fmt::format("Straße {}", i);
  if (i % 7 != 0)
    row.values[3] = fmt::format("19{:02}-01-31", i % 100);
  if (i % 11 != 0)
    row.box = BoundsD{{-1.0 * i, 0.1, 1e300}, {1e-300, 0.1 * (i + 1), 1e301}};
  return row;
}

Rows sample_rows(std::uint32_t count, const std::string& start = "") {
  Rows rows;
  for (std::uint32_t i = 0; i < count; ++i)
    rows.push_back(sample_row(fmt::format("{}{:06}/{}", start, i / 3, i % 3), i));
  return rows;
}

ObjectTableFacts write(MemoryFiles& files, const Rows& rows,
                       const std::vector<ObjectProperty>& properties = four_properties()) {
  const auto file = files.create(kTable);
  ObjectTableWriter writer(*file, properties);
  for (const ObjectRow& row : rows)
    writer.add(row);
  return writer.finish();
}

Rows read_all(const ObjectTable& table) {
  Rows rows;
  table.for_each([&](std::uint32_t object, const ObjectRow& row) {
    EXPECT_EQ(object, rows.size());
    rows.push_back(row);
  });
  return rows;
}

TEST(ObjectTableTest, GivesEachRowBack) {
  for (const std::uint32_t count : {0U, 1U, 255U, 256U, 257U, 5000U}) {
    MemoryFiles files;
    const Rows rows = sample_rows(count);
    const ObjectTableFacts facts = write(files, rows);
    EXPECT_EQ(facts.objects, count);
    EXPECT_EQ(facts.bytes, files.bytes(kTable).size());
    EXPECT_EQ(facts.checksum, storage::checksum(files.bytes(kTable)));
    const ObjectTable table(files.open(kTable), &facts);
    EXPECT_EQ(table.size(), count);
    EXPECT_EQ(table.properties(), four_properties());
    EXPECT_EQ(read_all(table), rows);
    for (std::uint32_t i = 0; i < count; i += 1 + i / 7) {
      EXPECT_EQ(table.row(i), rows[i]);
      EXPECT_EQ(table.find(rows[i].name), i);
    }
    EXPECT_EQ(table.find("000000/"), std::nullopt);
    EXPECT_EQ(table.find("zz"), std::nullopt);
    EXPECT_EQ(table.range_of_prefix(""), (Range{0, count}));
  }
}

TEST(ObjectTableTest, APrefixIsARange) {
  MemoryFiles files;
  write(files, sample_rows(3000));
  const ObjectTable table(files.open(kTable));
  EXPECT_EQ(table.range_of_prefix("000100"), (Range{300, 303}));
  EXPECT_EQ(table.range_of_prefix("0001"), (Range{300, 600}));
  EXPECT_EQ(table.range_of_prefix("000255/1"), (Range{766, 767}));
  EXPECT_EQ(table.range_of_prefix("0001000"), (Range{303, 303}));
  EXPECT_EQ(table.range_of_prefix("~"), (Range{3000, 3000}));
  EXPECT_EQ(table.range_of_prefix(" "), (Range{0, 0}));
}

/// Names that are alike over more bytes than the directory keeps of them.
TEST(ObjectTableTest, LongNamesAreFoundInTheirBlocks) {
  MemoryFiles files;
  Rows rows = sample_rows(700, std::string(1000, 'b'));
  rows.insert(rows.begin(), sample_row("a", 1));
  rows.push_back(sample_row("c", 2));
  write(files, rows);
  EXPECT_LT(files.bytes(kTable).size(), 100000U);
  const ObjectTable table(files.open(kTable));
  for (std::uint32_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(table.find(rows[i].name), i);
  EXPECT_EQ(table.range_of_prefix("bb"), (Range{1, 701}));
  EXPECT_EQ(table.range_of_prefix(std::string(1000, 'b') + "0001"), (Range{301, 601}));
  EXPECT_EQ(table.find(std::string(1000, 'b')), std::nullopt);
}

TEST(ObjectTableTest, LargeRowsLieInBlocksOfTheirOwn) {
  MemoryFiles files;
  Rows rows = sample_rows(30);
  for (ObjectRow& row : rows)
    row.values[2] = std::string(40000, 'x') + row.name;
  rows[7].values[2] = std::string(kMostObjectTextBytes - 8 - 10, 'y');
  rows[7].values[3] = std::string(10, 'z');
  const ObjectTableFacts facts = write(files, rows);
  EXPECT_EQ(read_all(ObjectTable(files.open(kTable), &facts)), rows);
  rows[7].values[3] = std::string(11, 'z');
  try {
    write(files, rows);
    ADD_FAILURE() << "a row of more than 1 MiB";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_THAT(error.what(), HasSubstr("object \"000002/1\" has a name and texts of 1048577"));
  }
}

TEST(ObjectTableTest, OneMayHaveNoNameAndNoProperties) {
  MemoryFiles files;
  const Rows rows{{"", {}, {}, 12, 0}, {"a", {}, BoundsD{{0, 0, 0}, {0, 0, 0}}, 0, 0}};
  write(files, rows, {});
  const ObjectTable table(files.open(kTable));
  EXPECT_EQ(read_all(table), rows);
  EXPECT_EQ(table.find(""), 0U);
}

TEST(ObjectTableTest, TheManifestTellsOfIt) {
  MemoryFiles files;
  const ObjectTableFacts facts = write(files, sample_rows(300));
  const nlohmann::ordered_json json = storage::object_facts_json(facts);
  const auto read = [](const nlohmann::ordered_json& objects) {
    return storage::read_object_facts(storage::JsonObject(objects, "objects.", "h.json"));
  };
  EXPECT_EQ(read(json), facts);
  const std::map<std::string, std::string> wrong{
      {"file", R"("a.bin")"},
      {"count", "16777217"},
      {"checksum", "1"},
      {"directory", R"({"bytes": 1})"},
      {"properties", R"([{"name": "", "type": "text"}])"}};
  for (const auto& [key, value] : wrong) {
    nlohmann::ordered_json changed = json;
    changed[key] = nlohmann::ordered_json::parse(value);
    EXPECT_THROW(read(changed), Error) << key;
  }
  nlohmann::ordered_json twice = json;
  twice["properties"].push_back(json["properties"][0]);
  EXPECT_THROW(read(twice), Error);

  for (const auto number : {&ObjectTableFacts::bytes, &ObjectTableFacts::directory_bytes,
                            &ObjectTableFacts::directory_checksum}) {
    ObjectTableFacts other = facts;
    ++(other.*number);
    EXPECT_THROW(ObjectTable(files.open(kTable), &other), Error);
  }
}

/// Reads a table in every way; returns the message of its refusal.
std::string failure(MemoryFiles& files) {
  return tests::error_message(
      ErrorCode::corrupt,
      [&] {
        const ObjectTable table(files.open(kTable));
        table.for_each([&](std::uint32_t object, const ObjectRow& row) {
          EXPECT_EQ(table.find(row.name), object);
        });
      },
      kTable);
}

TEST(ObjectTableTest, SANITIZED_EveryFlippedBitIsFound) {
  MemoryFiles files;
  write(files, sample_rows(520));
  auto& bytes = files.bytes(kTable);
  std::mt19937 random(5);
  for (std::size_t i = 0; i<bytes.size(); i += bytes.size() - i> 60 && i > 20 ? 7 : 1) {
    const std::byte before = bytes[i];
    bytes[i] ^= static_cast<std::byte>(1U << random() % 8);
    EXPECT_NE(failure(files), "") << "byte " << i;
    bytes[i] = before;
  }
  EXPECT_EQ(failure(files), "");
}

TEST(ObjectTableTest, SANITIZED_ATableThatIsCutIsRefused) {
  MemoryFiles files;
  write(files, sample_rows(20));
  auto& bytes = files.bytes(kTable);
  while (!bytes.empty()) {
    bytes.pop_back();
    EXPECT_NE(failure(files), "") << bytes.size();
  }
}

/// A table of one block that is whatever it is said to be, with the right checksums.
void put_forged(MemoryFiles& files, const std::vector<std::byte>& block, std::uint32_t count,
                const std::string& key) {
  write(files, {}, four_properties());
  std::vector<std::byte>& bytes = files.bytes(kTable);
  bytes.resize(12);
  const auto append = [&](const std::vector<std::byte>& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  const auto packed = storage::gzip(block);
  append(packed);
  const storage::ObjectDirectory directory{
      four_properties(),
      {{12, static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(block.size()), 0,
        count, storage::checksum(packed), key}}};
  const auto plain = storage::encode_object_directory(directory);
  const auto sealed = storage::gzip(plain);
  append(sealed);
  storage::append_little(bytes, std::uint64_t{sealed.size()});
  storage::append_little(bytes, std::uint64_t{plain.size()});
  storage::append_little(bytes, storage::checksum(sealed));
}

/// The failure of a block of such rows.
std::string failure_of(const Rows& rows, std::uint32_t count) {
  MemoryFiles files;
  put_forged(files, storage::encode_object_block(rows, four_properties()), count,
             rows.front().name);
  return failure(files);
}

std::string failure_of(const Rows& rows) {
  return failure_of(rows, static_cast<std::uint32_t>(rows.size()));
}

TEST(ObjectTableTest, SANITIZED_WhatNoWriterWritesIsRefused) {
  const Rows good = sample_rows(8);
  EXPECT_EQ(failure_of(good), "");
  const auto changed = [&](const auto& change) {
    Rows rows = good;
    change(rows[4]);
    return failure_of(rows);
  };
  EXPECT_THAT(changed([](ObjectRow& row) { row.name = "\xff"; }), HasSubstr("no UTF-8"));
  EXPECT_THAT(changed([](ObjectRow& row) { row.name = "0"; }), HasSubstr("do not ascend"));
  EXPECT_THAT(changed([](ObjectRow& row) { row.values[0] = 1.0 / 0.0; }), HasSubstr("finite"));
  EXPECT_THAT(changed([](ObjectRow& row) { row.values[2] = "\xed\xa0\x80"; }),
              HasSubstr("no UTF-8"));
  EXPECT_THAT(changed([](ObjectRow& row) { row.box->min.z = 2e301; }), HasSubstr("turned"));
  EXPECT_THAT(changed([](ObjectRow& row) { row.area = -1; }), HasSubstr("negative"));
  EXPECT_THAT(failure_of(good, 7), HasSubstr("a column"));
  EXPECT_THAT(failure_of(good, 9), HasSubstr("a column"));
  EXPECT_THAT(failure_of(good, 0), HasSubstr("no objects"));
  EXPECT_THAT(failure_of(good, 257), HasSubstr("too many"));
  MemoryFiles files;
  put_forged(files, storage::encode_object_block(good, four_properties()), 8, "000000/");
  EXPECT_THAT(failure(files), HasSubstr("does not begin with the name"));
}

/// Each byte of an unpacked block, changed: it is read as something else or refused.
TEST(ObjectTableTest, SANITIZED_ChangedBlocksDoNoHarm) {
  const Rows rows = sample_rows(3);
  const auto block = storage::encode_object_block(rows, four_properties());
  for (std::size_t i = 0; i < block.size(); ++i) {
    for (const int value : {0, 1, 2, 127, 255}) {
      auto other = block;
      other[i] = static_cast<std::byte>(value);
      try {
        const Rows read = storage::decode_object_block(other, 3, four_properties(), "b");
        EXPECT_EQ(storage::encode_object_block(read, four_properties()), other);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::corrupt);
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::tests
