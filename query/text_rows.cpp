#include "query/text_rows.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/small_letters.h"
#include "base/trimmed.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::querying {
namespace {

using namespace std::string_view_literals;

/// The longest line: some hundred columns of a table.
constexpr std::size_t kMostLineBytes = std::size_t{1} << 16;
constexpr std::size_t kReadBytes = std::size_t{1} << 20;
constexpr std::size_t kLinesAtOnce = 16384;
constexpr std::size_t kShownBytes = 60;
constexpr std::string_view kBlanks = " \t\v\f";

constexpr std::array kPointNames{"x"sv, "y"sv, "z"sv};
constexpr std::array kRayNames{"x"sv, "y"sv, "z"sv, "dx"sv, "dy"sv, "dz"sv};

std::span<const std::string_view> names_of(RowKind kind) {
  return kind == RowKind::points ? std::span<const std::string_view>(kPointNames) : kRayNames;
}

/// The lines of a stream.
class Lines {
 public:
  Lines(mesh_io::InputStream& stream, const std::string& name) : stream_(stream), name_(name) {}

  /// Returns the next line without its end, valid until the next call; none at the end.
  std::optional<std::string_view> next() {
    ++number_;
    for (;;) {
      const std::size_t end = text_.find_first_of("\n\r", begin_);
      // A carriage return at the end may be half of a line end.
      const bool is_whole =
          end != std::string::npos && (text_[end] == '\n' || end + 1 < text_.size());
      if (std::min(end, text_.size()) - begin_ > kMostLineBytes)
        fail(fmt::format("the line has more than {} bytes", kMostLineBytes));
      if (is_whole || at_end_)
        return take(end);
      read_on();
    }
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::input, fmt::format("{}: line {}: {}", name_, number_, what));
  }

 private:
  /// Reads behind what is not taken yet, which comes to the front.
  void read_on() {
    text_.erase(0, begin_);
    begin_ = 0;
    const std::size_t size = text_.size();
    text_.resize(size + kReadBytes);
    const std::size_t count = stream_.read(std::as_writable_bytes(std::span(text_).subspan(size)));
    text_.resize(size + count);
    at_end_ = count < kReadBytes;
  }
  std::optional<std::string_view> take(std::size_t end) {
    if (begin_ == text_.size())
      return std::nullopt;
    const std::string_view text(text_);
    const std::size_t stop = std::min(end, text.size());
    const std::string_view line = text.substr(begin_, stop - begin_);
    begin_ = std::min(stop + (text.substr(stop, 2) == "\r\n" ? 2 : 1), text.size());
    return line;
  }

  mesh_io::InputStream& stream_;
  const std::string& name_;
  std::string text_;
  std::size_t begin_ = 0;
  bool at_end_ = false;
  std::uint64_t number_ = 0;
};

std::string_view without_quotes(std::string_view field) {
  const bool is_quoted = field.size() >= 2 && field.front() == '"' && field.back() == '"';
  return is_quoted ? trimmed(field.substr(1, field.size() - 2), kBlanks) : field;
}

/// Returns the end of the field that begins at the front: a separator, not within quotes.
std::size_t end_of_field(std::string_view line, char separator) {
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"')
      is_quoted = !is_quoted;
    else if (line[i] == separator && !is_quoted)
      return i;
  }
  return line.size();
}

/// Returns what stands between the fields of a line: semicolons, else commas, else blanks and tabs.
char separator_of(std::string_view line) {
  for (const char separator : {';', ','}) {
    if (end_of_field(line, separator) < line.size())
      return separator;
  }
  return ' ';
}

/// Only where there are other separators than blanks may a field be empty; one behind the last
/// separator is none.
void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  while (!line.empty()) {
    std::size_t end = end_of_field(line, separator);
    if (separator == ' ')
      end = std::min(end, line.find('\t'));
    const std::string_view field = trimmed(line.substr(0, end), kBlanks);
    if (separator != ' ' || !field.empty())
      fields.push_back(without_quotes(field));
    line.remove_prefix(std::min(end, line.size()));
    line.remove_prefix(std::min<std::size_t>(1, line.size()));
  }
}

