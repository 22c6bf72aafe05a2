// A stream of text as lines of words, with line numbers.
#pragma once

#include "base/vec.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/number_text.h"
#include "mesh_io/unplaced.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// Lines end with LF, CRLF or CR; words are separated by blanks and tabs; '#' where a word could
/// begin begins a comment, up to the end of the line, even if a backslash stands there. A byte
/// order mark of UTF-8 at the start is passed over. Memory: one buffer, however long a line is. All
/// throw Error(input) naming the line, and as the stream does. For one thread.
class WordStream {
 public:
  /// Rules that differ from format to format.
  struct Rules {
    bool joins_lines = false;  ///< a backslash before a line's end joins it with the next one
    bool cuts_words = false;   ///< '#' begins a comment within a word as well
    std::string_view kept_comment = {};  ///< a line that begins so is words like any other
  };

  /// The longest word, as TextCursor's.
  static constexpr std::size_t kMaxWordBytes = 4096;

  WordStream(InputStream& stream, std::filesystem::path path, Rules rules);

  /// Goes on with another stream, whose first line has that number.
  void go_on(InputStream& stream, std::uint64_t line);

  std::uint64_t line() const { return line_; }
  /// Returns the bytes that were read from the stream and not taken.
  std::size_t bytes_ahead() const { return end_ - begin_; }
  /// Goes on to the next word, over line ends; false at the end.
  bool to_row();
  /// Goes on to the next word of this line; false if there is none.
  bool to_word();
  /// From now on lines go on in the next one: to_word() is to_row().
  void join_all_lines() { is_one_line_ = true; }
  /// Counts the words from here to the end of the line, up to `most` <= 64 and within 64 KiB; takes
  /// none. `rows`: counts in the line with words so many behind this one.
  std::size_t words_ahead(std::size_t most, std::size_t rows = 0);
  /// Takes the word here, valid until the next call. Requires that to_row() or to_word() was true
  /// just before. A word that is too long is an error.
  std::string_view take_word();
  /// Goes to the end of this line, over lines that are joined with it.
  void skip_line();
  /// Takes the rest of this line but for blanks around it, comments too; lines that are joined have
  /// a blank between them. One of more than `most_bytes` is an error.
  std::string take_rest(std::size_t most_bytes = kMaxWordBytes);

  /// Takes the next word of this line as a finite number; `what` names it in messages.
  DecimalNumber take_number(const char* what);
  float take_float(const char* what);
  /// Takes a number that may be infinite or "nan".
  float take_any_float(const char* what);
  /// Takes three coordinates; clears `fits_float` if one of them is no float. If one is not finite
  /// the vertex is counted in `unplaced`; without that it is an error.
  Vec3d take_position(bool& fits_float, UnplacedVertices* unplaced = nullptr);
  void expect_line_end();

  /// Throws Error(input) naming file and line.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_byte_order_mark();
  bool look_ahead(std::size_t bytes);
  std::size_t row_behind(std::size_t at) const;
  bool to_word_of_line();
  bool begins_kept_comment();
  std::string_view take_word_for(const char* what);
  std::size_t joint_at(std::size_t place);
  bool skip_joint();
  void skip_comment();

  InputStream* stream_;
  std::filesystem::path path_;
  Rules rules_;
  bool ended_ = false;
  bool is_one_line_ = false;
  std::unique_ptr<char[]> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t line_ = 1;
};

}  // namespace meshhier::mesh_io
