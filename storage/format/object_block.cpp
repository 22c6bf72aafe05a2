#include "storage/format/object_block.h"

#include "base/utf8.h"
#include "storage/format/byte_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace meshhier::storage {
namespace {

// The columns of a block of n objects (byte_columns.h), of which b have a box:
//
//   names           n texts
//   has a box       n u8, 0 or 1
//   boxes           b f64 each: min x, min y, min z, max x, max y, max z
//   triangles       n u64
//   area            n f64
//   of each property, v of the objects having a value:
//     has a value   n u8, 0 or 1
//     values        v f64, u8 (0, 1) or texts

using Strings = std::vector<std::string_view>;

/// The six numbers of a box, in the order of their columns.
constexpr std::size_t kBoxNumbers = 6;
double& box_number(BoundsD& box, std::size_t i) {
  Vec3d& corner = i < 3 ? box.min : box.max;
  return i % 3 == 0 ? corner.x : i % 3 == 1 ? corner.y : corner.z;
}

void append_boxes(ColumnWriter& columns, std::span<const ObjectRow> rows) {
  std::vector<std::uint8_t> has_box;
  std::array<std::vector<double>, kBoxNumbers> numbers;
  for (const ObjectRow& row : rows) {
    has_box.push_back(row.box ? 1 : 0);
    BoundsD box = row.box.value_or(BoundsD{});
    for (std::size_t i = 0; row.box && i < kBoxNumbers; ++i)
      numbers[i].push_back(box_number(box, i));
  }
  columns.numbers<std::uint8_t>(has_box);
  for (const std::vector<double>& column : numbers)
    columns.numbers<double>(column);
}

void append_property(ColumnWriter& columns, std::span<const ObjectRow> rows, std::size_t property) {
  std::vector<std::uint8_t> has_value, booleans;
  std::vector<double> numbers;
  Strings texts;
  for (const ObjectRow& row : rows) {
    const ObjectValue& value = row.values[property];
    has_value.push_back(std::holds_alternative<std::monostate>(value) ? 0 : 1);
    if (const auto* number = std::get_if<double>(&value))
      numbers.push_back(*number);
    else if (const auto* boolean = std::get_if<bool>(&value))
      booleans.push_back(*boolean ? 1 : 0);
    else if (const auto* text = std::get_if<std::string>(&value))
      texts.push_back(*text);
  }
  // Values are of one type: the columns of the others are empty, and take no byte.
  columns.numbers<std::uint8_t>(has_value);
  columns.numbers<double>(numbers);
  columns.numbers<std::uint8_t>(booleans);
  columns.texts(texts);
}

/// Reads the columns of one block into rows.
class BlockReader {
 public:
  BlockReader(std::span<const std::byte> bytes, std::size_t count, const std::string& name)
      : columns_(bytes, name), rows_(count) {}

  std::vector<ObjectRow> read(std::span<const ObjectProperty> properties) {
    read_names();
    read_boxes();
    read_sizes();
    for (const ObjectProperty& property : properties)
      read_values(property.type);
    columns_.finish();
    return std::move(rows_);
  }

 private:
  void read_names() {
    const Strings names = columns_.texts(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!is_utf8(names[i]))
        columns_.fail("a name is no UTF-8");
      if (i > 0 && !(names[i - 1] < names[i]))
        columns_.fail("the names do not ascend");
      rows_[i].name = names[i];
    }
  }

  /// Returns the places of ones in a column of zeros and ones.
  std::vector<std::size_t> read_marked() {
    const std::vector<std::uint8_t> marks = columns_.numbers<std::uint8_t>(rows_.size());
    std::vector<std::size_t> marked;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      if (marks[i] > 1)
        columns_.fail("a mark is neither 0 nor 1");
      if (marks[i] == 1)
        marked.push_back(i);
    }
    return marked;
  }

  std::vector<double> read_finite(std::size_t count) {
    std::vector<double> numbers = columns_.numbers<double>(count);
    for (const double number : numbers) {
      if (!std::isfinite(number))
        columns_.fail("a number is not finite");
    }
    return numbers;
  }

  void read_boxes() {
    const std::vector<std::size_t> marked = read_marked();
    for (const std::size_t row : marked)
      rows_[row].box.emplace();
    for (std::size_t i = 0; i < kBoxNumbers; ++i) {
      const std::vector<double> numbers = read_finite(marked.size());
      for (std::size_t k = 0; k < marked.size(); ++k)
        box_number(*rows_[marked[k]].box, i) = numbers[k];
    }
    for (const std::size_t row : marked) {
      const BoundsD& box = *rows_[row].box;
      if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z)
        columns_.fail("a box is turned");
    }
  }

  void read_sizes() {
    const std::vector<std::uint64_t> triangles = columns_.numbers<std::uint64_t>(rows_.size());
    const std::vector<double> areas = read_finite(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (areas[i] < 0)
        columns_.fail("an area is negative");
      rows_[i].triangles = triangles[i];
      rows_[i].area = areas[i];
    }
  }

  void read_values(ObjectPropertyType type) {
    for (ObjectRow& row : rows_)
      row.values.emplace_back();
    const std::vector<std::size_t> marked = read_marked();
    const auto set = [&](const auto& values, const auto& value_of) {
      for (std::size_t k = 0; k < marked.size(); ++k)
        rows_[marked[k]].values.back() = value_of(values[k]);
    };
    if (type == ObjectPropertyType::number)
      set(read_finite(marked.size()), [](double value) { return ObjectValue(value); });
    else if (type == ObjectPropertyType::boolean)
      set(columns_.numbers<std::uint8_t>(marked.size()), [&](std::uint8_t value) {
        if (value > 1)
          columns_.fail("a boolean is neither 0 nor 1");
        return ObjectValue(value == 1);
      });
    else
      set(columns_.texts(marked.size()), [&](std::string_view value) {
        if (!is_utf8(value))
          columns_.fail("a text is no UTF-8");
        return ObjectValue(std::string(value));
      });
  }

  ColumnReader columns_;
  std::vector<ObjectRow> rows_;
};

}  // namespace

std::vector<std::byte> encode_object_block(std::span<const ObjectRow> rows,
                                           std::span<const ObjectProperty> properties) {
  ColumnWriter columns;
  Strings names(rows.size());
  std::ranges::transform(rows, names.begin(),
                         [](const ObjectRow& row) { return std::string_view(row.name); });
  columns.texts(names);
  append_boxes(columns, rows);
  columns.numbers<std::uint64_t>(rows | std::views::transform(&ObjectRow::triangles));
  columns.numbers<double>(rows | std::views::transform(&ObjectRow::area));
  for (std::size_t i = 0; i < properties.size(); ++i)
    append_property(columns, rows, i);
  return columns.bytes();
}

std::vector<ObjectRow> decode_object_block(std::span<const std::byte> bytes, std::size_t count,
                                           std::span<const ObjectProperty> properties,
                                           const std::string& name) {
  return BlockReader(bytes, count, name).read(properties);
}

}  // namespace meshhier::storage
