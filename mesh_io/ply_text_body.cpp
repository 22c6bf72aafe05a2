#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"
#include "mesh_io/ply_body.h"
#include "mesh_io/ply_words.h"
#include "mesh_io/text_cursor.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Makes a number fit 64 bits; as a length or an index, one so large is wrong anyway.
std::int64_t clamped(double value) {
  return static_cast<std::int64_t>(std::clamp(value, -0x1p62, 0x1p62));
}

using Role = PlyElementPlan::Role;

/// Beyond it doubles do not hold all integers.
constexpr double kMostExact = 9007199254740992;

class TextBody final : public PlyBody {
 public:
  TextBody(const InputFile& input, const PlyPlan& plan, PlyPosition start)
      : cursor_(input, start.offset, start.line),
        plan_(plan),
        vertex_count_(plan.elements[plan.vertex_element].element.count),
        checks_(plan.checks) {}

  PlyPosition position() const override { return {cursor_.offset(), cursor_.line()}; }
  void skip(const PlyElementPlan& plan) override;
  void read_vertices(const PlyElementPlan& plan, std::uint64_t first,
                     VertexBlocks& blocks) override;
  void read_faces(const PlyElementPlan& plan, std::uint64_t first, TriangleBlocks& blocks) override;
  void read_rows(const PlyElementPlan& plan, const PlyRowVisitor& visit) override;
  void expect_end() override;
  OddSyntax take_odd() override { return std::exchange(odd_, {}); }

 private:
  struct Row {
    const PlyElementPlan& plan;
    std::uint64_t number;
  };

  [[noreturn]] void fail(const std::string& message) const {
    fail_at_line(cursor_.file().path(), cursor_.line(), message);
  }
  [[noreturn]] void fail_number(const Row& row, const PlyProperty& property, PlyType type,
                                std::string_view word) const;
  [[noreturn]] void fail_short(const Row& row) const;
  void begin_row(const Row& row);
  void end_row(const Row& row);
  std::string_view take_word(const Row& row, const PlyProperty& property);
  std::int64_t take_integer(const Row& row, const PlyProperty& property, PlyType type);
  double take_number(const Row& row, const PlyProperty& property);
  double odd_integer(const Row& row, const PlyProperty& property, PlyType type,
                     std::string_view word);
  std::uint64_t take_count(const Row& row, const PlyProperty& property);
  void skip_property(const Row& row, const PlyProperty& property);
  void take_corners(const Row& row, const PlyProperty& property, TriangleBlocks& blocks);
  std::int64_t take_index(const Row& row, const PlyProperty& property);
  void take_property(const Row& row, std::size_t property, std::vector<double>& values);
  bool could_be_row(const std::vector<double>& numbers) const;

  /// The place where a line ends before its row does.
  struct Break {
    std::uint64_t line = 0;
    const PlyProperty* property = nullptr;  ///< the next one
    bool ends_file = false;
  };

  TextCursor cursor_;
  const PlyPlan& plan_;
  std::uint64_t vertex_count_;
  RowChecks checks_;
  std::optional<Break> break_;  ///< the first one in this row
  OddSyntax odd_;
};

void TextBody::begin_row(const Row& row) {
  break_.reset();
  if (cursor_.to_row())
    return;
  fail(
      fmt::format("expected {}, found the end of the file (truncated, or the count in the header "
                  "is wrong)",
                  row_name(row.plan, row.number)));
}

/// A row that was broken ends with a line: else it has lost a number, and what follows is another
/// row.
void TextBody::end_row(const Row& row) {
  if (!cursor_.to_word()) {
    odd_.broken_rows += break_ ? 1 : 0;
    return;
  }
  if (break_)
    fail_short(row);
  fail(
      fmt::format("expected the end of the line behind {}, found {} (the row has more numbers "
                  "than the header declares)",
                  row_name(row.plan, row.number), in_quotes(cursor_.take_word())));
}

/// Fails at the row's first break.
void TextBody::fail_short(const Row& row) const {
  fail_at_line(cursor_.file().path(), break_->line,
               fmt::format("expected a number for {} in {}, found the end of the {} (the row has "
                           "fewer numbers than the header declares)",
                           in_quotes(break_->property->name), row_name(row.plan, row.number),
                           break_->ends_file ? "file" : "line"));
}

