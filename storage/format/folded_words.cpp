#include "storage/format/folded_words.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <span>
#include <utility>

namespace meshhier::storage {
namespace {

constexpr char32_t kSpace = U' ';
constexpr char32_t kLastCodePoint = 0x10FFFF;
constexpr std::size_t kMostTargets = 32;
enum RowKind : std::uint32_t { kSame, kRunning, kUnspaced };

[[noreturn]] void fail_table(const std::string& name, const char* what) {
  throw Error(ErrorCode::corrupt, name + ": table of letters: " + what);
}

/// Returns the numbers of one row.
std::vector<std::uint32_t> row_numbers(std::string_view row, const std::string& name) {
  std::vector<std::uint32_t> numbers;
  const char* at = row.data();
  const char* const end = at + row.size();
  while (true) {
    std::uint32_t number = 0;
    const auto [behind, problem] = std::from_chars(at, end, number, 16);
    if (problem != std::errc() || (behind != end && *behind != ' '))
      fail_table(name, "a row is not of hexadecimal numbers");
    numbers.push_back(number);
    if (behind == end)
      return numbers;
    at = behind + 1;
  }
}

bool has_surrogates(char32_t first, char32_t last) {
  return first <= 0xDFFF && last >= 0xD800;
}

void append_utf8(char32_t letter, std::string& text) {
  const auto byte = [&](char32_t bits) { text.push_back(static_cast<char>(bits)); };
  const auto more = [&](int shift) { byte(0x80 | ((letter >> shift) & 0x3F)); };
  if (letter < 0x80)
    return byte(letter);
  if (letter < 0x800) {
    byte(0xC0 | (letter >> 6));
  } else if (letter < 0x10000) {
    byte(0xE0 | (letter >> 12));
    more(6);
  } else {
    byte(0xF0 | (letter >> 18));
    more(12);
    more(6);
  }
  more(0);
}

std::string utf8_of(std::u32string_view letters) {
  std::string text;
  for (const char32_t letter : letters.substr(0, kMostWordLetters))
    append_utf8(letter, text);
  return text;
}

/// Takes the first code point of a text in UTF-8.
char32_t take_letter(std::string_view& text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t bytes = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  char32_t letter = bytes == 1 ? first : first & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i)
    letter = letter << 6 | (static_cast<unsigned char>(text[i]) & 0x3FU);
  text.remove_prefix(bytes);
  return letter;
}

/// Takes a syllable of Hangul apart (The Unicode Standard, section 3.12); false if it is none.
bool append_hangul(char32_t letter, std::u32string& to) {
  constexpr char32_t kFirst = 0xAC00, kCount = 11172, kVowels = 21, kFinals = 28;
  const char32_t syllable = letter - kFirst;
  if (syllable >= kCount)
    return false;
  to.push_back(0x1100 + syllable / (kVowels * kFinals));
  to.push_back(0x1161 + syllable / kFinals % kVowels);
  if (const char32_t final = syllable % kFinals; final > 0)
    to.push_back(0x11A7 + final);
  return true;
}

/// Returns the range that a letter may be in; null if there is none.
template <class Ranges>
auto* range_of(const Ranges& ranges, char32_t letter) {
  const auto behind = std::ranges::upper_bound(ranges, letter, {}, &Ranges::value_type::first);
  return behind == ranges.begin() || std::prev(behind)->last < letter ? nullptr
                                                                      : &*std::prev(behind);
}

}  // namespace

LetterTable::LetterTable(std::string_view text, const std::string& name) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos)
      fail_table(name, "its last row does not end");
    add_row(row_numbers(text.substr(0, end), name), name);
    text.remove_prefix(end + 1);
  }
  for (char32_t letter = 0; letter < ascii_.size(); ++letter) {
    std::u32string to;
    append_folded(letter, to);
    ascii_[letter] = to.size() == 1 ? to.front() : 0;
  }
}

