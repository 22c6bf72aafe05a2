// A text file as rows of words, with line numbers.
#pragma once

#include "mesh_io/byte_window.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace meshhier::mesh_io {

/// Reads forwards. Lines end with LF, CRLF or CR; words are separated by blanks and tabs; blank
/// lines do not count as rows. Memory: one ByteWindow, however long a line is. All throw Error(io).
/// For one thread.
class TextCursor {
 public:
  /// The longest word: a double written out in full has 1,077 characters.
  static constexpr std::size_t kMaxWordBytes = 4096;

  TextCursor(const InputFile& input, std::uint64_t offset, std::uint64_t line)
      : window_(input), line_(line) {
    window_.seek(offset);
  }

  std::uint64_t offset() const { return window_.offset(); }
  std::uint64_t line() const { return line_; }
  std::uint64_t remaining() const { return window_.remaining(); }
  const storage::File& file() const { return window_.file(); }

  /// Goes on to the next word, over line ends; false at the end of the file.
  bool to_row();

  /// Goes on to the end of this line.
  void skip_line();

  /// Goes on to the next word of this line; false if there is none.
  bool to_word() {
    while (look_ahead()) {
      const std::byte* at = window_.begin();
      while (at != window_.end() && kind_of(*at) == Kind::blank)
        ++at;
      const bool found = at != window_.end();
      const bool ended = found && kind_of(*at) == Kind::line_end;
      window_.advance(static_cast<std::size_t>(at - window_.begin()));
      if (found)
        return !ended;
    }
    return false;
  }

  /// Takes the word here; empty if it is longer than kMaxWordBytes. Valid until the next call.
  /// Requires that to_row() or to_word() was true just before.
  std::string_view take_word() {
    look_ahead();
    const std::byte* const first = window_.begin();
    const std::byte* at = first;
    while (at != window_.end() && kind_of(*at) == Kind::word)
      ++at;
    const auto size = static_cast<std::size_t>(at - first);
    if (size > kMaxWordBytes)
      return {};
    window_.advance(size);
    return {reinterpret_cast<const char*>(first), size};
  }

 private:
  enum class Kind : std::uint8_t { word, blank, line_end };

  static constexpr std::array<Kind, 256> make_kinds() {
    std::array<Kind, 256> kinds{};
    for (const unsigned char c : {' ', '\t', '\v', '\f'})
      kinds[c] = Kind::blank;
    for (const unsigned char c : {'\n', '\r'})
      kinds[c] = Kind::line_end;
    return kinds;
  }
  static Kind kind_of(std::byte c) {
    static constexpr std::array<Kind, 256> kKinds = make_kinds();
    return kKinds[static_cast<std::size_t>(c)];
  }

  /// Makes a word and its separator available, if the file has as much.
  bool look_ahead() {
    return window_.available() > kMaxWordBytes || window_.ensure(kMaxWordBytes + 1) ||
           window_.available() > 0;
  }

  ByteWindow window_;
  std::uint64_t line_;
};

}  // namespace meshhier::mesh_io
