// Words of names, in letters that are folded: what an index of words has, and what one types.
//
// Problem: who looks for "Kirche an der Straße 7" types "strasse kirche", and "東京都庁舎" has no
// spaces. Every program must take the same words from a name, whatever Unicode it knows.
//
// Idea: a table tells what each letter becomes: another one, several, none, or a space. It stands
// in the file that has the words (object_words.h), so readers need no other. Letters between spaces
// are a word; those of scripts without spaces are words by pairs:
//
//   name       "Église St-Pierre"            "東京タワー 2"
//   folded     "eglise st pierre"            "東京タワー 2"
//   words      eglise, st, pierre            東京, 京タ, タワ, ワー, ー, 2
//
// Cost: a search in 1,400 ranges for each letter that is not ASCII.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Words are cut behind so many code points.
inline constexpr std::size_t kMostWordLetters = 32;

/// The table that hierarchies get, as a text: a row of hexadecimal numbers for each range of code
/// points, as docs/file_format.md says.
extern const std::string_view kLetterTable;

/// A word that someone looks for.
struct AskedWord {
  std::string word;
  bool is_beginning = false;  ///< words that go on fit, too
  friend bool operator==(const AskedWord&, const AskedWord&) = default;
};

/// Thread-safe.
class LetterTable {
 public:
  /// Parses a table that nobody vouches for. Throws Error(corrupt) that starts with `name`.
  LetterTable(std::string_view text, const std::string& name);

  /// Returns the words of a name, some perhaps twice. Requires UTF-8, as all functions here.
  std::vector<std::string> words_of(std::string_view name) const;
  /// Returns the words that a name must have to be found by `text`; the last one may be the
  /// beginning of a word. None: nothing is looked for.
  std::vector<AskedWord> asked_words(std::string_view text) const;

 private:
  /// Letters that stand together, all of scripts with spaces, or all of others.
  struct Run {
    bool is_unspaced = false;
    std::u32string letters;
  };
  /// A row of the folding table: it folds every `step`-th code point from `first` to
  /// `last`.
  struct Range {
    char32_t first = 0, last = 0, step = 1;
    bool is_running = false;  ///< the next one becomes the letter `step` behind
    std::u32string to;
  };

  void add_row(const std::vector<std::uint32_t>& numbers, const std::string& name);
  void append_folded(char32_t letter, std::u32string& to) const;
  bool is_unspaced(char32_t letter) const;
  std::vector<Run> runs_of(std::string_view text) const;

  std::vector<Range> ranges_;          ///< ascending
  std::vector<Range> unspaced_;        ///< ascending: scripts without spaces
  std::array<char32_t, 128> ascii_{};  ///< what these become, where it is one letter; else 0
};

/// Returns whether a name with these words is found.
bool fits(const std::vector<std::string>& words, const std::vector<AskedWord>& asked);

}  // namespace meshhier::storage
