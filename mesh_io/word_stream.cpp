#include "mesh_io/word_stream.h"

#include "base/text_mark.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/input_error.h"
#include "mesh_io/text_chars.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kCapacity = std::size_t{1} << 18;
constexpr std::size_t kLookAhead = std::size_t{1} << 16;

std::string not_finite(const char* what, std::string_view word) {
  return fmt::format("expected a finite number for {}, found {}", what, number_in_quotes(word));
}

}  // namespace

WordStream::WordStream(InputStream& stream, std::filesystem::path path, Rules rules)
    : stream_(&stream),
      path_(std::move(path)),
      rules_(rules),
      buffer_(std::make_unique_for_overwrite<char[]>(kCapacity)) {
  skip_byte_order_mark();
}

void WordStream::go_on(InputStream& stream, std::uint64_t line) {
  stream_ = &stream;
  line_ = line;
  begin_ = end_ = 0;
  ended_ = false;
}

void WordStream::skip_byte_order_mark() {
  look_ahead(kByteOrderMark.size());
  if (std::string_view(buffer_.get(), end_).starts_with(kByteOrderMark))
    begin_ = kByteOrderMark.size();
}

/// Makes `bytes` available, or all there is; false if there is nothing.
bool WordStream::look_ahead(std::size_t bytes) {
  if (end_ - begin_ >= bytes || ended_)
    return end_ > begin_;
  std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const std::span<char> room(buffer_.get() + end_, kCapacity - end_);
  const std::size_t count = stream_->read(std::as_writable_bytes(room));
  ended_ = count < room.size();
  end_ += count;
  return end_ > begin_;
}

/// The bytes of a backslash and the line end behind it; 0 if that is not what is there.
std::size_t WordStream::joint_at(std::size_t place) {
  if (!rules_.joins_lines || place + 1 >= end_ || buffer_[place] != '\\' ||
      !is_line_end(buffer_[place + 1]))
    return 0;
  const bool two = buffer_[place + 1] == '\r' && place + 2 < end_ && buffer_[place + 2] == '\n';
  return two ? 3 : 2;
}

bool WordStream::skip_joint() {
  if (buffer_[begin_] != '\\')
    return false;
  look_ahead(3);
  const std::size_t bytes = joint_at(begin_);
  begin_ += bytes;
  line_ += bytes > 0 ? 1 : 0;
  return bytes > 0;
}

bool WordStream::to_word() {
  return is_one_line_ ? to_row() : to_word_of_line();
}

/// Returns the place behind the rest of a line, and behind blank lines and comments that follow.
std::size_t WordStream::row_behind(std::size_t at) const {
  for (bool in_comment = false, in_row = true; at != end_; ++at) {
    const char c = buffer_[at];
    in_comment = !is_line_end(c) && (in_comment || c == '#');
    in_row = in_row && !is_line_end(c);
    if (!in_row && !in_comment && !is_blank(c) && !is_line_end(c))
      break;
  }
  return at;
}

std::size_t WordStream::words_ahead(std::size_t most, std::size_t rows) {
  look_ahead(kLookAhead);
  std::size_t begin = begin_;
  for (; rows > 0; --rows)
    begin = row_behind(begin);
  std::size_t words = 0;
  bool in_word = false;
  for (std::size_t at = begin; at != end_ && !is_line_end(buffer_[at]); ++at) {
    if (buffer_[at] == '#' && (!in_word || rules_.cuts_words))
      break;
    const bool begins = !is_blank(buffer_[at]) && !in_word;
    in_word = !is_blank(buffer_[at]);
    words += begins ? 1 : 0;
    if (words == most)
      break;
  }
  return words;
}

bool WordStream::to_word_of_line() {
  while (look_ahead(1)) {
    const char c = buffer_[begin_];
    if (is_blank(c)) {
      ++begin_;
    } else if (c == '#' && !begins_kept_comment()) {
      skip_comment();
      return false;
    } else if (!skip_joint()) {
      return !is_line_end(c);
    }
  }
  return false;
}

bool WordStream::begins_kept_comment() {
  const std::string_view kept = rules_.kept_comment;
  return !kept.empty() && look_ahead(kept.size()) &&
         std::string_view(buffer_.get() + begin_, end_ - begin_).starts_with(kept);
}

