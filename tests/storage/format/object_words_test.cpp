#include "storage/format/object_words.h"

#include "base/error.h"
#include "import/word_rows.h"
#include "storage/io/spool.h"
#include "support/memory_files.h"

#include <algorithm>
#include <fstream>
#include <random>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using storage::AskedWord;
using storage::LetterTable;
using storage::ObjectTable;
using storage::ObjectTableWriter;
using storage::ObjectWords;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using Names = std::set<std::string>;

const char* const kNames = "/models/objects.bin";
const char* const kWords = "/models/object_words.bin";

const LetterTable& letters() {
  static const LetterTable table(storage::kLetterTable, "letters");
  return table;
}

std::vector<std::string> words(std::string_view name) {
  return letters().words_of(name);
}

TEST(FoldedWordsTest, AreWhatPeopleType) {
  EXPECT_THAT(words("bldg_0042 Church of St. Mary"),
              ElementsAre("bldg", "0042", "church", "of", "st", "mary"));
  EXPECT_THAT(words("district/street/house 7b"), ElementsAre("district", "street", "house", "7b"));
  EXPECT_EQ(words("STRASSE"), words("Straße"));
  EXPECT_EQ(words("Église"), words("E\u0301glise")) << "decomposed, as macOS has names of files";
  EXPECT_THAT(words("Ærø Łódź Đà Nẵng İstanbul"),
              ElementsAre("aero", "lodz", "da", "nang", "istanbul"));
  EXPECT_EQ(words("ΟΔΟΣ Ёлка"), words("οδος елка"));
  EXPECT_EQ(words("ＡＢＣ１２ ﬁn"), words("abc12 fin"));
  EXPECT_EQ(words("서울"), words("\u1109\u1165\u110B\u116E\u11AF"));
  EXPECT_NE(words("कि"), words("कु")) << "vowels of India are no accents";
  EXPECT_THAT(words(" ./-_\n—"), IsEmpty());
  EXPECT_THAT(words("soft\u00ADhyphen"), ElementsAre("softhyphen"));
}

/// The viewer and the Python package are tested by the same file.
TEST(FoldedWordsTest, AreThoseOfOtherReaders) {
  std::ifstream file(MESHHIER_SOURCE_DIR "/tests/data/folded_words.json");
  const auto told = nlohmann::json::parse(file);
  ASSERT_GE(told.at("names").size(), 20U);
  for (const auto& row : told.at("names")) {
    const auto name = row.at("name").get<std::string>();
    EXPECT_EQ(nlohmann::json(words(name)), row.at("words")) << name;
  }
  ASSERT_GE(told.at("texts").size(), 20U);
  for (const auto& row : told.at("texts")) {
    const auto text = row.at("text").get<std::string>();
    auto asked = nlohmann::json::array();
    for (const AskedWord& word : letters().asked_words(text))
      asked.push_back({{"word", word.word}, {"is_beginning", word.is_beginning}});
    EXPECT_EQ(asked, row.at("asked")) << text;
  }
}

TEST(FoldedWordsTest, ScriptsWithoutSpacesAreWordsByPairs) {
  EXPECT_THAT(words("東京タワー2"), ElementsAre("東京", "京タ", "タワ", "ワー", "ー", "2"));
  EXPECT_EQ(words("ﾀﾜ"), words("タワ")) << "half as wide";
  EXPECT_THAT(letters().asked_words("京タワ"),
              ElementsAre(AskedWord{"京タ", false}, AskedWord{"タワ", false}));
  EXPECT_THAT(letters().asked_words("京 mar"),
              ElementsAre(AskedWord{"京", true}, AskedWord{"mar", true}));
  EXPECT_THAT(letters().asked_words("church 京"),
              ElementsAre(AskedWord{"church", false}, AskedWord{"京", true}));
}

TEST(FoldedWordsTest, LongWordsAreCut) {
  EXPECT_THAT(words(std::string(40, 'A')), ElementsAre(std::string(32, 'a')));
}

TEST(FoldedWordsTest, AWrongTableIsOneError) {
  for (const char* text :
       {"41 1a 1 1 61", "41 1a 1\n", "x\n", "41 1a 1 1 61 62\n", "41 0 1 0\n", "41 1 0 0\n",
        "110000 1 1 0\n", "41 ffffffff 1 0\n", "41 1 1 3\n", "41 1 1 0 d800\n", "41 1 1 2 61\n",
        "41 2 1 1 10ffff\n", "61 1 1 0\n41 1 1 0\n", "41  1 1 0\n", "\n", "-41 1 1 0\n"}) {
    try {
      LetterTable(text, "w.bin");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
      EXPECT_THAT(error.what(), StartsWith("w.bin: table of letters: "));
    }
  }
}

