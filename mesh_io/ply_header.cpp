#include "mesh_io/ply_header.h"

#include "base/named_value.h"
#include "base/small_letters.h"
#include "base/text_mark.h"
#include "base/trimmed.h"
#include "mesh_io/input_error.h"
#include "mesh_io/ply_names.h"
#include "mesh_io/text_chars.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::string_view kHeaderBlanks = " \t\r\n\v\f";

/// Takes the first word off `text`; empty if there is none.
std::string_view take_word(std::string_view& text) {
  text = trimmed(text, kHeaderBlanks);
  const std::string_view word = text.substr(0, text.find_first_of(kHeaderBlanks));
  text = trimmed(text.substr(word.size()), kHeaderBlanks);
  return word;
}

/// Perhaps misspelt.
bool looks_like_statement(std::string_view keyword) {
  return keyword.starts_with("elem") || keyword.starts_with("prop") || keyword.starts_with("end");
}

class HeaderParser {
 public:
  HeaderParser(std::string_view start, const std::filesystem::path& path)
      : start_(start), path_(path) {}

  PlyHeader parse() {
    check_magic();
    for (bool has_ended = false; !has_ended;) {
      is_odd_ = false;
      has_ended = parse_line(next_line());
      header_.odd_lines += is_odd_ ? 1 : 0;
    }
    if (!has_format_)
      fail("expected a 'format' line before 'end_header', found none");
    header_.data_offset = position_;
    header_.data_line = line_ + 1;
    header_.odd_lines += settle_ply_names(header_.elements);
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_at_line(path_, line_, message); }

  void check_magic();
  void skip_to_magic();
  std::string_view next_line();
  bool parse_line(std::string_view line);
  void parse_comment(std::string_view rest);
  void parse_format(std::string_view rest);
  void parse_element(std::string_view rest);
  void parse_property(std::string_view rest);
  PlyType parse_type(std::string_view word);
  std::string keyword_of(std::string_view word);

  std::string_view start_;
  const std::filesystem::path& path_;
  char line_end_ = '\n';
  std::size_t position_ = 0;
  std::uint64_t line_ = 0;
  bool has_format_ = false;
  bool in_capitals_ = false;  ///< begins with "PLY"
  bool is_odd_ = false;       ///< the line is
  std::set<std::string, std::less<>> names_;
  PlyHeader header_;
};

/// Checks the first word, and finds out how lines end: a CR alone ends them only if it ends the
/// first one, so the data behind "end_header" CR LF starts after the LF, and behind a lone CR right
/// away, even with a LF.
void HeaderParser::check_magic() {
  if (start_.empty())
    fail_file(path_, "expected a PLY file, found an empty file");
  skip_to_magic();
  const std::size_t end = start_.find_first_of("\r\n", position_);
  const std::string_view first = start_.substr(position_, end - position_);
  if (small_letters(trimmed(first, kHeaderBlanks)) != "ply") {
    const bool gzip = start_.starts_with("\x1f\x8b");
    fail_file(path_, fmt::format("expected a PLY file, which starts with the line 'ply', found {}",
                                 gzip ? "gzip data (unpack it first)" : in_quotes(first)));
  }
  const bool has_end = end != std::string_view::npos;
  const bool carriage_return_only =
      has_end && start_[end] == '\r' && (end + 1 == start_.size() || start_[end + 1] != '\n');
  line_end_ = carriage_return_only ? '\r' : '\n';
  in_capitals_ = trimmed(first, kHeaderBlanks) != "ply";
  header_.odd_lines += position_ > 0 || in_capitals_ ? 1 : 0;
  next_line();
}

/// Skips a byte order mark, blanks and blank lines.
void HeaderParser::skip_to_magic() {
  const std::size_t begin = start_.size() - without_mark(start_).size();
  position_ = std::min(start_.find_first_not_of(kHeaderBlanks, begin), start_.size());
  for (std::size_t at = begin; at < position_; ++at) {
    const bool is_half = start_[at] == '\r' && start_[at + 1] == '\n';
    line_ += is_line_end(start_[at]) && !is_half ? 1 : 0;
  }
}

std::string_view HeaderParser::next_line() {
  ++line_;
  if (position_ == start_.size()) {
    const bool too_long = start_.size() >= kMaxHeaderBytes;
    fail(too_long ? fmt::format("expected 'end_header' within {} bytes, found none", start_.size())
                  : "expected a header line, found the end of the file (is it truncated?)");
  }
  const std::size_t end = std::min(start_.find(line_end_, position_), start_.size());
  const std::string_view line = start_.substr(position_, end - position_);
  if (line.size() > kMaxHeaderLineBytes) {
    fail(fmt::format("expected header lines of at most {} bytes, found a longer one",
                     kMaxHeaderLineBytes));
  }
  position_ = std::min(end + 1, start_.size());
  return line;
}