bool WordStream::to_row() {
  while (!to_word_of_line()) {
    if (!look_ahead(2))
      return false;
    const bool joined = buffer_[begin_] == '\r' && begin_ + 1 < end_ && buffer_[begin_ + 1] == '\n';
    begin_ += joined ? 2 : 1;
    ++line_;
  }
  return true;
}

std::string_view WordStream::take_word() {
  look_ahead(kMaxWordBytes + 3);
  std::size_t at = begin_;
  while (at != end_ && !is_line_end(buffer_[at]) && !is_blank(buffer_[at]) && joint_at(at) == 0 &&
         !(rules_.cuts_words && buffer_[at] == '#'))
    ++at;
  const std::string_view word(buffer_.get() + begin_, at - begin_);
  if (word.size() > kMaxWordBytes)
    fail(fmt::format("found a word of more than {} bytes", kMaxWordBytes));
  begin_ = at;
  return word;
}

void WordStream::skip_comment() {
  while (look_ahead(1)) {
    while (begin_ != end_ && !is_line_end(buffer_[begin_]))
      ++begin_;
    if (begin_ != end_)
      return;
  }
}

void WordStream::skip_line() {
  bool in_word = true;  // its first character was taken
  while (look_ahead(3) && !is_line_end(buffer_[begin_])) {
    if (skip_joint()) {
      in_word = false;
      continue;
    }
    const char c = buffer_[begin_];
    if (c == '#' && !in_word)
      return skip_comment();
    in_word = !is_blank(c);
    ++begin_;
  }
}

std::string WordStream::take_rest(std::size_t most_bytes) {
  std::string rest;
  std::size_t blanks = 0;   // blanks that count if something follows them
  bool in_comment = false;  // perhaps: a name may have a '#' as well
  while (look_ahead(3) && !is_line_end(buffer_[begin_])) {
    if (!in_comment && skip_joint()) {
      ++blanks;
      continue;
    }
    const char c = buffer_[begin_++];
    in_comment = in_comment || (c == '#' && (blanks > 0 || rest.empty()));
    if (is_blank(c)) {
      ++blanks;
      continue;
    }
    if (!rest.empty())
      rest.append(std::min(blanks, kMaxWordBytes), ' ');
    blanks = 0;
    rest += c;
    if (rest.size() > most_bytes)
      fail(fmt::format("found a line of more than {} bytes behind its first word", most_bytes));
  }
  return rest;
}

std::string_view WordStream::take_word_for(const char* what) {
  if (!to_word())
    fail(fmt::format("expected a number for {}, found the end of the line", what));
  return take_word();
}

DecimalNumber WordStream::take_number(const char* what) {
  const std::string_view word = take_word_for(what);
  const auto number = parse_decimal(word);
  if (!number || !std::isfinite(number->value))
    fail(not_finite(what, word));
  return *number;
}

float WordStream::take_any_float(const char* what) {
  const std::string_view word = take_word_for(what);
  const auto number = parse_real<float>(word);
  if (!number)
    fail(fmt::format("expected a number for {}, found {}", what, number_in_quotes(word)));
  return *number;
}

float WordStream::take_float(const char* what) {
  const auto value = static_cast<float>(take_number(what).value);
  if (!std::isfinite(value))
    fail(fmt::format("expected a number within single precision for {}", what));
  return value;
}

Vec3d WordStream::take_position(bool& fits_float, UnplacedVertices* unplaced) {
  constexpr const char* kWhat = "a coordinate";
  std::array<double, 3> position{};
  bool is_placed = true;
  for (double& coordinate : position) {
    const std::string_view word = take_word_for(kWhat);
    const auto number = parse_decimal(word);
    const bool is_finite = number && std::isfinite(number->value);
    if (!number || (!is_finite && unplaced == nullptr))
      fail(not_finite(kWhat, word));
    if (is_finite && !is_coordinate(number->value))
      fail(fmt::format("expected {}, found {}", kCoordinateRange, number->value));
    if (!is_finite && std::exchange(is_placed, false) && unplaced->count++ == 0)
      unplaced->first = line_message(path_, line_, not_finite(kWhat, word));
    coordinate = number->value;
    fits_float = fits_float && (number->fits_float || !is_finite);
  }
  return {position[0], position[1], position[2]};
}

void WordStream::expect_line_end() {
  if (to_word())
    fail("expected the end of the line, found " + in_quotes(take_word()));
}

void WordStream::fail(const std::string& message) const {
  fail_at_line(path_, line_, message);
}

}  // namespace meshhier::mesh_io