class ObjectWordsTest : public testing::Test {
 protected:
  /// Writes both tables.
  void write(const Names& names, std::uint64_t memory = std::uint64_t{1} << 20) {
    {
      const auto file = files_.create(kNames);
      ObjectTableWriter writer(*file, {});
      for (const std::string& name : names)
        writer.add({name, {}, {}, 0, 0});
      writer.finish();
    }
    objects_ = static_cast<std::uint32_t>(names.size());
    storage::MemoryPool pool(0);
    storage::ScratchFile scratch(files_, "scratch", pool);
    const execution::CancelToken cancel;
    std::vector<ObjectRow> rows;
    importing::for_each_word_row(ObjectTable(files_.open(kNames)), letters(),
                                 {scratch, memory, cancel},
                                 [&](ObjectRow row) { rows.push_back(std::move(row)); });
    write_words(rows);
  }

  void write_words(const std::vector<ObjectRow>& rows) {
    const auto file = files_.create(kWords);
    ObjectTableWriter writer(*file, storage::word_properties());
    writer.add(storage::letters_row());
    for (const ObjectRow& row : rows)
      writer.add(row);
    writer.finish();
  }

  ObjectWords open() { return {files_.open(kWords), objects_}; }

  MemoryFiles files_;
  std::uint32_t objects_ = 0;
};

std::vector<std::uint32_t> brute_force(const Names& names, std::string_view text) {
  const auto asked = letters().asked_words(text);
  std::vector<std::uint32_t> found;
  std::uint32_t object = 0;
  for (const std::string& name : names) {
    if (!asked.empty() && storage::fits(words(name), asked))
      found.push_back(object);
    ++object;
  }
  return found;
}

TEST_F(ObjectWordsTest, FindNamesWithAllWordsInAnyOrder) {
  Names names{"", "St. Mary's Church", "church of st mark", "Churchyard", "Mar", "東京都庁舎"};
  write(names);
  const ObjectWords table = open();
  for (const char* text : {"church", "church mar", "mar church", "ch", "st", "mar", "東京",
                           "京都庁", "庁", "churchy mar", "x", "", " - "})
    EXPECT_EQ(table.find(text), brute_force(names, text)) << text;
  EXPECT_EQ(table.find("church mar").size(), 2U);
}

TEST_F(ObjectWordsTest, WordsOfVeryManyObjectsHaveSeveralRows) {
  Names names;
  std::mt19937 random(7);
  for (std::uint32_t i = 0; i < 20000; ++i)
    names.insert(fmt::format("building {}/{}{} {}", random(), random() % 2 ? "north" : "south",
                             random() % 9 ? " house" : "", i % 100));
  write(names);
  const ObjectWords table = open();
  for (const char* text :
       {"building", "north house", "b", "house 7", "south 99", "n s", "77 south"})
    EXPECT_EQ(table.find(text), brute_force(names, text)) << text;
  const auto before = files_.bytes(kWords);
  write(names, 1);
  EXPECT_EQ(files_.bytes(kWords), before) << "whatever the memory";
}

TEST_F(ObjectWordsTest, AWrongRowIsOneError) {
  write({"a", "b"});
  const std::vector<std::uint32_t> all{0, 1};
  const auto expect_error = [&](const std::vector<ObjectRow>& rows, const char* what) {
    write_words(rows);
    const ObjectWords table = open();
    try {
      table.for_each([](std::string_view, const auto&) {});
      ADD_FAILURE() << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
      EXPECT_THAT(error.what(), StartsWith(kWords));
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  const auto row = [](const std::string& name, ObjectValue text) {
    return ObjectRow{name, {std::move(text)}, {}, 0, 0};
  };
  expect_error({row("word", {})}, "no word or no first object");
  expect_error({row("word 00000x", {})}, "no word or no first object");
  expect_error({row(" 000000", {})}, "no word or no first object");
  expect_error({row("word 000002", {})}, "an object that there is not");
  expect_error({row("word 000000", std::string(1, '\x01'))}, "an object that there is not");
  expect_error({row("word 000000", std::string("\x41"))}, "a number that does not end");
  expect_error({row("word 000000", std::string(5000, '\0'))}, "too many objects");
  expect_error({storage::word_row("word", all), row("word 000001", {})}, "do not ascend");
}

TEST_F(ObjectWordsTest, ATableOfOtherThingsIsNone) {
  write({"a"});
  EXPECT_THROW(ObjectWords(files_.open(kNames), 1), Error);
  const auto file = files_.create(kWords);
  ObjectTableWriter writer(*file, storage::word_properties());
  writer.add({"a 000000", {ObjectValue()}, {}, 0, 0});
  writer.finish();
  EXPECT_THROW(open(), Error);
}

}  // namespace
}  // namespace meshhier::tests
