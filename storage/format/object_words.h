// object_words.bin: which objects have a word in their names (docs/file_format.md, section 9.1).
//
// Problem: of a million names, which have "church" and a word that begins with "mar"? They must not
// all be read.
//
// Idea: a second table, as objects.bin, whose rows are words. A row's name is the word and the
// first of its objects, its one text the distances to the next ones; a word of many objects has
// several rows. So a word, and all words that begin with it, are neighbours:
//
//   ""                the table of letters (folded_words.h)
//   "church 0000a1"   a1, and at most 4,095 more
//   "church 00f3b0"   the next ones
//   "churchyard ..."
//
// Cost: a word is one block of the table, about 5 kB, unless it is of thousands of objects.
#pragma once

#include "storage/format/folded_words.h"
#include "storage/format/object_table.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Hierarchies of fewer objects have no table of words: all names are soon read.
inline constexpr std::uint32_t kLeastIndexedObjects = 257;
/// A row has so many objects at most.
inline constexpr std::size_t kMostWordObjects = 4096;

/// The properties of a table of words.
std::vector<ObjectProperty> word_properties();
/// Returns its first row.
ObjectRow letters_row();
/// Returns the row of a word. `objects`: ascending, 1 to kMostWordObjects.
ObjectRow word_row(std::string_view word, std::span<const std::uint32_t> objects);

/// A table of words that nobody vouches for. Thread-safe. Throws as ObjectTable does.
class ObjectWords {
 public:
  /// `objects`: there are so many. `expected`: what the manifest tells.
  ObjectWords(std::unique_ptr<const File> file, std::uint32_t objects,
              const ObjectTableFacts* expected = nullptr);

  const LetterTable& letters() const { return letters_; }
  const ObjectTable& table() const { return table_; }

  /// Returns the objects that are found by a text, ascending; none if it has no words. Reads the
  /// rows of its words.
  std::vector<std::uint32_t> find(std::string_view text) const;
  /// Calls visit(word, objects) for each row but the first, in order.
  void for_each(const std::function<void(std::string_view word,
                                         const std::vector<std::uint32_t>& objects)>& visit) const;

 private:
  /// Returns the objects of a row, which must be as word_row() makes it.
  std::vector<std::uint32_t> objects_of(const ObjectRow& row) const;
  std::vector<std::uint32_t> objects_with(const AskedWord& asked) const;

  std::string name_;
  ObjectTable table_;
  std::uint32_t objects_;
  LetterTable letters_;
};

}  // namespace meshhier::storage
