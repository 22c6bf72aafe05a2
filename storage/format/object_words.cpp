#include "storage/format/object_words.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "hierarchy/object_set.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// A number's digits, six bits each, the lowest first; each but the last has this bit besides. So
/// they are ASCII.
constexpr std::uint32_t kMoreDigits = 0x40;
constexpr int kDigitBits = 6;
/// A row's name ends with so many digits: the row's first object.
constexpr std::size_t kFirstDigits = 6;
/// Bytes of a word in a message.
constexpr std::size_t kMostShownWord = 60;

void append_number(std::uint32_t number, std::string& text) {
  for (; number >= kMoreDigits; number >>= kDigitBits)
    text.push_back(static_cast<char>(number % kMoreDigits + kMoreDigits));
  text.push_back(static_cast<char>(number));
}

/// Takes a number from the front of `text`; false if there is none below 2^24.
bool take_number(std::string_view& text, std::uint32_t& number) {
  number = 0;
  for (int shift = 0; !text.empty() && shift < 24; shift += kDigitBits) {
    const auto digit = static_cast<unsigned char>(text.front());
    text.remove_prefix(1);
    number |= std::uint32_t{digit % kMoreDigits} << shift;
    if (digit < kMoreDigits)
      return shift == 0 || digit > 0;
    if (digit >= 2 * kMoreDigits)
      return false;
  }
  return false;
}

std::string_view text_in(const ObjectRow& row) {
  const auto* text = std::get_if<std::string>(&row.values.front());
  return text == nullptr ? std::string_view() : *text;
}

std::string_view word_in(const ObjectRow& row) {
  const std::size_t bytes = row.name.size();
  return std::string_view(row.name).substr(0, bytes - std::min(bytes, kFirstDigits + 1));
}

/// Returns the table of letters of a table of words.
LetterTable letters_in(const ObjectTable& table, const std::string& name) {
  if (table.properties() != word_properties() || table.size() == 0)
    throw Error(ErrorCode::corrupt, name + ": it is no table of words");
  const ObjectRow row = table.row(0);
  if (!row.name.empty() || text_in(row).empty())
    throw Error(ErrorCode::corrupt, name + ": lacks the table of letters");
  return {text_in(row), name};
}

}  // namespace

std::vector<ObjectProperty> word_properties() {
  return {{"objects", ObjectPropertyType::text}};
}

ObjectRow letters_row() {
  return {"", {std::string(kLetterTable)}, {}, 0, 0};
}

ObjectRow word_row(std::string_view word, std::span<const std::uint32_t> objects) {
  assert(!objects.empty() && objects.size() <= kMostWordObjects);
  std::string text;
  for (std::size_t i = 1; i < objects.size(); ++i)
    append_number(objects[i] - objects[i - 1] - 1, text);
  return {fmt::format("{} {:06x}", word, objects.front()), {std::move(text)}, {}, 0, 0};
}

ObjectWords::ObjectWords(std::unique_ptr<const File> file, std::uint32_t objects,
                         const ObjectTableFacts* expected)
    : name_(file->path().string()),
      table_(std::move(file), expected),
      objects_(objects),
      letters_(letters_in(table_, name_)) {}

std::vector<std::uint32_t> ObjectWords::objects_of(const ObjectRow& row) const {
  const auto fail = [&](const char* what) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: the row of word \"{}\" {}", name_,
                                                plain_text(word_in(row), kMostShownWord), what));
  };
  const std::string_view word = word_in(row);
  std::uint32_t object = 0;
  const char* const end = row.name.data() + row.name.size();
  if (word.empty() || row.name[word.size()] != ' ' ||
      std::from_chars(end - kFirstDigits, end, object, 16).ptr != end)
    fail("has no word or no first object");
  std::vector<std::uint32_t> objects{object};
  for (std::string_view text = text_in(row); !text.empty();) {
    std::uint32_t distance = 0;
    if (!take_number(text, distance))
      fail("has a number that does not end");
    objects.push_back(objects.back() + distance + 1);
    if (objects.size() > kMostWordObjects || objects.back() >= kMostObjects)
      fail("has too many objects");
  }
  if (objects.back() >= objects_)
    fail("has an object that there is not");
  return objects;
}

std::vector<std::uint32_t> ObjectWords::objects_with(const AskedWord& asked) const {
  const auto [begin, end] =
      table_.range_of_prefix(asked.is_beginning ? asked.word : asked.word + ' ');
  ObjectSet all(objects_);  // rows of very many words may have them all
  for (std::uint32_t row = begin; row < end; ++row)
    std::ranges::for_each(objects_of(table_.row(row)), [&](std::uint32_t o) { all.add(o); });
  std::vector<std::uint32_t> objects;
  all.for_each([&](std::uint32_t object) { objects.push_back(object); });
  return objects;
}

std::vector<std::uint32_t> ObjectWords::find(std::string_view text) const {
  const std::vector<AskedWord> asked = letters_.asked_words(text);
  std::vector<std::uint32_t> found, both;
  for (const AskedWord& word : asked) {
    const std::vector<std::uint32_t> objects = objects_with(word);
    if (&word == &asked.front()) {
      found = objects;
      continue;
    }
    both.clear();
    std::ranges::set_intersection(found, objects, std::back_inserter(both));
    found.swap(both);
  }
  return found;
}

void ObjectWords::for_each(
    const std::function<void(std::string_view, const std::vector<std::uint32_t>&)>& visit) const {
  std::string before;
  std::uint32_t last = 0;
  table_.for_each([&](std::uint32_t number, const ObjectRow& row) {
    if (number == 0)
      return;
    const std::vector<std::uint32_t> objects = objects_of(row);
    const std::string_view word = word_in(row);
    if (word == before && objects.front() <= last)
      throw Error(ErrorCode::corrupt, fmt::format("{}: the objects of word \"{}\" do not ascend",
                                                  name_, plain_text(word, kMostShownWord)));
    before = word;
    last = objects.back();
    visit(word, objects);
  });
}

}  // namespace meshhier::storage