/// Returns the number that a field is; with a decimal comma, too, where commas separate nothing.
std::optional<double> number_in(std::string_view field, char separator) {
  const std::size_t comma = field.find(',');
  if (separator == ',' || comma == std::string_view::npos ||
      field.find('.') != std::string_view::npos)
    return mesh_io::parse_real<double>(field);
  std::string with_point(field);
  with_point[comma] = '.';
  return mesh_io::parse_real<double>(with_point);
}

std::string shown(std::string_view field) {
  return field.empty() ? "nothing" : plain_text(field, kShownBytes);
}

/// The columns of a table that are meant.
class Columns {
 public:
  explicit Columns(RowKind kind) : names_(names_of(kind)) {}

  /// Takes the names of a first line; returns false if it has numbers.
  bool take_names(const Lines& lines, std::span<const std::string_view> fields, char separator) {
    if (number_in(fields.front(), separator))
      return false;
    const auto at = [&](std::string_view name) {
      const auto is_it = [&](std::string_view field) { return small_letters(field) == name; };
      const auto found = std::ranges::find_if(fields, is_it);
      if (std::ranges::count_if(fields, is_it) > 1)
        lines.fail(fmt::format("two columns are named {}: rename the one that is not meant", name));
      if (found == fields.end())
        lines.fail(fmt::format("expected numbers, or the names of columns, {} among them; found {}",
                               fmt::join(names_, ", "), shown(fields.front())));
      return static_cast<std::size_t>(found - fields.begin());
    };
    for (const std::string_view name : names_)
      places_.push_back(at(name));
    return true;
  }

  void append(const Lines& lines, std::span<const std::string_view> fields, char separator,
              std::vector<double>& numbers) const {
    if (places_.empty() && fields.size() != names_.size()) {
      lines.fail(
          fmt::format("expected {} numbers, found {}; a first line with the names "
                      "{} would tell which are meant",
                      names_.size(), counted(fields.size(), "columns"), fmt::join(names_, ", ")));
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::size_t place = places_.empty() ? i : places_[i];
      const std::string_view field = place < fields.size() ? fields[place] : "";
      const auto number = number_in(field, separator);
      if (!number)
        lines.fail(fmt::format("expected a number for {}, found {}", names_[i], shown(field)));
      numbers.push_back(*number);
    }
  }

 private:
  std::span<const std::string_view> names_;
  std::vector<std::size_t> places_;  ///< of the names; empty: there are no other columns
};

}  // namespace

std::uint64_t read_text_rows(mesh_io::InputStream& stream, const std::string& name, RowKind kind,
                             const RowVisitor& visit) {
  Lines lines(stream, name);
  Columns columns(kind);
  std::vector<double> numbers;
  std::vector<std::string_view> fields;
  std::uint64_t rows = 0;
  std::optional<char> separator;  // of the first line, and so of all
  while (auto line = lines.next()) {
    if (!separator && line->starts_with("\xef\xbb\xbf"))
      line->remove_prefix(3);
    const std::string_view told = line->substr(0, line->find('#'));
    if (trimmed(told, kBlanks).empty())
      continue;
    if (std::ranges::any_of(*line, [](char c) { return c == '\0'; }))
      lines.fail("this is neither a text, nor a .npy, nor a PLY");
    const bool is_first = !separator;
    if (is_first)
      separator = separator_of(told);
    split(told, *separator, fields);
    if (is_first && columns.take_names(lines, fields, *separator))
      continue;
    columns.append(lines, fields, *separator, numbers);
    ++rows;
    if (numbers.size() >= kLinesAtOnce * columns_of(kind)) {
      visit(numbers);
      numbers.clear();
    }
  }
  if (!numbers.empty())
    visit(numbers);
  return rows;
}

}  // namespace meshhier::querying