std::string_view TextBody::take_word(const Row& row, const PlyProperty& property) {
  if (!cursor_.to_word()) {
    if (!break_)
      break_ = {cursor_.line(), &property, cursor_.remaining() == 0};
    if (!cursor_.to_row())
      fail_short(row);
  }
  const std::string_view word = cursor_.take_word();
  if (word.empty()) {
    fail(fmt::format("expected a number for {} in {}, found a word of more than {} bytes",
                     in_quotes(property.name), row_name(row.plan, row.number),
                     TextCursor::kMaxWordBytes));
  }
  return word;
}

void TextBody::fail_number(const Row& row, const PlyProperty& property, PlyType type,
                           std::string_view word) const {
  std::string expected = "a number";
  if (is_integer(type)) {
    const IntegerRange range = range_of(type);
    expected = fmt::format("an integer from {} to {}", range.low, range.high);
  }
  fail(fmt::format("expected {} ('{}') for {} in {}, found {}", expected, name_of(type),
                   in_quotes(property.name), row_name(row.plan, row.number),
                   number_in_quotes(word)));
}

std::int64_t TextBody::take_integer(const Row& row, const PlyProperty& property, PlyType type) {
  const std::string_view word = take_word(row, property);
  const auto value = integer_of(type, word);
  return value ? *value : clamped(odd_integer(row, property, type, word));
}

/// Requires that it is not as it should be.
double TextBody::odd_integer(const Row& row, const PlyProperty& property, PlyType type,
                             std::string_view word) {
  const auto value = odd_integer_of(type, word);
  if (!value)
    fail_number(row, property, type, word);
  ++(has_64_bits(type) && std::abs(*value) >= kMostExact ? odd_.rounded : odd_.integers);
  return *value;
}

double TextBody::take_number(const Row& row, const PlyProperty& property) {
  const std::string_view word = take_word(row, property);
  if (const auto value = number_of(property.type, word))
    return *value;
  if (is_integer(property.type))
    return odd_integer(row, property, property.type, word);
  fail_number(row, property, property.type, word);
}

/// Takes a list's length: not more than can follow, at two characters an item.
std::uint64_t TextBody::take_count(const Row& row, const PlyProperty& property) {
  if (!property.count_type)
    return property.fixed_count;
  const std::int64_t count = take_integer(row, property, *property.count_type);
  const std::uint64_t fitting = cursor_.remaining() / 2;
  if (count < 0 || static_cast<std::uint64_t>(count) > fitting) {
    fail(
        fmt::format("expected the length of list {} in {} from 0 to {}, as many as fit into the "
                    "rest of the file, found {} (truncated or damaged)",
                    in_quotes(property.name), row_name(row.plan, row.number), fitting, count));
  }
  return static_cast<std::uint64_t>(count);
}

void TextBody::skip_property(const Row& row, const PlyProperty& property) {
  const std::uint64_t words = property.is_list() ? take_count(row, property) : 1;
  for (std::uint64_t i = 0; i < words; ++i)
    take_word(row, property);
}

void TextBody::skip(const PlyElementPlan& plan) {
  for (std::uint64_t i = 0; i < plan.element.count; ++i) {
    const Row row{plan, i};
    begin_row(row);
    for (const PlyProperty& property : plan.element.properties)
      skip_property(row, property);
    end_row(row);
  }
}

void TextBody::read_vertices(const PlyElementPlan& plan, std::uint64_t first,
                             VertexBlocks& blocks) {
  for (std::uint64_t i = first; i < plan.element.count; ++i) {
    const Row row{plan, i};
    begin_row(row);
    for (std::size_t k = 0; k < plan.slots.size(); ++k) {
      const PlyProperty& property = plan.element.properties[k];
      if (plan.slots[k] == kSkipped) {
        skip_property(row, property);
      } else {
        blocks.set(plan.slots[k], take_number(row, property));
      }
    }
    end_row(row);
    if (const auto bad = blocks.commit(checks_))
      fail_for(*bad, [&] { fail(defect_text(plan, i, bad->slot, bad->value)); });
  }
}

void TextBody::read_faces(const PlyElementPlan& plan, std::uint64_t first, TriangleBlocks& blocks) {
  for (std::uint64_t i = first; i < plan.element.count; ++i) {
    const Row row{plan, i};
    begin_row(row);
    for (std::size_t k = 0; k < plan.element.properties.size(); ++k) {
      const PlyProperty& property = plan.element.properties[k];
      if (k == plan.corners) {
        take_corners(row, property, blocks);
      } else {
        skip_property(row, property);
      }
    }
    end_row(row);
  }
}

