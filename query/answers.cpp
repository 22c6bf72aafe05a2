#include "query/answers.h"

#include "query/npy_rows.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

namespace meshhier::querying {
namespace {

static_assert(sizeof(Answer) == 96, "no padding");
static_assert(std::endian::native == std::endian::little, "a .npy is written as it is in memory");

constexpr std::size_t kFlushBytes = std::size_t{1} << 20;

/// Appends a value as a CSV has it, behind a comma. (fmt::format_to() would compile all of fmt's
/// formatting here.)
void append_text(std::string& to, double value) {
  to += fmt::format(",{}", value);
}
void append_text(std::string& to, std::int64_t value) {
  to += fmt::format(",{}", value);
}
void append_text(std::string& to, const Vec3d& value) {
  to += fmt::format(",{},{},{}", value.x, value.y, value.z);
}

template <class Value>
void append_bytes(std::string& to, const Value& value) {
  std::array<char, sizeof value> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  to.append(bytes.data(), bytes.size());
}

/// A column: its names in a CSV, its field in a .npy, when it is there, and how it is written.
struct Column {
  std::string_view names, field;
  bool (*is_there)(const AnswerShape&);
  void (*write_text)(std::string&, const Answer&);
  void (*write_bytes)(std::string&, const Answer&);
};

bool always(const AnswerShape&) {
  return true;
}

/// Writes a member of an answer; as `Stored` in a .npy.
template <auto member, class Stored>
constexpr Column column(std::string_view names, std::string_view field,
                        bool (*is_there)(const AnswerShape&) = always) {
  return {names, field, is_there,
          [](std::string& to, const Answer& answer) {
            using Value = std::remove_cvref_t<decltype(answer.*member)>;
            using Shown = std::conditional_t<std::is_integral_v<Value>, std::int64_t, Value>;
            append_text(to, static_cast<Shown>(answer.*member));
          },
          [](std::string& to, const Answer& answer) {
            append_bytes(to, static_cast<Stored>(answer.*member));
          }};
}

constexpr std::array kColumns{
    column<&Answer::distance, double>("distance", "('distance', '<f8')"),
    column<&Answer::place, Vec3d>("x,y,z", "('point', '<f8', (3,))"),
    column<&Answer::normal, Vec3d>(
        "nx,ny,nz", "('normal', '<f8', (3,))",
        [](const AnswerShape& shape) { return shape.kind == RowKind::rays; }),
    column<&Answer::level, std::int32_t>("level", "('level', '<i4')"),
    column<&Answer::index, std::int64_t>("index", "('index', '<i8')"),
    column<&Answer::triangle, std::int64_t>("triangle", "('triangle', '<i8')"),
    column<&Answer::side, std::int8_t>("side", "('side', '<i1')",
                                       [](const AnswerShape& shape) { return shape.has_sides; }),
    column<&Answer::object, std::int64_t>(
        "object", "('object', '<i8')", [](const AnswerShape& shape) { return shape.has_objects; })};

std::string csv_head(const AnswerShape& shape, bool has_names) {
  std::string head;
  for (const Column& column : kColumns) {
    if (column.is_there(shape))
      head += fmt::format("{}{}", head.empty() ? "" : ",", column.names);
  }
  return head + (has_names ? ",name\n" : "\n");
}

std::string npy_type(const AnswerShape& shape) {
  std::string type;
  for (const Column& column : kColumns) {
    if (column.is_there(shape))
      type += fmt::format("{}{}", type.empty() ? "[" : ", ", column.field);
  }
  return type + "]";
}

/// A name as a field of a CSV (RFC 4180).
std::string quoted(const std::string& name) {
  if (name.find_first_of("\",\r\n") == std::string::npos)
    return name;
  std::string text = "\"";
  for (const char c : name)
    text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

}  // namespace

AnswerWriter::AnswerWriter(storage::File& file, AnswerFormat format, const AnswerShape& shape,
                           std::uint64_t count, ObjectNames names)
    : file_(file), format_(format), shape_(shape), names_(std::move(names)) {
  buffer_ = format == AnswerFormat::csv ? csv_head(shape, static_cast<bool>(names_))
                                        : npy_head(npy_type(shape), count);
}

void AnswerWriter::add(std::span<const Answer> answers) {
  for (const Answer& answer : answers) {
    if (format_ == AnswerFormat::csv)
      add_csv(answer);
    else
      add_npy(answer);
    if (buffer_.size() >= kFlushBytes)
      flush();
  }
}

void AnswerWriter::add_csv(const Answer& answer) {
  const std::size_t begin = buffer_.size();
  for (const Column& column : kColumns) {
    if (column.is_there(shape_))
      column.write_text(buffer_, answer);
  }
  buffer_.erase(begin, 1);  // the first comma
  if (names_)
    buffer_ += ',' + (answer.object < 0 ? "" : quoted(names_(answer.object)));
  buffer_ += '\n';
}

void AnswerWriter::add_npy(const Answer& answer) {
  for (const Column& column : kColumns) {
    if (column.is_there(shape_))
      column.write_bytes(buffer_, answer);
  }
}

void AnswerWriter::flush() {
  file_.write_at(written_, std::as_bytes(std::span(buffer_)));
  written_ += buffer_.size();
  buffer_.clear();
}

}  // namespace meshhier::querying