void LetterTable::add_row(const std::vector<std::uint32_t>& numbers, const std::string& name) {
  if (numbers.size() < 4 || numbers.size() > 4 + kMostTargets)
    fail_table(name, "a row has too few or too many numbers");
  const std::uint32_t first = numbers[0], count = numbers[1], step = numbers[2], kind = numbers[3];
  if (first > kLastCodePoint || count == 0 || step == 0 || kind > kUnspaced ||
      count - 1 > (kLastCodePoint - first) / step)
    fail_table(name, "a row has no range of code points");
  Range range{first, first + (count - 1) * step, step, kind == kRunning, {}};
  const char32_t width = kind == kRunning ? range.last - range.first : 0;
  for (const std::uint32_t to : std::span(numbers).subspan(4)) {
    if (to > kLastCodePoint - width || has_surrogates(to, to + width))
      fail_table(name, "a row has something that is no code point");
    range.to.push_back(to);
  }
  if (kind == kUnspaced ? !range.to.empty() : kind == kRunning && range.to.size() != 1)
    fail_table(name, "a row has too few or too many numbers");
  std::vector<Range>& ranges = kind == kUnspaced ? unspaced_ : ranges_;
  if (!ranges.empty() && range.first <= ranges.back().last)
    fail_table(name, "its rows do not ascend");
  ranges.push_back(std::move(range));
}

void LetterTable::append_folded(char32_t letter, std::u32string& to) const {
  if (append_hangul(letter, to))
    return;
  const Range* const range = range_of(ranges_, letter);
  if (range == nullptr || (letter - range->first) % range->step != 0)
    to.push_back(letter);
  else if (range->is_running)
    to.push_back(range->to.front() + (letter - range->first));
  else
    to += range->to;
}

bool LetterTable::is_unspaced(char32_t letter) const {
  return range_of(unspaced_, letter) != nullptr;
}

std::vector<LetterTable::Run> LetterTable::runs_of(std::string_view text) const {
  std::vector<Run> runs;
  std::u32string folded;
  bool goes_on = false;
  while (!text.empty()) {
    const char32_t letter = take_letter(text);
    folded.clear();
    if (letter < ascii_.size() && ascii_[letter] != 0)
      folded.push_back(ascii_[letter]);
    else
      append_folded(letter, folded);
    for (const char32_t each : folded) {
      if (each == kSpace) {
        goes_on = false;
        continue;
      }
      const bool unspaced = is_unspaced(each);
      if (!goes_on || runs.back().is_unspaced != unspaced)
        runs.push_back({unspaced, {}});
      runs.back().letters.push_back(each);
      goes_on = true;
    }
  }
  return runs;
}

std::vector<std::string> LetterTable::words_of(std::string_view name) const {
  std::vector<std::string> words;
  for (const auto& [unspaced, letters] : runs_of(name)) {
    if (!unspaced)
      words.push_back(utf8_of(letters));
    for (std::size_t i = 0; unspaced && i < letters.size(); ++i)
      words.push_back(utf8_of(std::u32string_view(letters).substr(i, 2)));
  }
  return words;
}

std::vector<AskedWord> LetterTable::asked_words(std::string_view text) const {
  std::vector<AskedWord> asked;
  const std::vector<Run> runs = runs_of(text);
  for (const Run& run : runs) {
    const std::u32string_view letters = run.letters;
    if (!run.is_unspaced)
      asked.push_back({utf8_of(letters), &run == &runs.back()});
    else if (letters.size() == 1)
      asked.push_back({utf8_of(letters), true});
    for (std::size_t i = 0; run.is_unspaced && i + 1 < letters.size(); ++i)
      asked.push_back({utf8_of(letters.substr(i, 2)), false});
  }
  return asked;
}

bool fits(const std::vector<std::string>& words, const std::vector<AskedWord>& asked) {
  return std::ranges::all_of(asked, [&](const AskedWord& wanted) {
    return std::ranges::any_of(words, [&](const std::string& word) {
      return wanted.is_beginning ? word.starts_with(wanted.word) : word == wanted.word;
    });
  });
}

}  // namespace meshhier::storage