/// The word, in small letters if the header is in capitals.
std::string HeaderParser::keyword_of(std::string_view word) {
  std::string small = in_capitals_ ? small_letters(word) : std::string(word);
  is_odd_ = is_odd_ || small != word;
  return small;
}

/// Returns true for the last line of the header.
bool HeaderParser::parse_line(std::string_view line) {
  std::string_view rest = line;
  const std::string keyword = keyword_of(take_word(rest));
  if (keyword.empty() || keyword == "obj_info")
    return false;
  if (keyword == "comment") {
    parse_comment(rest);
    return false;
  }
  if (keyword == "format") {
    parse_format(rest);
  } else if (keyword == "element") {
    parse_element(rest);
  } else if (keyword == "property") {
    parse_property(rest);
  } else if (keyword == "end_header") {
    if (!rest.empty())
      fail("expected a line end after 'end_header', found " + in_quotes(rest));
    return true;
  } else if (has_format_ && header_.elements.empty() && !looks_like_statement(keyword)) {
    is_odd_ = false;
    return false;  // a remark without its keyword, as old versions of Blender write it
  } else {
    fail(
        "expected 'format', 'comment', 'obj_info', 'element', 'property' or 'end_header', "
        "found " +
        in_quotes(keyword));
  }
  return false;
}

void HeaderParser::parse_comment(std::string_view rest) {
  const bool names_texture = small_letters(take_word(rest)) == "texturefile";
  if (names_texture && !rest.empty())
    header_.texture_files.emplace_back(rest);
}

void HeaderParser::parse_format(std::string_view rest) {
  if (has_format_)
    fail("expected one 'format' line, found a second one");
  has_format_ = true;
  const std::string format = keyword_of(take_word(rest));
  if (format == "ascii") {
    header_.encoding = PlyEncoding::ascii;
  } else if (format == "binary_little_endian") {
    header_.encoding = PlyEncoding::little_endian;
  } else if (format == "binary_big_endian") {
    header_.encoding = PlyEncoding::big_endian;
  } else {
    fail("expected the format 'ascii', 'binary_little_endian' or 'binary_big_endian', found " +
         in_quotes(format));
  }
  const bool is_first = rest.empty() || rest == "1" || rest.starts_with("1.");
  if (!is_first || rest.find_first_not_of("0123456789.") != std::string_view::npos)
    fail("expected format version '1.0', found " + in_quotes(rest));
  is_odd_ = is_odd_ || rest != "1.0";
}

void HeaderParser::parse_element(std::string_view rest) {
  PlyElement element;
  element.name = take_word(rest);
  if (element.name.empty())
    fail("expected 'element NAME COUNT', found no name");
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), element.count);
  if (error != std::errc{} || end != rest.data() + rest.size()) {
    fail(fmt::format("expected the number of {} rows, an integer below 2^64, found {}",
                     in_quotes(element.name), in_quotes(rest)));
  }
  if (!names_.insert(element.name).second) {
    fail("expected each element once, found a second " + in_quotes(element.name));
  }
  header_.elements.push_back(std::move(element));
}

void HeaderParser::parse_property(std::string_view rest) {
  if (header_.elements.empty())
    fail("expected an 'element' before the first 'property'");
  PlyProperty property;
  std::string_view type = take_word(rest);
  if (small_letters(type) == "list") {
    is_odd_ = is_odd_ || type != "list";
    property.count_type = parse_type(take_word(rest));
    if (!is_integer(*property.count_type)) {
      fail(fmt::format("expected an integer type for a list's length, found '{}'",
                       name_of(*property.count_type)));
    }
    type = take_word(rest);
  }
  property.type = parse_type(type);
  property.name = rest;
  if (property.name.empty())
    fail("expected a property's name after its type, found none");
  header_.elements.back().properties.push_back(std::move(property));
}

PlyType HeaderParser::parse_type(std::string_view word) {
  const std::string name = small_letters(word);
  const auto known = std::ranges::find_if(
      kPlyTypes, [&](const PlyTypeRow& row) { return row.name == name || row.sized_name == name; });
  if (known != kPlyTypes.end()) {
    is_odd_ = is_odd_ || name != word || has_64_bits(known->value);
    return known->value;
  }
  fail(
      "expected a type (char, uchar, short, ushort, int, uint, float, double or int8 to "
      "float64), found " +
      in_quotes(word));
}

}  // namespace

std::string_view name_of(PlyType type) {
  return row_of(type).name;
}

std::string_view name_of(PlyEncoding encoding) {
  constexpr std::array kEncodings{NamedValue{"ASCII", PlyEncoding::ascii},
                                  NamedValue{"binary little endian", PlyEncoding::little_endian},
                                  NamedValue{"binary big endian", PlyEncoding::big_endian}};
  return name_in(kEncodings, encoding);
}

PlyHeader parse_ply_header(std::string_view start, const std::filesystem::path& path) {
  return HeaderParser(start, path).parse();
}

}  // namespace meshhier::mesh_io