void TextBody::take_corners(const Row& row, const PlyProperty& property, TriangleBlocks& blocks) {
  const bool strip = row.plan.role == Role::strips;
  const std::uint64_t count = take_count(row, property);
  if (!strip && count > PolygonCut::kMostCorners)
    fail(PolygonCut::limit_text());
  strip ? blocks.begin_strip() : blocks.begin_polygon();
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::int64_t index = take_index(row, property);
    if (index >= 0 && static_cast<std::uint64_t>(index) < vertex_count_) {
      const auto corner = static_cast<std::uint32_t>(index);
      strip ? blocks.add_strip_corner(corner) : blocks.add_polygon_corner(corner);
    } else if (strip && is_strip_restart(index, property.type)) {
      blocks.restart_strip();
    } else {
      fail(index_text(row.plan, row.number, index, vertex_count_));
    }
  }
  strip ? blocks.end_strip() : blocks.end_polygon();
}

/// A vertex, or what else an integer says there.
std::int64_t TextBody::take_index(const Row& row, const PlyProperty& property) {
  const std::string_view word = take_word(row, property);
  const auto index = parse_integer(word);
  return index ? *index : clamped(odd_integer(row, property, property.type, word));
}

void TextBody::read_rows(const PlyElementPlan& plan, const PlyRowVisitor& visit) {
  PlyRow taken;
  taken.values.resize(plan.element.properties.size());
  for (taken.number = 0; taken.number < plan.element.count; ++taken.number) {
    const Row row{plan, taken.number};
    begin_row(row);
    for (std::size_t i = 0; i < taken.values.size(); ++i) {
      if (plan.takes(i)) {
        take_property(row, i, taken.values[i]);
      } else {
        skip_property(row, plan.element.properties[i]);
      }
    }
    end_row(row);
    const std::string defect = visit(taken);
    if (!defect.empty())
      fail(defect);
  }
}

void TextBody::take_property(const Row& row, std::size_t index, std::vector<double>& values) {
  const PlyProperty& property = row.plan.element.properties[index];
  const std::uint64_t count = property.is_list() ? take_count(row, property) : 1;
  if (count > most_items(row.plan, index))
    fail(corners_text(row.plan, row.number, count));
  values.clear();
  for (std::uint64_t i = 0; i < count; ++i) {
    values.push_back(index == row.plan.corners && row.plan.role != Role::texture_vertices
                         ? static_cast<double>(take_index(row, property))
                         : take_number(row, property));
  }
}

void TextBody::expect_end() {
  for (; cursor_.to_row(); ++odd_.lines_behind) {
    constexpr std::size_t kMost = std::size_t{1} << 16;  // more numbers than a line of sense has
    std::string first;
    std::vector<double> numbers;
    for (bool is_number = true; is_number && cursor_.to_word() && numbers.size() < kMost;) {
      const std::string_view word = cursor_.take_word();
      if (first.empty())
        first = word;
      const auto number = parse_real<double>(word);
      is_number = number.has_value();
      is_number ? numbers.push_back(*number) : numbers.clear();
    }
    if (could_be_row(numbers)) {
      fail(
          fmt::format("expected the end of the file behind the last row the header declares, "
                      "found {} (the header's counts do not match the data)",
                      in_quotes(first)));
    }
    cursor_.skip_line();
  }
}

/// Returns whether a line of these numbers, and nothing else, could be one more row of any element.
bool TextBody::could_be_row(const std::vector<double>& numbers) const {
  return std::ranges::any_of(plan_.elements, [&](const PlyElementPlan& plan) {
    std::size_t taken = 0;
    for (const PlyProperty& property : plan.element.properties) {
      double items = property.is_list() ? property.fixed_count : 1;
      if (property.count_type && taken < numbers.size())
        items = numbers[taken++];
      if (!(items >= 1 && items <= static_cast<double>(numbers.size() - taken)))
        return false;
      taken += static_cast<std::size_t>(items);
    }
    return taken > 0 && taken == numbers.size();
  });
}

}  // namespace

std::unique_ptr<PlyBody> make_text_body(const InputFile& input, const PlyPlan& plan,
                                        PlyPosition start) {
  return std::make_unique<TextBody>(input, plan, start);
}

}  // namespace meshhier::mesh_io
