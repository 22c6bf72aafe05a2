#include "mesh_io/record_table.h"

#include "base/utf8.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/input_error.h"
#include "mesh_io/json_value.h"
#include "mesh_io/utf16_stream.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostRecordBytes = std::size_t{4} << 20;
/// More columns than anybody looks at; a table that has more is not one of objects.
constexpr std::size_t kMostRecordFields = 4096;
constexpr int kEnd = -1;

/// The characters of a stream, with the number of the line.
class Characters {
 public:
  Characters(InputStream& stream, const std::filesystem::path& path)
      : stream_(stream), path_(path), buffer_(std::size_t{1} << 16) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    fill();
    if (std::string_view(buffer_.data(), end_).starts_with(kMark))
      at_ = kMark.size();
  }

  /// Returns the next character; kEnd behind the last.
  int peek() {
    if (at_ == end_)
      fill();
    return at_ == end_ ? kEnd : static_cast<unsigned char>(buffer_[at_]);
  }
  void pass() { line_ += buffer_[at_++] == '\n' ? 1 : 0; }
  std::uint64_t line() const { return line_; }
  [[noreturn]] void fail(std::uint64_t line, const std::string& message) const {
    fail_at_line(path_, line, message);
  }

 private:
  void fill() {
    end_ = stream_.read(std::as_writable_bytes(std::span(buffer_)));
    at_ = 0;
  }

  InputStream& stream_;
  const std::filesystem::path& path_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, end_ = 0;
  std::uint64_t line_ = 1;
};

/// Reads lines of CSV, which are several of the text if a field in quotes has line ends.
class CsvLines {
 public:
  explicit CsvLines(Characters& text) : text_(text) {}

  void set_separator(char separator) { separator_ = separator; }
  std::uint64_t line() const { return first_line_; }
  /// Returns how many fields were no UTF-8.
  std::uint64_t foreign() const { return foreign_; }

  /// Returns the fields of the next line that is not empty; none at the end.
  bool next(std::vector<std::string>& fields) {
    do {
      fields.clear();
      if (text_.peek() == kEnd)
        return false;
      take_line(fields);
    } while (fields.size() == 1 && fields[0].empty());
    return true;
  }

 private:
  void take_line(std::vector<std::string>& fields) {
    first_line_ = text_.line();
    bytes_ = 0;
    do {
      if (fields.size() == kMostRecordFields)
        text_.fail(first_line_,
                   fmt::format("expected up to {} columns, found more", kMostRecordFields));
      fields.push_back(take_field());
      if (!is_utf8(fields.back())) {
        fields.back() = utf8_of_windows(fields.back());
        ++foreign_;
      }
    } while (take(separator_));
    take('\r');
    take('\n');
  }

  std::string take_field() {
    std::string field;
    if (take('"'))
      take_quoted(field);
    while (!ends_field())
      add(field);
    return field;
  }

  void take_quoted(std::string& field) {
    while (true) {
      if (text_.peek() == kEnd)
        text_.fail(first_line_, "a field in quotes begins here and does not end");
      if (!take('"'))
        add(field);
      else if (text_.peek() == '"')
        add(field);
      else
        return;
    }
  }

  bool ends_field() {
    const int c = text_.peek();
    return c == kEnd || c == '\n' || c == '\r' || c == separator_;
  }
  bool take(int c) {
    if (text_.peek() != c)
      return false;
    text_.pass();
    return true;
  }
  void add(std::string& field) {
    if (++bytes_ > kMostRecordBytes)
      text_.fail(first_line_, fmt::format("expected a record of at most {} bytes, found more",
                                          kMostRecordBytes));
    field += static_cast<char>(text_.peek());
    text_.pass();
  }

  Characters& text_;
  int separator_ = kEnd;
  std::uint64_t first_line_ = 1, foreign_ = 0;
  std::size_t bytes_ = 0;
};

/// Refuses spreadsheets and data bases as they are.
void require_text(std::string_view head, const std::filesystem::path& path) {
  const bool is_binary = std::ranges::any_of(
      head, [](char c) { return static_cast<unsigned char>(c) < ' ' && c != '\t'; });
  if (is_binary)
    fail_file(path,
              "expected a table as text (CSV, or an object of JSON a line), found a binary "
              "file; save it as CSV in UTF-8");
}

/// Returns what a line "sep=;" says.
std::optional<char> told_separator(std::string_view line) {
  constexpr std::string_view kTold = "sep=";
  const bool is_told = line.starts_with(kTold) && line.size() == kTold.size() + 1;
  return is_told ? std::optional(line.back()) : std::nullopt;
}

/// Returns the separator that a line has most of, outside of quotes.
char separator_of(std::string_view line) {
  constexpr std::array kSeparators{',', ';', '\t'};
  std::array<std::size_t, kSeparators.size()> counts{};
  bool is_quoted = false;
  for (const char c : line) {
    is_quoted = is_quoted != (c == '"');
    for (std::size_t i = 0; i < kSeparators.size(); ++i)
      counts[i] += !is_quoted && c == kSeparators[i] ? 1 : 0;
  }
  return kSeparators[static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin())];
}

std::string take_text_line(Characters& text) {
  std::string line;
  const std::uint64_t number = text.line();
  for (int c = text.peek(); c != kEnd && c != '\n' && c != '\r'; c = text.peek()) {
    if (line.size() == kMostRecordBytes)
      text.fail(number,
                fmt::format("expected a line of at most {} bytes, found more", kMostRecordBytes));
    line += static_cast<char>(c);
    text.pass();
  }
  return line;
}

