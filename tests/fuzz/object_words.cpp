// A table of words.
//
// First a byte: the input is a file of words, rows of one (a line each: name, tab, text), a table
// of letters, or names, a line each, the first of which is looked for.
#include "storage/format/object_words.h"

#include "base/utf8.h"
#include "execution/cancel.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "import/word_rows.h"
#include "storage/io/spool.h"
#include "support/memory_files.h"

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

constexpr const char* kWordFile = "/models/object_words.bin";
constexpr const char* kNameFile = "/models/objects.bin";
constexpr std::uint32_t kFuzzedObjects = 1000;

std::vector<std::string> sound_lines(Take& take) {
  std::vector<std::string> lines;
  std::string line;
  for (const char c : text_of(take.rest())) {
    if (c != '\n') {
      line += c;
    } else {
      if (is_utf8(line))
        lines.push_back(line);
      line.clear();
    }
  }
  return lines;
}

void search(MemoryFiles& files) {
  refusal({ErrorCode::corrupt}, kWordFile, [&] {
    const storage::ObjectWords words(files.open(kWordFile), kFuzzedObjects);
    for (const std::uint32_t object : words.find("church mar"))
      require(object < kFuzzedObjects, "what is found is an object");
    words.for_each([](std::string_view word, const std::vector<std::uint32_t>& objects) {
      require(!word.empty() && !objects.empty(), "a word has objects");
      require(storage::word_row(word, objects).name.starts_with(word), "its row is named by it");
    });
  });
}

void write_words(MemoryFiles& files, const std::map<std::string, std::string>& rows) {
  const auto file = files.create(kWordFile);
  storage::ObjectTableWriter writer(*file, storage::word_properties());
  writer.add(storage::letters_row());
  for (const auto& [name, text] : rows) {
    if (!name.empty())
      writer.add({name, {ObjectValue(text)}, {}, 0, 0});
  }
  writer.finish();
}

void read_word_file(Take& take) {
  MemoryFiles files;
  files.put(kWordFile, text_of(take.rest()));
  search(files);
}

void read_word_rows(Take& take) {
  std::map<std::string, std::string> rows;
  for (const std::string& line : sound_lines(take)) {
    const std::size_t tab = std::min(line.find('\t'), line.size());
    rows[line.substr(0, tab)] = tab < line.size() ? line.substr(tab + 1) : "";
  }
  MemoryFiles files;
  write_words(files, rows);
  search(files);
}

void read_letters(Take& take) {
  refusal({ErrorCode::corrupt}, "letters: ", [&] {
    const storage::LetterTable letters(text_of(take.rest()), "letters");
    for (const char* name : {"Church of St. Mary", "東京 Straße 서울", "\U0010FFFF"}) {
      for (const std::string& word : letters.words_of(name))
        require(is_utf8(word) && !word.empty(), "a word is a text");
    }
  });
}

void search_names(Take& take) {
  const std::vector<std::string> lines = sound_lines(take);
  const std::set<std::string> names(lines.begin(), lines.end());
  if (names.empty())
    return;
  MemoryFiles files;
  const auto file = files.create(kNameFile);
  storage::ObjectTableWriter writer(*file, {});
  for (const std::string& name : names)
    writer.add({name, {}, {}, 0, 0});
  writer.finish();
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(files, "scratch", pool);
  const execution::CancelToken cancel;
  const storage::LetterTable letters(storage::kLetterTable, "letters");
  std::map<std::string, std::string> rows;
  importing::for_each_word_row(
      storage::ObjectTable(files.open(kNameFile)), letters, {scratch, 1, cancel},
      [&](const ObjectRow& row) { rows[row.name] = std::get<std::string>(row.values[0]); });
  write_words(files, rows);
  const storage::ObjectWords words(files.open(kWordFile), static_cast<std::uint32_t>(names.size()));
  const auto asked = letters.asked_words(lines.front());
  std::vector<std::uint32_t> expected;
  std::uint32_t object = 0;
  for (const std::string& name : names) {
    if (!asked.empty() && storage::fits(letters.words_of(name), asked))
      expected.push_back(object);
    ++object;
  }
  require(words.find(lines.front()) == expected, "the table finds what all names tell");
}

}  // namespace

void object_words(Bytes input) {
  Take take(input);
  switch (take.upto<std::uint8_t>(3)) {
    case 0:
      return read_word_file(take);
    case 1:
      return read_word_rows(take);
    case 2:
      return read_letters(take);
    default:
      return search_names(take);
  }
}

}  // namespace meshhier::tests::fuzz
