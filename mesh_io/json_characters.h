// The JSON of a file of any size, character by character, for a parser that keeps nothing.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

namespace meshhier::mesh_io {

/// The JSON of a glTF, GLB or other file: texts are cut to 8 KiB, and it ends at a number or word
/// that is longer than 1 KiB. So no token takes much memory.
class JsonCharacters {
 public:
  explicit JsonCharacters(InputStream& stream);

  /// -1 at the end.
  int next();

 private:
  int next_stored();
  bool load();

  InputStream& stream_;
  std::uint64_t left_ = UINT64_MAX;  ///< of the JSON chunk of a GLB
  std::vector<std::byte> block_;
  std::size_t at_ = 0;
  bool in_text_ = false, escaped_ = false, kept_ = false;
  std::size_t token_ = 0;
};

/// As an iterator, for the parser.
class JsonIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  JsonIterator() = default;
  explicit JsonIterator(JsonCharacters& characters) : characters_(&characters) { ++*this; }
  const char& operator*() const { return c_; }
  JsonIterator& operator++() {
    const int c = characters_->next();
    c_ = static_cast<char>(c);
    if (c < 0)
      characters_ = nullptr;
    return *this;
  }
  JsonIterator operator++(int) {
    const JsonIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const JsonIterator& a, const JsonIterator& b) {
    return a.characters_ == b.characters_;
  }

 private:
  JsonCharacters* characters_ = nullptr;
  char c_ = 0;
};

}  // namespace meshhier::mesh_io