/// Passes blanks, too, and the record separators of RFC 8142.
void pass_line_ends(Characters& text) {
  constexpr std::string_view kBetween = "\n\r \t\x1E";
  while (text.peek() != kEnd && kBetween.find(static_cast<char>(text.peek())) != kBetween.npos)
    text.pass();
}

/// A text in front of another stream.
class Prepended final : public InputStream {
 public:
  Prepended(std::string_view first, Characters& rest) : first_(first), rest_(rest) {}

  std::size_t read(std::span<std::byte> to) override {
    std::size_t count = std::min(to.size(), first_.size());
    for (std::size_t i = 0; i < count; ++i)
      to[i] = static_cast<std::byte>(first_[i]);
    first_.remove_prefix(count);
    for (; count < to.size() && rest_.peek() != kEnd; rest_.pass())
      to[count++] = static_cast<std::byte>(rest_.peek());
    return count;
  }

 private:
  std::string_view first_;
  Characters& rest_;
};

/// Refuses a name that is there twice: nobody could tell the columns apart.
void check_columns(const std::vector<std::string>& columns, Characters& text) {
  std::vector<std::string> sorted;
  std::ranges::copy_if(columns, std::back_inserter(sorted),
                       [](const std::string& name) { return !name.empty(); });
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice != sorted.end())
    text.fail(1, "two columns have the name " + in_quotes(*twice));
}

RecordCounts read_csv(Characters& text, const std::filesystem::path& path,
                      const RecordVisitor& visit) {
  std::string head = take_text_line(text);
  const auto told = told_separator(head);  // Excel's first line
  if (told) {
    while (text.peek() == '\r' || text.peek() == '\n')
      text.pass();
    head = take_text_line(text);
  }
  require_text(head, path);
  const char separator = told.value_or(separator_of(head));
  const auto texts = separator == ',' ? RecordTexts::any : RecordTexts::any_with_commas;
  Prepended all(head, text);
  Characters again(all, path);
  CsvLines lines(again);
  lines.set_separator(separator);
  RecordCounts counts;
  std::vector<std::string> columns, fields;
  if (!lines.next(columns))
    again.fail(1, "expected a line of columns' names, found an empty file");
  check_columns(columns, again);
  std::vector<RecordField> record;
  for (std::string& column : columns)
    record.push_back({column, {}});
  while (lines.next(fields)) {
    ++counts.records;
    if (fields.size() != record.size() && counts.ragged++ == 0)
      counts.first_ragged = lines.line();
    for (std::size_t i = 0; i < record.size(); ++i) {
      const bool is_there = i < fields.size() && !fields[i].empty();
      record[i].value = is_there ? ObjectValue(std::move(fields[i])) : ObjectValue();
    }
    visit(record, texts);
  }
  counts.foreign = lines.foreign();
  return counts;
}

/// Adds the members of an object. Of a feature of GeoJSON they are its properties and its id.
void add_fields(const Json& object, std::vector<RecordField>& record) {
  const auto type = object.find("type");
  const auto properties = object.find("properties");
  const bool is_feature = type != object.end() && *type == "Feature" &&
                          properties != object.end() && properties->is_object();
  for (const auto& [key, value] : (is_feature ? *properties : object).items())
    record.push_back({key, value_of_json(value)});
  if (is_feature && object.contains("id") && !properties->contains("id"))
    record.push_back({"id", value_of_json(object["id"])});
}

RecordCounts read_json_lines(Characters& text, const RecordVisitor& visit) {
  RecordCounts counts;
  std::vector<RecordField> record;
  for (pass_line_ends(text); text.peek() != kEnd; pass_line_ends(text)) {
    const std::uint64_t number = text.line();
    const std::string line = sound_utf8(take_text_line(text));
    const auto watch = [&](int depth, Json::parse_event_t, const Json&) {
      if (depth > kDeepestGltfJson)
        text.fail(number, fmt::format("expected JSON of at most {} levels", kDeepestGltfJson));
      return true;
    };
    const Json object = storage::parse_json_text(line, watch, {.throws = false});
    if (!object.is_object())
      text.fail(number, "expected an object of JSON in one line, found " + in_quotes(line) +
                            "; `jq -c .`, of GeoJSON `jq -c '.features[]'`, makes lines of it");
    if (object.contains("features"))
      text.fail(number,
                "expected an object of JSON a line, found a collection of features; `jq "
                "-c '.features[]'` makes lines of it");
    record.clear();
    add_fields(object, record);
    if (record.size() > kMostRecordFields)
      text.fail(number,
                fmt::format("expected up to {} keys, found {}", kMostRecordFields, record.size()));
    ++counts.records;
    visit(record, RecordTexts::texts);
  }
  return counts;
}

}  // namespace

RecordCounts read_records(InputStream& stream, const std::filesystem::path& path,
                          const RecordVisitor& visit) {
  Utf16Stream utf8(stream, path);
  Characters text(utf8, path);
  while (text.peek() == '\n' || text.peek() == '\r' || text.peek() == 0x1E)
    text.pass();
  if (text.peek() == '[')
    text.fail(text.line(),
              "expected CSV, or an object of JSON a line, found a list of JSON; `jq -c "
              "'.[]'` makes lines of it");
  return text.peek() == '{' ? read_json_lines(text, visit) : read_csv(text, path, visit);
}

}  // namespace meshhier::mesh_io
